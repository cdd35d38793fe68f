#pragma once
#include <span>

#include "engine/image/film.h"

namespace etalon {

/// What independent replicates of a pixel say together (MC-10).
struct Pooled {
    dvec3 mean{0};
    dvec3 variance{0};  ///< of the mean; 0 where there are under two samples
    double alpha = 0;
};

/// Replicates without samples are left out. Each of the others weighs the same, whatever its number of samples, so that
/// the scatter of their means is the variance of their mean without bias, for one sample more or less in some of them.
/// It is 0 where all means are alike, which is no proof of a constant: two replicates often hit an edge as many times.
Pooled pool(std::span<const PixelSums> replicates);

/// The film of pictures whose samples are independent of one another's; of a single one FilmSum::film().
Film film_of(std::span<const FilmSum> replicates);

/// Samples of the first `samples` of a pixel that are replicate `number`'s, dealt in turn.
inline std::uint64_t samples_of_replicate(std::uint64_t samples, std::uint64_t number, std::uint64_t replicates)
{
    return (samples + replicates - 1 - number) / replicates;
}

}  // namespace etalon
