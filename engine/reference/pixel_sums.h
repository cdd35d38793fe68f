#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "engine/image/film.h"
#include "engine/image/film_state.h"

namespace etalon::reference {

/// Mean and scatter of the samples of one pixel, one after another (Welford 1962; MC-2, promises M1–M3).
class PixelSum {
 public:
    /// A sample that is not finite is counted and left out (promise M13).
    void add(const dvec3& radiance, double alpha);

    std::uint64_t count() const { return count_; }
    std::uint64_t nonfinite() const { return nonfinite_; }
    const dvec3& mean() const { return mean_; }
    double alpha() const { return alpha_; }
    dvec3 variance_of_mean() const;  ///< nit²; 0 under two samples
    PixelSums sums() const { return {mean_, m2_, alpha_, count_}; }

    static constexpr std::size_t kNumbers = 9;
    /// All that it holds, as kNumbers numbers, and back: to the last bit.
    void save(std::span<double> numbers) const;
    void restore(std::span<const double> numbers);

 private:
    dvec3 mean_{0}, m2_{0};
    double alpha_ = 0;
    std::uint64_t count_ = 0;
    std::uint64_t nonfinite_ = 0;
};

/// The film of `sums`, `samples` a pixel as the caller asked for (what was left out is in Film::nonfinite): as many
/// sums a pixel, one after another, as it has replicates (MC-10).
Film film_of(const std::vector<PixelSum>& sums, int width, int height, std::uint64_t samples);

/// What those sums are, to be taken up by restore(): `sums` of the same number. Error(input) when it is another.
FilmState state_of(const std::vector<PixelSum>& sums, int width, int height, std::uint64_t samples);
void restore(std::vector<PixelSum>& sums, const FilmState& state);

/// √(mean variance of the mean) / mean radiance over the picture: what progress reports. 0 for a black picture.
double relative_error(const std::vector<PixelSum>& sums, std::size_t pixels);

}  // namespace etalon::reference
