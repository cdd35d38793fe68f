#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "engine/base/error.h"
#include "tools/etalon/arguments.h"
#include "tools/etalon/interrupt.h"
#include "tools/etalon/json.h"
#include "tools/etalon/output.h"
#include "tools/etalon/progress_display.h"
#include "tools/etalon/renderers.h"
#include "tools/etalon/scenes.h"
#include "tools/etalon/settings.h"
#include "tools/etalon/stopwatch.h"
#include "tools/etalon/terminal.h"

namespace etalon::cli {
namespace {

/// One scene and where its picture goes.
struct Job {
    std::string scene;
    std::vector<std::string> outputs;
};

std::vector<Job> plan(const Arguments& arguments)
{
    const std::vector<std::string> patterns = arguments.all("output");
    if (patterns.empty())
        throw Error(Blame::input, "render needs to know where to write", "add -o FILE.png, -o FILE.exr or -o -");
    std::vector<Job> jobs;
    std::set<std::string> taken;
    for (const std::string& scene : arguments.positional()) {
        Job job{.scene = scene, .outputs = {}};
        for (const std::string& pattern : patterns) {
            job.outputs.push_back(with_name(pattern, short_name(scene)));
            if (!taken.insert(job.outputs.back()).second)
                throw Error(Blame::input, fmt::format("two pictures would be written to {}", job.outputs.back()),
                            "put {name} into the output: -o 'out/{name}.png'");
        }
        jobs.push_back(std::move(job));
    }
    if (taken.contains("-") && arguments.has("json"))
        throw Error(Blame::input, "-o - and --json both want standard output", "leave one of them out");
    for (const std::string& output : taken) check_output(output);
    return jobs;
}

struct Seconds {
    double load = 0, pose = 0, render = 0, write = 0;
};

struct Picture {
    Film film;
    std::vector<StageTime> stages;  ///< of the rendering
    std::vector<std::string> notes;
    Seconds seconds;
    bool interrupted = false;
};

void tell(const Job& job, const Picture& picture, const RenderSettings& settings)
{
    const Film& film = picture.film;
    const std::string samples = film.samples > 1 ? fmt::format(", {} spp", film.samples) : "";
    for (const std::string& output : job.outputs)
        say(fmt::format("{}: {}x{}, {}{}, {}; error {}", output == "-" ? "standard output" : output, film.width,
                        film.height, label(settings.renderer), samples, describe_seconds(picture.seconds.render),
                        describe_error(film, settings.renderer)));
}

Json as_json(const Job& job, const Picture& picture, const RenderSettings& settings,
             const std::vector<std::string>& findings)
{
    const Film& film = picture.film;
    Json error;
    if (const auto estimate = estimate_error(film))
        error = Json::object({{"relative", estimate->relative}, {"low", estimate->low}, {"high", estimate->high}});
    const Seconds& s = picture.seconds;
    std::vector<std::pair<std::string, Json>> stages;
    for (const StageTime& stage : picture.stages) stages.emplace_back(stage.stage, stage.seconds);
    return Json::object(
        {{"scene", job.scene},
         {"outputs", job.outputs},
         {"renderer", name(settings.renderer)},
         {"device", film.metadata.at("device")},
         {"width", film.width},
         {"height", film.height},
         {"samples", film.samples},
         {"seed", settings.seed},
         {"error", error},
         {"error_text", describe_error(film, settings.renderer)},
         {"nonfinite_samples", film.nonfinite},
         {"truncated_paths", film.truncated},
         {"findings", findings},
         {"notes", picture.notes},
         {"interrupted", picture.interrupted},
         {"seconds", Json::object({{"load", s.load}, {"pose", s.pose}, {"render", s.render}, {"write", s.write}})},
         {"render_stages", Json::object(stages)}});
}

Picture make(const Job& job, const Arguments& arguments, const RenderSettings& settings, Renderers& renderers,
             const Progress& progress)
{
    Picture picture;
    Stopwatch stopwatch;
    const Scene scene = open_scene(job.scene, arguments);
    picture.seconds.load = stopwatch.lap();
    const PosedScene posed = pose(scene, pose_settings(arguments));
    picture.notes = posed.notes;
    picture.seconds.pose = stopwatch.lap();
    Drawn drawn = renderers.draw(job.scene, posed, settings, progress);
    picture.film = std::move(drawn.film);
    picture.stages = std::move(drawn.stages);
    picture.seconds.render = stopwatch.lap();
    picture.interrupted = progress.stopped();
    return picture;
}

void write(const Job& job, Picture& picture, const DevelopSettings& develop)
{
    Stopwatch stopwatch;
    for (const std::string& output : job.outputs) write_output(picture.film, develop, output);
    picture.seconds.write = stopwatch.lap();
}

}  // namespace

int render(const Arguments& arguments)
{
    const Terminal terminal = Terminal::of_standard_error();
    const RenderSettings settings = render_settings(arguments);
    const DevelopSettings develop = develop_settings(arguments);
    static_cast<void>(pose_settings(arguments));  // a misspelt view is refused before the first scene is loaded
    const std::vector<Job> jobs = plan(arguments);

    const Interrupt interrupt;
    Renderers renderers(arguments);
    std::vector<Json> results;
    bool suspicious = false;
    for (const Job& job : jobs) {
        ProgressDisplay display(arguments);
        Picture picture =
            make(job, arguments, settings, renderers, display.progress(short_name(job.scene), interrupt.flag()));
        display.clear();
        for (const std::string& note : picture.notes) say(fmt::format("{}: {}", job.scene, note));
        if (picture.film.samples == 0) {
            warn(terminal,
                 fmt::format("{}: interrupted before the first pass was done; nothing was written", job.scene));
            break;
        }
        write(job, picture, develop);
        tell(job, picture, settings);
        const std::vector<std::string> findings = suspicions(picture.film);
        for (const std::string& finding : findings) warn(terminal, fmt::format("{}: {}", job.scene, finding));
        suspicious = suspicious || !findings.empty();
        results.push_back(as_json(job, picture, settings, findings));
        if (interrupt.stopped()) break;
    }
    if (arguments.has("json")) put(Json::object({{"schema", "etalon-render/1"}, {"pictures", results}}).text() + "\n");
    if (interrupt.stopped()) return kInterruptedExitCode;
    return suspicious && arguments.has("strict") ? 1 : 0;
}

}  // namespace etalon::cli
