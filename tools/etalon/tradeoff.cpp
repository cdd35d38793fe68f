#include "engine/measure/tradeoff.h"

#include <fmt/format.h>

#include "engine/base/error.h"
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

/// Large enough to show what a knob does, small enough for many pictures in a minute without a GPU.
constexpr ivec2 kStandardSize(320, 180);

TradeoffSettings tradeoff_settings(const Arguments& arguments)
{
    TradeoffSettings settings{.standard = render_settings(arguments)};
    settings.seed = settings.standard.seed;
    settings.renderers = measured_renderers(arguments);
    settings.budget_seconds = budget_seconds(arguments);
    if (arguments.has("quick")) {
        settings.rounds = 3;
        settings.combinations = 0;
    }
    return settings;
}

}  // namespace

int tradeoff(const Arguments& arguments)
{
    const std::string& scene_name = arguments.positional().front();
    const std::filesystem::path folder = measuring_folder(arguments);
    const TradeoffSettings settings = tradeoff_settings(arguments);
    const PoseSettings view = measured_view(arguments, kStandardSize);
    check_folder(folder);

    const Interrupt interrupt;
    Renderers renderers(arguments);
    const Scene scene = open_scene(scene_name, arguments);
    const PosedScene posed = pose(scene, view);
    Tradeoff out{.scene = scene_name,
                 .command = command_line(arguments),
                 .settings = describe(posed, settings.standard),
                 .versions = versions(),
                 .notes = posed.notes,
                 .develop = develop_settings(arguments)};
    out.settings.emplace_back("device", renderers.device_of(Renderer::path));
    const RenderCall render = [&](const RenderSettings& point, const Progress& progress) {
        return renderers.draw(scene_name, posed, point, progress).film;
    };
    ProgressDisplay display(arguments);
    out =
        measure_tradeoff(std::move(out), settings, render, display.progress(short_name(scene_name), interrupt.flag()));
    display.clear();
    if (out.points.empty()) {
        warn(Terminal::of_standard_error(), "interrupted before anything was measured; nothing was written");
        return interrupt.exit_code();
    }
    const std::vector<std::filesystem::path> written = write_tradeoff(out, folder);
    put(arguments.has("json") ? tradeoff_json(out) : tradeoff_table(out));
    say(fmt::format("report: {}", written.front().string()));
    return interrupt.stopped() ? interrupt.exit_code() : 0;
}

}  // namespace etalon::cli
