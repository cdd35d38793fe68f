#include "tools/etalon/raster_goal.h"

#include <fmt/format.h>

#include <algorithm>

#include "engine/base/error.h"
#include "engine/measure/frontier_profile.h"
#include "engine/scene/knobs.h"
#include "tools/etalon/measuring.h"

namespace etalon::cli {
namespace {

using Point = FrontierProfile::Point;

/// The profile without what breaks `seconds` at this size, unless that leaves nothing.
FrontierProfile affordable(FrontierProfile profile, double seconds, ivec2 size)
{
    if (profile.within_time(seconds, size) == nullptr) return profile;
    std::erase_if(profile.points, [&](const Point& p) { return profile.seconds(p, size) > seconds; });
    return profile;
}

std::string describe(const FrontierProfile& profile, const Point& point, ivec2 size)
{
    return fmt::format("{}: measured at {}x{} to be {:.3g}% off, expected to take {:.2g} s here",
                       flags_of(point.settings), profile.size.x, profile.size.y, 100 * point.error,
                       profile.seconds(point, size));
}

const Point& choose(const FrontierProfile& profile, std::optional<double> error, std::optional<double> seconds,
                    ivec2 size, std::vector<std::string>& notes)
{
    const bool hurried = seconds && profile.within_time(*seconds, size) == nullptr;
    if (hurried) {
        const Point& fastest = *profile.fastest(size);
        notes.push_back(fmt::format("{:.2g} s are left, and the fastest settings need about {:.2g} s here", *seconds,
                                    profile.seconds(fastest, size)));
        return fastest;
    }
    const FrontierProfile allowed = seconds ? affordable(profile, *seconds, size) : profile;
    const Point* chosen = error ? allowed.within_error(*error, size) : allowed.most_accurate();
    if (chosen == nullptr) {
        chosen = allowed.most_accurate();
        notes.push_back(
            fmt::format("no settings of the rasterizer come within {:.3g} of this scene's light; the best {} "
                        "{:.3g}. --renderer path has no such limit",
                        *error, seconds ? "in this time is" : "is", chosen->error));
    }
    // The point in the profile itself: what is allowed is a copy.
    return *std::find_if(profile.points.begin(), profile.points.end(),
                         [&](const Point& p) { return flags_of(p.settings) == flags_of(chosen->settings); });
}

}  // namespace

RenderSettings choose_raster_settings(const PosedScene& posed, const RenderSettings& settings,
                                      std::optional<double> error, std::optional<double> seconds, Renderers& renderers,
                                      std::vector<std::string>& notes)
{
    const auto folder = cache_folder("profiles");
    std::optional<FrontierProfile> profile;
    if (folder)
        profile = ProfileStore(*folder).find(profile_key(posed, settings, renderers.device_of(Renderer::raster)));
    if (!profile)
        throw Error(Blame::input, "nothing is known of what the rasterizer's settings cost and give for this scene",
                    "run `etalon tradeoff` on it with the same view and light, on this device; or add --renderer path, "
                    "which stops by itself");
    const ivec2 size(posed.view.width, posed.view.height);
    const Point& chosen = choose(*profile, error, seconds, size, notes);
    notes.push_back("chosen " + describe(*profile, chosen, size));
    RenderSettings out = settings;
    for (const Knob& knob : knobs())
        if (knob.scope == KnobScope::raster && knob.metric != KnobMetric::none)
            set_knob(out, knob.name, knob_value(chosen.settings, knob.name));
    return out;
}

}  // namespace etalon::cli
