#include "engine/measure/stability.h"

#include <fmt/format.h>

#include <optional>

#include "engine/measure/rasters.h"
#include "tools/etalon/arguments.h"
#include "tools/etalon/interrupt.h"
#include "tools/etalon/measuring.h"
#include "tools/etalon/output.h"
#include "tools/etalon/progress_display.h"
#include "tools/etalon/provenance.h"
#include "tools/etalon/renderers.h"
#include "tools/etalon/scenes.h"
#include "tools/etalon/settings.h"
#include "tools/etalon/terminal.h"

namespace etalon::cli {
namespace {

/// Many small pictures say more than few large ones: an error of a thousandth shows in any size.
constexpr ivec2 kStandardSize(128, 96);

StabilitySettings stability_settings(const Arguments& arguments)
{
    StabilitySettings settings{.render = render_settings(arguments)};
    settings.renderers = measured_renderers(arguments);
    settings.budget_seconds = budget_seconds(arguments);
    if (arguments.has("quick")) settings.bisections = 0;
    settings.false_alarm = arguments.number("false-alarm", 1e-12, 0.5).value_or(settings.false_alarm);
    return settings;
}

/// Judges rasterized pictures of variants of one scene, whose reference is drawn once.
class RasterJudge {
 public:
    RasterJudge(const std::string& scene_name, Renderers& renderers) : scene_name_(scene_name), renderers_(renderers) {}

    Comparison operator()(const PosedScene& unchanged, RenderSettings settings, const Film& film)
    {
        if (!reference_) {
            RenderSettings of_reference = settings;
            of_reference.renderer = Renderer::reference_raster;
            reference_ = renderers_.draw(scene_name_, unchanged, of_reference, {}).film;
        }
        return judge_rasters(unchanged, settings, renderers_.raster_precision(), film, *reference_);
    }

 private:
    std::string scene_name_;
    Renderers& renderers_;
    std::optional<Film> reference_;
};

}  // namespace

int stability(const Arguments& arguments)
{
    const std::string& scene_name = arguments.positional().front();
    const std::filesystem::path folder = measuring_folder(arguments);
    const StabilitySettings settings = stability_settings(arguments);
    const PoseSettings view = measured_view(arguments, kStandardSize);
    check_folder(folder);

    const Interrupt interrupt;
    Renderers renderers(arguments);
    const Scene scene = open_scene(scene_name, arguments);
    const PosedScene posed = pose(scene, view);
    Stability out{.scene = scene_name,
                  .command = command_line(arguments),
                  .settings = describe(posed, settings.render),
                  .versions = versions(),
                  .notes = posed.notes};
    out.settings.emplace_back("device", renderers.device_of(Renderer::path));
    const StabilityCalls calls{
        .render = [&](const PosedScene& variant, const RenderSettings& how,
                      const Progress& progress) { return renderers.draw(scene_name, variant, how, progress).film; },
        .judge_raster = RasterJudge(scene_name, renderers)};
    ProgressDisplay display(arguments);
    out = measure_stability(std::move(out), posed, view, settings, calls,
                            display.progress(short_name(scene_name), interrupt.flag()));
    display.clear();

    const std::vector<std::filesystem::path> written = write_stability(out, folder);
    put(arguments.has("json") ? stability_json(out) : stability_table(out));
    say(fmt::format("report: {}", written.front().string()));
    if (interrupt.stopped()) return interrupt.exit_code();
    return passed(out) ? 0 : 1;
}

}  // namespace etalon::cli
