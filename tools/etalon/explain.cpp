#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

#include "engine/base/error.h"
#include "tools/etalon/arguments.h"
#include "tools/etalon/explain_report.h"
#include "tools/etalon/interrupt.h"
#include "tools/etalon/measuring.h"
#include "tools/etalon/progress_display.h"
#include "tools/etalon/scenes.h"
#include "tools/etalon/settings.h"
#include "tools/etalon/terminal.h"

namespace etalon::cli {
namespace {

/// What is drawn dozens of times to be timed, unless more is asked for.
constexpr ivec2 kMeasuredSize(320, 180);
constexpr std::uint64_t kMeasuredSamples = 4;

bool is_of_device(Renderer renderer)
{
    return renderer == Renderer::raster || renderer == Renderer::path;
}

/// Compilers' results on disk would hide what compiling costs. Before the first device is made, by the one thread.
void forget_compiled_shaders()
{
    setenv("MESA_SHADER_CACHE_DISABLE", "true", 1);
}

}  // namespace

int explain(const Arguments& arguments)
{
    Explained out{.settings = render_settings(arguments)};
    const bool measures = arguments.has("measure");
    if (measures && !is_of_device(out.settings.renderer))
        throw Error(Blame::input, "--measure is of pipelines, which the references do not have",
                    "leave it out, or use --renderer path");
    const PoseSettings view = measures ? measured_view(arguments, kMeasuredSize) : pose_settings(arguments);
    if (measures && !arguments.has("spp")) out.settings.spp = kMeasuredSamples;
    const Interrupt interrupt;
    const Scene scene = open_scene(arguments.positional().front(), arguments);
    const PosedScene whole = pose_whole(scene, view);
    PosedScene posed = whole;
    out.removals = simplify(posed);
    out.scene = &scene;
    out.size = ivec2(posed.view.width, posed.view.height);
    out.required = require(posed, out.settings);
    out.suggestions = suggest(scene);
    out.draws = posed.draws.size();
    if (out.settings.renderer == Renderer::raster || out.settings.renderer == Renderer::reference_raster)
        out.unseen = find_unseen(posed, out.required, out.settings);
    if (is_of_device(out.settings.renderer)) {
        out.costs = scene_costs(whole, posed, out.settings);
        out.each = requirement_costs(posed, out.settings);
    }
    if (measures) {
        forget_compiled_shaders();
        ProgressDisplay display(arguments);
        out.measured =
            measure_specialisation(device_options(arguments), whole, posed, out.settings, budget_seconds(arguments),
                                   display.progress(short_name(scene.name), interrupt.flag()));
        display.clear();
    }
    put(arguments.has("json") ? explained_json(out) : explained_text(out));
    if (interrupt.stopped()) return interrupt.exit_code();
    return !out.measured || out.measured->identical ? 0 : 1;
}

}  // namespace etalon::cli
