#pragma once
#include <cstdint>
#include <functional>
#include <optional>

#include "engine/base/progress.h"
#include "engine/image/film.h"
#include "engine/scene/settings.h"

namespace etalon {

/// A path-traced picture made to an asked error instead of a number of samples.
struct FilmToError {
    Film film;
    std::uint64_t pilot_samples = 0;     ///< a pixel, spent on finding out how many are needed
    std::uint64_t asked_samples = 0;     ///< a pixel, what the pilot called for
    std::optional<ErrorEstimate> pilot;  ///< nothing where the pilot saw no variance: a black or a constant picture
    bool capped = false;                 ///< more than `most_samples` were called for
};

/// Renders until the relative standard error of the whole picture (estimate_error) is `relative`, by Stein's two-stage
/// rule (Stein 1945): a pilot of few samples with random numbers of its own estimates the error per sample; the picture
/// then has a number of samples that depends on the pilot alone, and none of the pilot's: stopping does not bias it,
/// which stopping when the picture's own variance looks small would (dark where a firefly has not been met yet). The
/// upper end of the pilot's 95% interval decides, with room for the scatter of one picture's own error, so that the
/// true error is under the asked one in at least 95% of runs where the pilot has seen what there is to see. The film
/// is, bit for bit, that of `settings` with spp = asked_samples. A film of fewer samples comes back when `progress`
/// says stop. Throws Error(input) unless 0 < relative and the renderer of `settings` is a path tracer.
FilmToError render_to_error(const RenderSettings& settings, double relative, std::uint64_t most_samples,
                            const std::function<Film(const RenderSettings&, const Progress&)>& render,
                            const Progress& progress);

}  // namespace etalon
