#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <new>
#include <set>
#include <utility>

#include "engine/base/error.h"
#include "engine/base/files.h"
#include "engine/image/shard.h"
#include "engine/measure/picture_error.h"
#include "engine/measure/to_error.h"
#include "engine/scene/degrade.h"
#include "engine/scene/digest.h"
#include "tools/etalon/arguments.h"
#include "tools/etalon/checkpoints.h"
#include "tools/etalon/frames.h"
#include "tools/etalon/interrupt.h"
#include "tools/etalon/json.h"
#include "tools/etalon/output.h"
#include "tools/etalon/progress_display.h"
#include "tools/etalon/raster_goal.h"
#include "tools/etalon/renderers.h"
#include "tools/etalon/scenes.h"
#include "tools/etalon/settings.h"
#include "tools/etalon/stopwatch.h"
#include "tools/etalon/terminal.h"
#include "tools/etalon/time_goal.h"

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
    std::string degraded;               ///< what was given up with --degrade, in words
    std::optional<PictureError> error;  ///< of --error
    std::optional<TimePlan> time;       ///< of --max-time
    double before_samples = 0;          ///< of it, seconds
    Seconds seconds;
    bool interrupted = false;
};

std::string error_words(const Picture& picture, const RenderSettings& settings)
{
    return picture.error ? describe(*picture.error) : describe_error(picture.film, settings.renderer);
}

void tell(const Picture& picture, const RenderSettings& settings)
{
    const Film& film = picture.film;
    const std::string samples = film.samples > 1 ? fmt::format(", {} spp", film.samples) : "";
    for (const std::string& output : picture.outputs)
        say(fmt::format("{}: {}x{}, {}{}, {}; error {}", output == "-" ? "standard output" : output, film.width,
                        film.height, label(settings.renderer), samples, describe_seconds(picture.seconds.render),
                        error_words(picture, settings)));
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
         {"error_text", error_words(picture, settings)},
         {"picture_error", picture.error ? Json::raw(picture_error_json(*picture.error)) : Json()},
         {"degraded", picture.degraded.empty() ? Json() : Json(picture.degraded)},
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
    if (settings.renderer == Renderer::reference_raster)
        throw Error(Blame::input, "--max-error needs a renderer whose error falls with its samples",
                    "add --renderer path");
    return ErrorGoal{*error, arguments.has("spp") ? settings.spp : kMostSamples};
}

/// What a picture is made for, besides its settings.
struct Goals {
    std::optional<ErrorGoal> error;
    std::optional<double> seconds;  ///< --max-time, for each picture
    bool probe = false;             ///< --error
};

