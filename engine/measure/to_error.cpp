#include "engine/measure/to_error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/base/error.h"

namespace etalon {
namespace {

/// Enough for a variance of most pixels; a rare bright event is not seen by it, which docs/tradeoffs.md says.
constexpr std::uint64_t kPilotSamples = 16;
constexpr std::uint64_t kPilotSeed = 0x9e3779b97f4a7c15u;

/// By how much the squared error of one picture may exceed its expectation, as a factor, with 95%: the error of a pixel
/// is near normal, so its square scatters by √2 of its variance, its channels taken as fully correlated.
double chance_of_one_picture(const Film& pilot)
{
    double sum = 0, squares = 0;
    for (std::size_t i = 0; i < pilot.variance.size(); ++i) {
        const vec3& v = pilot.variance[i];
        const double pixel = double(v.x) + double(v.y) + double(v.z);
        if (!std::isfinite(pixel)) continue;
        sum += pixel;
        // Of the variance, not of its estimate, whose square is too large by its own scatter.
        squares += pixel * pixel / (1 + 2 / pilot.degrees_of_freedom(i));
    }
    constexpr double kOneSided95 = 1.645;
    return sum > 0 ? 1 + kOneSided95 * std::sqrt(2 * squares) / sum : 1;
}

}  // namespace

FilmToError render_to_error(const RenderSettings& settings, double relative, std::uint64_t most_samples,
                            const std::function<Film(const RenderSettings&, const Progress&)>& render,
                            const Progress& progress)
{
    if (!(relative > 0))
        throw Error(Blame::input, fmt::format("an error of {} cannot be reached", relative), "ask for one above 0");
    if (settings.renderer != Renderer::path && settings.renderer != Renderer::reference)
        throw Error(Blame::input, "only a path tracer's error falls with its samples", "add --renderer path");

    RenderSettings pilot = settings;
    pilot.aovs = false;
    pilot.spp = std::min(kPilotSamples, std::max<std::uint64_t>(most_samples, 2));
    pilot.seed = settings.seed ^ kPilotSeed;
    const Film trial = render(pilot, progress.silent());
    FilmToError out{.film = {}, .pilot_samples = trial.samples, .pilot = estimate_error(trial)};
    double wanted = 2;
    if (out.pilot && std::isfinite(out.pilot->high))
        wanted =
            std::ceil(double(trial.samples) * std::pow(out.pilot->high / relative, 2) * chance_of_one_picture(trial));
    out.capped = wanted > double(most_samples);
    out.asked_samples = static_cast<std::uint64_t>(std::clamp(wanted, 2.0, double(most_samples)));
    if (progress.stopped()) {
        out.film = trial;
        return out;
    }
    RenderSettings whole = settings;
    whole.spp = out.asked_samples;
    out.film = render(whole, progress);
    return out;
}

}  // namespace etalon
