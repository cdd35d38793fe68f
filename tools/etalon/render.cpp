#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <utility>

#include "engine/base/error.h"
#include "engine/image/shard.h"
#include "engine/measure/to_error.h"
#include "engine/scene/digest.h"
#include "tools/etalon/arguments.h"
#include "tools/etalon/checkpoints.h"
#include "tools/etalon/frames.h"
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

/// One scene and where its pictures go.
struct Job {
    std::string scene;
    std::vector<std::vector<std::string>> outputs;  ///< of each frame
    std::vector<std::string> states;                ///< the file of each frame's state; empty without --resume
};

std::vector<Job> plan(const Arguments& arguments, const std::vector<Frame>& frames, const std::optional<Resume>& resume)
{
    const std::vector<std::string> patterns = arguments.all("output");
    if (patterns.empty())
        throw Error(Blame::input, "render needs to know where to write", "add -o FILE.png, -o FILE.exr or -o -");
    std::vector<Job> jobs;
    std::set<std::string> taken, states;
    for (const std::string& scene : arguments.positional()) {
        Job job{.scene = scene, .outputs = {}, .states = {}};
        for (const Frame& frame : frames) {
            std::vector<std::string>& outputs = job.outputs.emplace_back();
            for (const std::string& pattern : patterns) {
                outputs.push_back(with_name(with_number(pattern, frame), short_name(scene)));
                if (!taken.insert(outputs.back()).second)
                    throw Error(Blame::input, fmt::format("two pictures would be written to {}", outputs.back()),
                                "put {name} into the output: -o 'out/{name}.png'");
            }
            if (!resume) continue;
            job.states.push_back(with_name(with_number(resume->pattern, frame), short_name(scene)));
            if (!states.insert(job.states.back()).second)
                throw Error(Blame::input, fmt::format("two pictures would be kept in {}", job.states.back()),
                            "put {name} into it: --resume '{name}.state'");
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
    std::string scene;
    Frame frame;
    std::vector<std::string> outputs;
    std::string state_file;  ///< empty: none
    Film film;
    std::vector<StageTime> stages;  ///< of the rendering
    std::vector<std::string> notes;
    Seconds seconds;
    bool interrupted = false;
};

void tell(const Picture& picture, const RenderSettings& settings)
{
    const Film& film = picture.film;
    const std::string samples = film.samples > 1 ? fmt::format(", {} spp", film.samples) : "";
    for (const std::string& output : picture.outputs)
        say(fmt::format("{}: {}x{}, {}{}, {}; error {}", output == "-" ? "standard output" : output, film.width,
                        film.height, label(settings.renderer), samples, describe_seconds(picture.seconds.render),
                        describe_error(film, settings.renderer)));
}

std::uint64_t pixels_without_samples(const Film& film)
{
    const auto found = film.metadata.find("pixels.unreached");
    return found == film.metadata.end() ? 0 : std::stoull(found->second);
}

Json as_json(const Picture& picture, const RenderSettings& settings, const std::vector<std::string>& findings)
{
    const Film& film = picture.film;
    Json error;
    if (const auto estimate = estimate_error(film))
        error = Json::object({{"relative", estimate->relative}, {"low", estimate->low}, {"high", estimate->high}});
    const Seconds& s = picture.seconds;
    std::vector<std::pair<std::string, Json>> stages;
    for (const StageTime& stage : picture.stages) stages.emplace_back(stage.stage, stage.seconds);
    return Json::object(
        {{"scene", picture.scene},
         {"outputs", picture.outputs},
         {"frame", picture.frame.number ? Json(*picture.frame.number) : Json()},
         {"time_seconds", picture.frame.time ? Json(*picture.frame.time) : Json()},
         {"renderer", name(settings.renderer)},
         {"device", film.metadata.at("device")},
         {"width", film.width},
         {"height", film.height},
         {"samples", film.samples},
         {"pixels_without_samples", pixels_without_samples(film)},
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

/// Samples a pixel that --max-error may take where --spp does not say.
constexpr std::uint64_t kMostSamples = std::uint64_t{1} << 16;

/// --max-error: samples until the whole picture's relative standard error is `error`, and no more than `most`.
struct ErrorGoal {
    double error = 0;
    std::uint64_t most = kMostSamples;
};

std::optional<ErrorGoal> error_goal(const Arguments& arguments, const RenderSettings& settings)
{
    const std::optional<double> error = arguments.number("max-error", 1e-6, 10);
    if (!error) return std::nullopt;
    if (settings.renderer != Renderer::path && settings.renderer != Renderer::reference)
        throw Error(Blame::input, "--max-error needs a renderer whose error falls with its samples",
                    "add --renderer path");
    return ErrorGoal{*error, arguments.has("spp") ? settings.spp : kMostSamples};
}

Film draw_to_error(const ErrorGoal& goal, const RenderSettings& settings,
                   const std::function<Film(const RenderSettings&, const Progress&)>& draw, Picture& picture,
                   const Progress& progress)
{
    FilmToError made = render_to_error(settings, goal.error, goal.most, draw, progress);
    const std::optional<ErrorEstimate> reached = estimate_error(made.film);
    if (made.capped)
        picture.notes.push_back(
            fmt::format("an error of {} needs more than {} samples a pixel: that many were taken "
                        "(--spp raises it)",
                        goal.error, goal.most));
    else if (reached && reached->low > goal.error && !progress.stopped())
        picture.notes.push_back(
            fmt::format("the pilot of {} samples had not seen the brightest paths: the error is "
                        "above the asked {}",
                        made.pilot_samples, goal.error));
    return std::move(made.film);
}

Film draw_from_state(const PosedScene& posed, const RenderSettings& settings, const Resume& resume,
                     Renderers& renderers, Picture& picture, const Progress& progress)
{
    StateFile file(picture.state_file, resume.seconds, posed, settings, renderers.device_of(settings.renderer));
    if (file.begun() > 0)
        picture.notes.push_back(
            fmt::format("going on from {} samples a pixel of {}", file.begun(), picture.state_file));
    Drawn drawn = renderers.draw(picture.scene, posed, settings, progress, file.checkpoints());
    picture.stages = std::move(drawn.stages);
    return std::move(drawn.film);
}

void mark_shard(Film& film, const PosedScene& posed, const Shard& shard)
{
    if (shard.whole()) return;
    etalon::mark_shard(film, {.number = shard.number,
                              .count = shard.count,
                              .first_row = shard.first_row(posed.view.height),
                              .picture_height = posed.view.height,
                              .scene = digest(posed).text()});
}

Picture make(const Scene& scene, PoseSettings view, Picture picture, const RenderSettings& settings,
             const std::optional<ErrorGoal>& goal, const std::optional<Resume>& resume, Renderers& renderers,
             const Progress& progress)
{
    Stopwatch stopwatch;
    view.time = picture.frame.time;
    const PosedScene posed = pose(scene, view);
    picture.notes = posed.notes;
    picture.seconds.pose = stopwatch.lap();
    const auto draw = [&](const RenderSettings& how, const Progress& told) {
        Drawn drawn = renderers.draw(picture.scene, posed, how, told);
        picture.stages = std::move(drawn.stages);
        return std::move(drawn.film);
    };
    if (resume)
        picture.film = draw_from_state(posed, settings, *resume, renderers, picture, progress);
    else
        picture.film = goal ? draw_to_error(*goal, settings, draw, picture, progress) : draw(settings, progress);
    mark_shard(picture.film, posed, settings.shard);
    picture.seconds.render = stopwatch.lap();
    picture.interrupted = progress.stopped();
    return picture;
}

void write(Picture& picture, const DevelopSettings& develop)
{
    Stopwatch stopwatch;
    for (const std::string& output : picture.outputs) write_output(picture.film, develop, output);
    picture.seconds.write = stopwatch.lap();
}

/// What all pictures of a run share.
struct Run {
    const Arguments& arguments;
    const std::vector<Frame> frames;
    const PoseSettings view;
    const RenderSettings settings;
    const std::optional<ErrorGoal> goal;
    const std::optional<Resume> resume;
    const DevelopSettings develop;
    const Terminal terminal;
    const Interrupt interrupt;
    Renderers renderers;
    std::vector<Json> results;
    bool suspicious = false;
};

/// Writes the picture and says what is to be said of it. False when it was interrupted before there was anything.
bool finish(Run& run, Picture& picture)
{
    if (picture.film.samples == 0) {
        warn(run.terminal,
             fmt::format("{}: interrupted before the first pass was done; nothing was written", picture.scene));
        return false;
    }
    write(picture, run.develop);
    tell(picture, run.settings);
    if (const std::uint64_t none = pixels_without_samples(picture.film); none > 0)
        warn(run.terminal,
             fmt::format("{}: interrupted in the first pass: {} of {} pixels have no sample and are black and "
                         "transparent",
                         picture.scene, none, picture.film.pixel_count()));
    const std::vector<std::string> findings = suspicions(picture.film);
    for (const std::string& finding : findings) warn(run.terminal, fmt::format("{}: {}", picture.scene, finding));
    run.suspicious = run.suspicious || !findings.empty();
    run.results.push_back(as_json(picture, run.settings, findings));
    return true;
}

/// All frames of one scene; false when the run is to end.
bool render_scene(Run& run, const Job& job)
{
    Stopwatch stopwatch;
    const Scene scene = open_scene(job.scene, run.arguments);
    double load = stopwatch.lap();
    PoseSettings view = run.view;
    if (run.frames.size() > 1) view.framed = bounds_over(scene, view, run.frames);
    for (std::size_t i = 0; i < run.frames.size(); ++i) {
        ProgressDisplay display(run.arguments);
        Picture picture{.scene = job.scene, .frame = run.frames[i], .outputs = job.outputs[i]};
        picture.seconds.load = std::exchange(load, 0);
        if (run.resume) picture.state_file = job.states[i];
        picture = make(scene, view, std::move(picture), run.settings, run.goal, run.resume, run.renderers,
                       display.progress(short_name(job.scene), run.interrupt.flag()));
        display.clear();
        if (i == 0)
            for (const std::string& note : picture.notes) say(fmt::format("{}: {}", job.scene, note));
        if (!finish(run, picture) || run.interrupt.stopped()) return false;
    }
    return true;
}

}  // namespace

int render(const Arguments& arguments)
{
    const std::vector<Frame> wanted = frames(arguments);
    // Whatever is misspelt is refused before the first scene is loaded.
    const RenderSettings settings = render_settings(arguments);
    Run run{.arguments = arguments,
            .frames = wanted,
            .view = pose_settings(arguments),
            .settings = settings,
            .goal = error_goal(arguments, settings),
            .resume = resume(arguments, settings),
            .develop = develop_settings(arguments),
            .terminal = Terminal::of_standard_error(),
            .interrupt = {},
            .renderers = Renderers(arguments),
            .results = {}};
    for (const Job& job : plan(arguments, wanted, run.resume))
        if (!render_scene(run, job)) break;
    if (arguments.has("json"))
        put(Json::object({{"schema", "etalon-render/1"}, {"pictures", run.results}}).text() + "\n");
    if (run.interrupt.stopped()) return run.interrupt.exit_code();
    return run.suspicious && arguments.has("strict") ? 1 : 0;
}

}  // namespace etalon::cli