Goals goals(const Arguments& arguments, const RenderSettings& settings)
{
    Goals out{error_goal(arguments, settings), time_goal(arguments, settings), arguments.has("error")};
    if (arguments.choice("adaptive") != 0) {
        if (settings.renderer != Renderer::path)
            throw Error(Blame::input, "--adaptive deals out the samples of the Vulkan path tracer",
                        "add --renderer path");
        // What is dealt out has to be known from the start, and is not what a state or a shard has.
        for (const char* option : {"max-time", "resume", "shard", "profile"})
            if (arguments.has(option))
                throw Error(Blame::input, fmt::format("--adaptive and --{} exclude each other", option),
                            "leave one of them out");
    }
    if (out.probe && !settings.shard.whole())
        throw Error(Blame::input, "--error is of a whole picture, not of a shard", "merge the shards first");
    return out;
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

double stage_seconds(const std::vector<StageTime>& stages, std::string_view name)
{
    double seconds = 0;
    for (const StageTime& stage : stages)
        if (stage.stage == name) seconds += stage.seconds;
    return seconds;
}

/// --error: single pixels are traced, and the picture says how far it is from them.
void measure_error_of(Picture& picture, const PosedScene& posed, const RenderSettings& settings,
                      const DevelopSettings& develop, const Progress& progress)
{
    const PixelProbe probe = trace_probe(posed, settings, {}, progress);
    if (probe.truth.samples < 2) return;  // interrupted
    picture.error = measure_picture(picture.film, probe, develop);
    for (const auto& [key, value] : picture_error_texts(*picture.error)) picture.film.metadata[key] = value;
}

Picture make(const Scene& scene, PoseSettings view, Picture picture, RenderSettings settings, const Goals& goals,
             const DevelopSettings& develop, const std::optional<Resume>& resume, Renderers& renderers,
             const Progress& unlimited)
{
    Stopwatch stopwatch;
    view.time = picture.frame.time;
    const PosedScene posed = pose(scene, view);
    picture.notes = posed.notes;
    picture.seconds.pose = stopwatch.lap();
    Progress progress = unlimited;
    if (picture.time) {
        picture.time = plan_time(picture.time->begin, *goals.seconds, ivec2(posed.view.width, posed.view.height),
                                 picture.outputs, develop);
        progress = unlimited.until(picture.time->last_sample());
    }
    std::optional<ErrorGoal> goal = goals.error;
    if (settings.renderer == Renderer::raster && (goal || picture.time)) {
        settings = choose_raster_settings(posed, settings, goal ? std::optional(goal->error) : std::nullopt,
                                          picture.time ? std::optional(picture.time->left()) : std::nullopt, renderers,
                                          picture.notes);
        goal.reset();  // it has been met as well as it can be
    }
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
    if (picture.time) {
        const double tracing = stage_seconds(picture.stages, "path tracing");
        picture.before_samples = std::max(picture.time->spent() - tracing, 0.0);
    }
    if (!picture.degraded.empty()) {
        picture.film.metadata["degraded"] = picture.degraded;
        picture.film.metadata["error"] = describe_error(picture.film, settings.renderer);
    }
    picture.seconds.render = stopwatch.lap();
    picture.interrupted = unlimited.stopped();
    if (goals.probe && picture.film.samples > 0) measure_error_of(picture, posed, settings, develop, unlimited);
    return picture;
}

/// --profile: a line for each stage on standard error.
void tell_profile(const Picture& picture)
{
    const Seconds& s = picture.seconds;
    const auto line = [](const std::string& stage, double seconds) {
        say(fmt::format("  {:<32}{:>12.3f} ms", stage, 1e3 * seconds));
    };
    say(fmt::format("{}: profile", picture.scene));
    line("load", s.load);
    line("pose", s.pose);
    line("render", s.render);
    for (const StageTime& stage : picture.stages) line("  " + stage.stage, stage.seconds);
    line("write", s.write);
}

void write(Picture& picture, const DevelopSettings& develop)
{
    Stopwatch stopwatch;
    for (const std::string& output : picture.outputs) write_output(picture.film, develop, output);
    std::set<std::filesystem::path> beside;
    for (const std::string& output : picture.outputs)
        if (picture.error && output != "-")
            beside.insert(std::filesystem::path(output).replace_extension(".error.json"));
    for (const std::filesystem::path& path : beside) replace_file(path, picture_error_json(*picture.error));
    picture.seconds.write = stopwatch.lap();
}

/// What all pictures of a run share.
struct Run {
    const Arguments& arguments;
    const std::vector<Frame> frames;
    const PoseSettings view;
    const RenderSettings settings;
    const Goals goals;
    const std::optional<Resume> resume;
    const PostChain post;
    const DevelopSettings develop;
    const Terminal terminal;
    const Interrupt interrupt;
    Renderers renderers;
    std::vector<Json> results;
    std::vector<Json> failures;  ///< of scenes that the others went on without
    int worst = 0;               ///< exit code of those
    bool suspicious = false;
    TimePoint next_picture = process_start();  ///< since when its time runs
};

/// --post: applies the passes. AOVs that only they asked for leave with them.
void post_process(Run& run, Picture& picture)
{
    if (run.post.empty() || picture.film.samples == 0) return;
    Stopwatch stopwatch;
    picture.film = run.renderers.post(std::move(picture.film), run.post, run.settings.renderer, picture.stages);
    if (!run.arguments.has("aovs")) picture.film.aovs = {};
    picture.seconds.render += stopwatch.lap();
}

/// Writes the picture and says what is to be said of it. False when it was interrupted before there was anything.
bool finish(Run& run, Picture& picture)
{
    if (picture.film.samples == 0) {
        warn(run.terminal,
             fmt::format("{}: interrupted before the first pass was done; nothing was written", picture.scene));
        return false;
    }
    post_process(run, picture);
    write(picture, run.develop);
    tell(picture, run.settings);
    if (picture.time) say("  " + tell_time(*picture.time, picture.before_samples, picture.seconds.write));
    if (run.arguments.has("profile")) tell_profile(picture);
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

/// --degrade: halves textures and picture until the first frame fits. What was given up in words; nothing where it
/// fits.
std::string degrade(Scene& scene, PoseSettings& view, const Run& run)
{
    if (!run.arguments.has("degrade")) return {};
    PoseSettings first = view;
    first.time = run.frames.front().time;
    const PosedScene posed = pose(scene, first);
    const ivec2 size(posed.view.width, posed.view.height);
    const Degradation less = plan_degradation(predict(posed, run.settings), size, limits(run.arguments).memory);
    std::vector<std::string> given_up;
    if (less.textures > 0) {
        const double change = halve_images(scene, less.textures);
        given_up.push_back(fmt::format("textures at 1/{} of their sides, which changes their texels by {:.2g}% RMS",
                                       std::uint64_t{1} << less.textures, change * 100));
    }
    if (less.picture > 0) {
        view.size = halved(size, less.picture);
        given_up.push_back(fmt::format("{}x{} pixels instead of {}x{}", view.size->x, view.size->y, size.x, size.y));
    }
    return fmt::format("{}", fmt::join(given_up, "; "));
}

/// All frames of one scene; false when the run is to end.
bool render_scene(Run& run, const Job& job)
{
    Stopwatch stopwatch;
    Scene scene = open_scene(job.scene, run.arguments);
    double load = stopwatch.lap();
    PoseSettings view = run.view;
    const std::string degraded = degrade(scene, view, run);
    if (!degraded.empty()) warn(run.terminal, fmt::format("{}: degraded to fit into memory: {}", job.scene, degraded));
    if (run.frames.size() > 1) view.framed = bounds_over(scene, view, run.frames);
    for (std::size_t i = 0; i < run.frames.size(); ++i) {
        ProgressDisplay display(run.arguments);
        Picture picture{.scene = job.scene, .frame = run.frames[i], .outputs = job.outputs[i]};
        picture.degraded = degraded;
        picture.seconds.load = std::exchange(load, 0);
        if (run.resume) picture.state_file = job.states[i];
        if (run.goals.seconds) picture.time = TimePlan{.begin = run.next_picture};
        picture = make(scene, view, std::move(picture), run.settings, run.goals, run.develop, run.resume, run.renderers,
                       display.progress(short_name(job.scene), run.interrupt.flag()));
        display.clear();
        if (i == 0)
            for (const std::string& note : picture.notes) say(fmt::format("{}: {}", job.scene, note));
        const bool finished = finish(run, picture);
        run.next_picture = std::chrono::steady_clock::now();
        if (!finished || run.interrupt.stopped()) return false;
    }
    return true;
}

/// The same where other scenes wait: a failure is said, and they go on. False when the run is to end.
bool try_scene(Run& run, const Job& job)
{
    const auto failed = [&](Error error) {
        error.at(job.scene);
        say(error);
        run.failures.push_back(Json::object({{"scene", job.scene}, {"error", cli::as_json(error)}}));
        run.worst = std::max(run.worst, error.exit_code());
        // A device that has failed is not asked again; a scene that was refused leaves it as it is.
        if (error.blame() == Blame::machine) run.renderers.forget_device();
    };
    try {
        return render_scene(run, job);
    } catch (const Error& error) {
        failed(error);
    } catch (const std::bad_alloc&) {
        failed(Error(Blame::machine, "out of memory", "a smaller --size or a smaller scene takes less"));
    }
    return !run.interrupt.stopped();
}

/// What decides a picture besides the scene, from the options and what the passes of --post read.
RenderSettings settings_for(const Arguments& arguments, const PostChain& post)
{
    RenderSettings settings = render_settings(arguments);
    settings.aovs = settings.aovs || needs_aovs(post);
    if (arguments.has("max-time") && !arguments.has("spp")) settings.spp = kMostSamples;
    if (!post.empty() && !settings.shard.whole())
        throw Error(Blame::input, "--post and --shard exclude each other: a pass sees the whole picture",
                    "merge the shards, then etalon post");
    return settings;
}

}  // namespace

int render(const Arguments& arguments)
{
    const std::vector<Frame> wanted = frames(arguments);
    // Whatever is misspelt is refused before the first scene is loaded.
    const PostChain post = arguments.has("post") ? parse_post(*arguments.text("post")) : PostChain{};
    const RenderSettings settings = settings_for(arguments, post);
    Run run{.arguments = arguments,
            .frames = wanted,
            .view = pose_settings(arguments),
            .settings = settings,
            .goals = goals(arguments, settings),
            .resume = resume(arguments, settings),
            .post = post,
            .develop = develop_settings(arguments),
            .terminal = Terminal::of_standard_error(),
            .interrupt = {},
            .renderers = Renderers(arguments),
            .results = {},
            .failures = {}};
    const std::vector<Job> jobs = plan(arguments, wanted, run.resume);
    for (const Job& job : jobs)
        if (!(jobs.size() == 1 ? render_scene(run, job) : try_scene(run, job))) break;
    if (arguments.has("json"))
        put(Json::object({{"schema", "etalon-render/1"}, {"pictures", run.results}, {"failures", run.failures}})
                .text() +
            "\n");
    if (run.interrupt.stopped()) return run.interrupt.exit_code();
    if (!run.failures.empty()) say(fmt::format("{} of {} scenes failed", run.failures.size(), jobs.size()));
    return std::max(run.worst, run.suspicious && arguments.has("strict") ? 1 : 0);
}

}  // namespace etalon::cli
