#include <fmt/format.h>

#include <algorithm>

#include "engine/base/error.h"
#include "engine/measure/agreement.h"
#include "engine/measure/picture_error.h"
#include "engine/measure/rasters.h"
#include "engine/scene/knobs.h"
#include "tools/etalon/arguments.h"
#include "tools/etalon/interrupt.h"
#include "tools/etalon/output.h"
#include "tools/etalon/progress_display.h"
#include "tools/etalon/provenance.h"
#include "tools/etalon/renderers.h"
#include "tools/etalon/scenes.h"
#include "tools/etalon/settings.h"
#include "tools/etalon/stopwatch.h"
#include "tools/etalon/terminal.h"

namespace etalon::cli {
namespace {

std::vector<Renderer> contestants(const Arguments& arguments)
{
    const std::vector<std::string>& names = find_option(*find_command("render"), "renderer")->choices;
    constexpr Renderer kRenderers[] = {Renderer::raster, Renderer::path, Renderer::reference,
                                       Renderer::reference_raster};
    const std::string list = arguments.text("renderers").value_or("");
    std::vector<Renderer> chosen;
    for (const std::string& word : split(list, ',')) {
        const auto found = std::find(names.begin(), names.end(), word);
        if (found == names.end()) {
            const std::string_view meant = nearest(word, names);
            refuse("renderers", list, fmt::format("names out of {}", fmt::join(names, ", ")),
                   meant.empty() ? "" : fmt::format("did you mean {}?", meant));
        }
        const Renderer renderer = kRenderers[found - names.begin()];
        if (std::find(chosen.begin(), chosen.end(), renderer) != chosen.end())
            refuse("renderers", list, "each name once");
        chosen.push_back(renderer);
    }
    return chosen;
}

/// Each renderer draws its own random numbers: with shared ones the two errors would correlate and the test mean
/// nothing.
RenderSettings of_contender(RenderSettings settings, Renderer renderer)
{
    settings.renderer = renderer;
    settings.seed = settings.seed * 4 + static_cast<std::uint64_t>(renderer);
    return settings;
}

Contender contender(const std::string& scene_name, const PosedScene& posed, const RenderSettings& settings,
                    Renderers& renderers)
{
    const Renderer renderer = settings.renderer;
    const auto render = [&renderers, &posed, scene_name, settings](const Progress& progress) {
        Stopwatch stopwatch;
        RendererRun run{.name = std::string(name(settings.renderer)),
                        .label = std::string(label(settings.renderer)),
                        .device = {},
                        .film = {},
                        .stages = {}};
        Drawn drawn = renderers.draw(scene_name, posed, settings, progress);
        run.film = std::move(drawn.film);
        run.stages = std::move(drawn.stages);
        run.device = run.film.metadata.at("device");
        double told = 0;
        for (const StageTime& stage : run.stages) told += stage.seconds;
        // The report adds the stages up: what the renderer did not name completes them.
        run.stages.push_back({told > 0 ? "rest" : "render", std::max(0.0, stopwatch.lap() - told)});
        return run;
    };
    return {
        .kind = renderer, .name = std::string(name(renderer)), .label = std::string(label(renderer)), .render = render};
}

}  // namespace

int compare(const Arguments& arguments)
{
    const std::string& scene_name = arguments.positional().front();
    const std::filesystem::path folder = arguments.text("output").value_or("out/" + short_name(scene_name));
    const std::vector<Renderer> chosen = contestants(arguments);
    const RenderSettings settings = render_settings(arguments);
    CompareSettings comparing{.rounding = kDeviceRounding};
    comparing.false_alarm = arguments.number("false-alarm", 1e-12, 0.5).value_or(comparing.false_alarm);
    const PoseSettings view = pose_settings(arguments);

    check_folder(folder);

    const Interrupt interrupt;
    Renderers renderers(arguments);
    Report report{.scene = scene_name,
                  .command = command_line(arguments),
                  .versions = versions(),
                  .develop = develop_settings(arguments)};
    Stopwatch stopwatch;
    const Scene scene = open_scene(scene_name, arguments);
    report.stages.push_back({"load", stopwatch.lap()});
    const PosedScene posed = pose(scene, view);
    report.stages.push_back({"pose", stopwatch.lap()});
    report.settings = describe(posed, settings);
    report.notes = scene.warnings;
    report.notes.insert(report.notes.end(), posed.notes.begin(), posed.notes.end());

    std::vector<Contender> contenders;
    contenders.reserve(chosen.size());
    for (const Renderer renderer : chosen)
        contenders.push_back(contender(scene_name, posed, of_contender(settings, renderer), renderers));
    const auto judge = [&](const Film& device, const Film& reference) {
        return judge_rasters(posed, settings, renderers.raster_precision(), device, reference);
    };
    const auto probe = [&](const Progress& progress) {
        return trace_probe(posed, settings, {.pixels = 1024, .samples = 64}, progress);
    };
    ProgressDisplay display(arguments);
    report =
        measure_agreement(std::move(report), contenders, {.compare = comparing, .judge_rasters = judge, .probe = probe},
                          display.progress(short_name(scene_name), interrupt.flag()));
    display.clear();

    const std::vector<std::filesystem::path> written = write_report(report, folder);
    put(arguments.has("json") ? report_json(report) : report_table(report));
    say(fmt::format("report: {}", written.front().string()));
    if (interrupt.stopped()) return interrupt.exit_code();
    return passed(report) ? 0 : 1;
}

}  // namespace etalon::cli
