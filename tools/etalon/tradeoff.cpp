#include "engine/measure/tradeoff.h"

#include <fmt/format.h>

#include "engine/base/error.h"
#include "engine/measure/frontier_profile.h"
#include "engine/scene/digest.h"
#include "engine/scene/footprint.h"
#include "engine/scene/knobs.h"
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

/// Everything that decides the reference but its samples: scene, view and light by their content, settings, what draws
/// it and which build of it.
std::string cache_key(const PosedScene& posed, const RenderSettings& settings, const std::string& device)
{
    std::string key =
        fmt::format("{} {} {} {} {} {}", digest(posed).text(), build_key(), device, static_cast<int>(settings.shading),
                    static_cast<int>(settings.background), settings.seed);
    const dvec3 b = settings.background_color;
    key += fmt::format(" {},{},{}", b.x, b.y, b.z);
    for (const Knob& knob : knobs())
        if (knob.name != "spp") key += fmt::format(" {}={}", knob.name, knob_value(settings, knob.name));
    return key;
}

}  // namespace

int tradeoff(const Arguments& arguments)
{
    const std::string& scene_name = arguments.positional().front();
    const std::filesystem::path folder = measuring_folder(arguments);
    TradeoffSettings settings = tradeoff_settings(arguments);
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
        return renderers.draw_again(scene_name, posed, point, progress);
    };
    std::optional<ReferenceCache> cache;
    if (const auto place = cache_folder("references"); place && !arguments.has("no-cache")) cache.emplace(*place);
    settings.cache = cache ? &*cache : nullptr;
    settings.cache_key = cache_key(posed, settings.standard, renderers.device_of(Renderer::path));
    settings.memory = [&](const RenderSettings& point) { return predict(posed, point).total(); };
    ProgressDisplay display(arguments);
    out =
        measure_tradeoff(std::move(out), settings, render, display.progress(short_name(scene_name), interrupt.flag()));
    display.clear();
    if (out.points.empty()) {
        warn(Terminal::of_standard_error(), "interrupted before anything was measured; nothing was written");
        return interrupt.exit_code();
    }
    const std::vector<std::filesystem::path> written = write_tradeoff(out, folder);
    if (const auto place = cache_folder("profiles"); place && !arguments.has("no-cache"))
        ProfileStore(*place).keep(profile_key(posed, settings.standard, renderers.device_of(Renderer::raster)),
                                  profile_of(out));
    put(arguments.has("json") ? tradeoff_json(out) : tradeoff_table(out));
    say(fmt::format("report: {}", written.front().string()));
    return interrupt.stopped() ? interrupt.exit_code() : 0;
}

}  // namespace etalon::cli
