#include <algorithm>
#include <chrono>
#include <cmath>

#include "engine/base/error.h"
#include "engine/render/path_state.h"

namespace etalon {
namespace {

using gpu::Commands;
using gpu::Work;
using shared::PathPush;

constexpr std::uint32_t kSmallestWave = 1u << 12;
/// Device time that a step aims at: far below any watchdog, short enough that stopping feels immediate.
constexpr double kStepSeconds = 0.05;
/// Segments traced by one submission at most, so that a deep path does not make a long one.
constexpr std::uint32_t kSegmentsPerSubmit = 16;
constexpr std::uint32_t kBandPixels = 1u << 22;
constexpr std::uint32_t kMostDepth = 1u << 16;

double seconds_since(std::chrono::steady_clock::time_point start)
{
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

PathTracer::State::State(gpu::Device& d, const PosedScene& posed, const Requirements& required,
                         const RenderSettings& settings, const Progress& progress, Traversal traversal, PixelSet pixels)
    : device(&d),
      wants_aovs(settings.aovs),
      shard(settings.shard),
      scene(make_path_scene(d, posed, required, settings, progress)),
      frame(d, {.size = sizeof(shared::PathFrame), .name = "path frame"})
{
    scene.features.chosen_pixels = pixels == PixelSet::chosen;
    kernels = make_path_kernels(d, scene, traversal);
    compile_ahead(d, kernels, settings.threads);
    scene.frame.max_depth = std::min(scene.frame.max_depth, kMostDepth);
    queues = make_path_queues(d, kWaveCapacity, scene.frame.max_depth,
                              scene.features.volume || scene.features.glass_shadows);
}

void PathTracer::State::resize(const View& view)
{
    if (view.width <= 0 || view.height <= 0)
        throw Error(Blame::input, "a picture of no pixels cannot be rendered", "give a size of at least 1x1");
    const auto w = static_cast<std::uint32_t>(view.width);
    const auto from = static_cast<std::uint32_t>(shard.first_row(view.height));
    const auto end = static_cast<std::uint32_t>(shard.end_row(view.height));
    if (from == end)
        throw Error(Blame::input, "a part of a picture has no rows", "make no more parts than the picture has rows");
    if (!bands.empty() && w == width && end - from == height && from == first_row) return;
    width = w;
    height = end - from;
    first_row = from;
    bands.clear();
    // Whole strips of 8 rows, in which the paths are ordered (generate.comp).
    const std::uint32_t rows = std::max(kBandPixels / w / 8 * 8, 8u);
    const std::uint64_t pixels = std::uint64_t{w} * height;
    aovs = gpu::Buffer(*device, {.size = wants_aovs ? 64 * std::min<std::uint64_t>(pixels, std::uint64_t{rows} * w) : 0,
                                 .name = "AOVs"});
    for (std::uint32_t row = from; row < end; row += rows) {
        const std::uint32_t count = std::min(rows, end - row) * w;
        bands.push_back(make_path_band(*device, scene, row * w, count, std::max(count, kPassSlots)));
    }
}

/// Bands of a list of pixels.
void PathTracer::State::choose(std::span<const std::uint32_t> pixels)
{
    assume(scene.features.chosen_pixels && !pixels.empty());
    width = static_cast<std::uint32_t>(pixels.size());
    height = 1;
    first_row = 0;
    bands.clear();
    aovs = gpu::Buffer(
        *device, {.size = wants_aovs ? 64 * std::min<std::uint64_t>(pixels.size(), kBandPixels) : 0, .name = "AOVs"});
    for (std::uint32_t first = 0; first < width; first += kBandPixels) {
        const std::uint32_t count = std::min(kBandPixels, width - first);
        bands.push_back(make_path_band(*device, scene, first, count, std::max(count, kPassSlots)));
        gpu::upload(*device, bands.back().pixels.buffer, pixels.subspan(first, count));
    }
}

const gpu::Bindings& PathTracer::State::bindings(PathBand& at, PathKernel& kernel, std::size_t from)
{
    const auto known = at.bindings[from].find(&kernel);
    if (known != at.bindings[from].end()) return known->second;
    const std::vector<gpu::Bind> binds = path_binds(scene, frame, queues, at, aovs, from);
    return at.bindings[from].emplace(&kernel, gpu::Bindings(*device, kernel.on(*device).layout(), binds)).first->second;
}

void PathTracer::State::launch(Commands& commands, PathBand& at, PathKernel& kernel, const PathPush& push,
                               std::uint32_t groups)
{
    commands.bind(kernel.on(*device), bindings(at, kernel, push.iteration % 2));
    commands.push(push);
    commands.dispatch(groups);
}

void PathTracer::State::launch_indirect(Commands& commands, PathBand& at, PathKernel& kernel, const PathPush& push,
                                        std::uint32_t row)
{
    commands.bind(kernel.on(*device), bindings(at, kernel, push.iteration % 2));
    commands.push(push);
    commands.dispatch_indirect(queues.dispatches, 12 * std::uint64_t{row});
}

/// One trace kernel over a queue (`row`: with indirect workgroup counts), and the exact one over what it leaves.
void PathTracer::State::trace(Commands& commands, PathBand& at, PathKernel& kernel, PathKernel& retry,
                              const PathPush& push, std::uint32_t retry_row, std::optional<std::uint32_t> row)
{
    if (row) {
        launch_indirect(commands, at, kernel, push, *row);
    } else {
        launch(commands, at, kernel, push, trace_groups(push.slot_count));
    }
    if (!kernels.retries) return;
    commands.barrier(Work::compute, Work::compute);
    launch(commands, at, kernels.plan_retries, push, 1);
    commands.barrier(Work::compute, Work::all);
    launch_indirect(commands, at, retry, push, retry_row);
    commands.barrier(Work::compute, Work::compute);
}

/// Camera rays of a wave into queue 0.
void PathTracer::State::trace_from_camera(Commands& commands, PathBand& at, PathKernel& generate, const PathPush& push)
{
    commands.fill(queues.counters, 0);
    commands.barrier(Work::copy, Work::copy);
    commands.fill(queues.counters, push.slot_count, 4 * std::uint64_t{shared::kCountPaths}, 4);
    PathPush first = push;
    first.iteration = 1;  // writes what iteration 0 reads
    commands.begin_region("generate");
    launch(commands, at, generate, first, groups_for(push.slot_count));
    commands.end_region();
    commands.barrier(Work::all, Work::compute);
}

/// What the pixels' centres show, into the hits.
void PathTracer::State::trace_centres(Commands& commands, PathBand& at, const PathPush& push)
{
    trace_from_camera(commands, at, kernels.generate_centres, push);
    trace(commands, at, kernels.trace_centres, kernels.retry_centres, push, shared::kDispatchRetryPaths, std::nullopt);
    commands.barrier(Work::compute, Work::compute);
}

/// The rays towards lights that the last plan has counted.
void PathTracer::State::trace_shadows(Commands& commands, PathBand& at, const PathPush& push)
{
    commands.begin_region("trace shadows");
    trace(commands, at, kernels.trace_shadows, kernels.retry_shadows, push, shared::kDispatchRetryShadows,
          shared::kDispatchTraceShadows);
    commands.end_region();
}

/// One segment of all paths of the wave: what it meets, what light comes from there, and where it goes on.
void PathTracer::State::bounce(Commands& commands, PathBand& at, PathPush push)
{
    const bool first = push.iteration == 0;
    const bool last = push.iteration + 1 >= scene.frame.max_depth;
    const auto indirect = [&](std::uint32_t row) { return first ? std::nullopt : std::optional(row); };
    commands.begin_region("trace paths");
    trace(commands, at, kernels.trace_paths, kernels.retry_paths, push, shared::kDispatchRetryPaths,
          indirect(shared::kDispatchTracePaths));
    commands.end_region();
    commands.barrier(Work::compute, Work::compute);
    commands.begin_region("shade");
    if (first) {
        launch(commands, at, kernels.shade, push, groups_for(push.slot_count));
    } else {
        launch_indirect(commands, at, kernels.shade, push, shared::kDispatchShade);
    }
    commands.end_region();
    if (last) return;
    commands.barrier(Work::all, Work::compute);
    launch(commands, at, kernels.plan, push, 1);
    commands.barrier(Work::compute, Work::all);
    if (scene.frame.strategy_count == 0) return;
    trace_shadows(commands, at, push);
}

void PathTracer::State::finish(Commands& commands)
{
    commands.submit();
    commands.wait();
    if (!timing) return;
    for (const gpu::RegionTime& region : commands.times()) {
        const auto same = [&](const KernelTime& t) { return t.name == region.name; };
        const auto found = std::find_if(times.begin(), times.end(), same);
        if (found == times.end()) {
            times.push_back({region.name, region.milliseconds});
        } else {
            found->milliseconds += region.milliseconds;
        }
    }
}

void PathTracer::State::begin_pass(std::uint64_t most_samples)
{
    if (in_block == kBlockSamples) {
        read_block(total);
        first_of_block += in_block;
        in_block = 0;
    }
    const std::uint64_t left = most_samples - first_of_block - in_block;
    // Long passes are cheaper, but a stop loses the one at hand: it is never more than a quarter of what is done, where
    // that is more than a wave.
    std::uint64_t fits = 1;
    if (bands.size() == 1) {
        const std::uint32_t pixels = bands[0].pixel_count;
        fits = std::max<std::uint64_t>(std::min<std::uint64_t>(kPassSlots / pixels, (first_of_block + in_block) / 4),
                                       std::max(1u, kWaveCapacity / 2 / pixels));
    }
    in_pass = static_cast<std::uint32_t>(std::min<std::uint64_t>({left, fits, kBlockSamples - in_block}));
    band = 0;
    next_slot = 0;
    slots_done = 0;
}

/// Follows the paths of a wave to their ends by the kernel that does all of it; how many of them it has left, and to
/// whom, is said by kCountLeftOver and the list of retries.
std::uint32_t PathTracer::State::run_fused(PathBand& at, const PathPush& push)
{
    Commands commands(*device, "paths");
    commands.fill(queues.counters, 0);
    commands.barrier(Work::copy, Work::compute);
    commands.begin_region("paths");
    launch(commands, at, kernels.fused, push, trace_groups(push.slot_count));
    commands.end_region();
    finish(commands);
    return gpu::read_back<std::uint32_t>(*device, queues.counters, 1, 4 * std::uint64_t{shared::kCountLeftOver})[0];
}

/// Follows the next `count` paths of the pass to their ends.
void PathTracer::State::run_wave(PathBand& at, std::uint32_t count)
{
    PathPush push{.first_slot = next_slot,
                  .slot_count = count,
                  .pixel_count = at.pixel_count,
                  .first_pixel = at.first_pixel,
                  .first_sample = static_cast<std::uint32_t>(first_of_block + in_block),
                  .sample_count = in_pass,
                  .iteration = 0,
                  .done = in_block};
    PathKernel* generate = &kernels.generate;
    if (kernels.fuses) {
        push.slot_count = run_fused(at, push);
        if (push.slot_count == 0) return;
        generate = &kernels.generate_left;
    }
    const std::uint32_t depth = scene.frame.max_depth;
    for (std::uint32_t begin = 0; begin < depth; begin += kSegmentsPerSubmit) {
        const std::uint32_t end = std::min(depth, begin + kSegmentsPerSubmit);
        Commands commands(*device, "path wave");
        if (begin == 0) trace_from_camera(commands, at, *generate, push);
        for (push.iteration = begin; push.iteration < end; ++push.iteration) bounce(commands, at, push);
        finish(commands);
        if (end == depth) break;
        const std::uint64_t counter = 4 * (std::uint64_t{shared::kCountersPerIteration} * end + shared::kCountPaths);
        if (gpu::read_back<std::uint32_t>(*device, queues.counters, 1, counter)[0] == 0) break;
    }
}

void PathTracer::State::end_pass()
{
    Commands commands(*device, "path film");
    commands.begin_region("accumulate");
    for (PathBand& at : bands) {
        PathPush push{};
        push.pixel_count = at.pixel_count;
        push.first_pixel = at.first_pixel;
        push.sample_count = in_pass;
        push.done = in_block;
        launch(commands, at, kernels.accumulate, push, groups_for(at.pixel_count));
    }
    commands.end_region();
    finish(commands);
    in_block += in_pass;
    in_pass = 0;
}

PathTracer::PathTracer(gpu::Device& device, const PosedScene& posed, const Requirements& required,
                       const RenderSettings& settings, const Progress& progress, Traversal traversal, PixelSet pixels)
    : state_(std::make_unique<State>(device, posed, required, settings, progress, traversal, pixels))
{
    if (pixels == PixelSet::all) start(posed.view);
}

PathTracer::PathTracer(PathTracer&&) noexcept = default;
PathTracer& PathTracer::operator=(PathTracer&&) noexcept = default;
PathTracer::~PathTracer() = default;

void PathTracer::start(const View& view, std::uint64_t seed)
{
    state_->scene.frame.seed = path_seed(seed);
    start(view);
}

void PathTracer::start(const View& view)
{
    assume(!state_->scene.features.chosen_pixels);
    state_->resize(view);
    state_->look_through(view);
    resume(state_->nothing());
}

void PathTracer::start(const View& view, std::uint64_t seed, std::span<const std::uint32_t> pixels)
{
    state_->scene.frame.seed = path_seed(seed);
    state_->choose(pixels);
    state_->look_through(view);
    resume(state_->nothing());
}

void PathTracer::State::look_through(const View& view)
{
    set_view(scene.frame, view, scene.origin);
    gpu::upload(*device, frame, std::as_bytes(std::span(&scene.frame, 1)));
}

PathSamples PathTracer::kept() const
{
    return state_->total;
}

void PathTracer::resume(const PathSamples& kept)
{
    state_->total = kept;
    state_->first_of_block = kept.samples();
    state_->in_block = state_->in_pass = 0;
    state_->unreached.clear();
}

void PathTracer::stop_pass()
{
    State& s = *state_;
    if (s.in_pass == 0) return;
    if (samples() > 0) {
        s.in_pass = 0;
        return;
    }
    const bool all_reached = s.bands.size() == 1 && s.next_slot >= s.bands[0].pixel_count;
    if (!all_reached) s.mark_unreached();
    s.in_pass = all_reached ? s.next_slot / s.bands[0].pixel_count : 1;
    s.end_pass();
}

bool PathTracer::step(std::uint64_t most_samples)
{
    State& s = *state_;
    if (samples() >= most_samples && s.in_pass == 0) return true;
    if (s.in_pass == 0) s.begin_pass(most_samples);
    PathBand& at = s.bands[s.band];
    const std::uint32_t slots = at.pixel_count * s.in_pass;
    const std::uint32_t count = std::min({slots - s.next_slot, s.wave, kWaveCapacity});
    const auto begin = std::chrono::steady_clock::now();
    s.run_wave(at, count);
    // Towards the size that takes the time aimed at, by at most a factor of two at once.
    const double wanted = count * kStepSeconds / std::max(seconds_since(begin), 1e-6);
    if (count == s.wave || wanted < s.wave)
        s.wave = static_cast<std::uint32_t>(std::clamp(wanted, std::max(s.wave / 2.0, double(kSmallestWave)),
                                                       std::min(s.wave * 2.0, double(kWaveCapacity))));
    s.next_slot += count;
    s.slots_done += count;
    if (s.next_slot < slots) return false;
    s.next_slot = 0;
    if (++s.band < s.bands.size()) return false;
    s.end_pass();
    return true;
}

std::uint64_t PathTracer::samples() const
{
    return state_->first_of_block + state_->in_block;
}

double PathTracer::pass_fraction() const
{
    const State& s = *state_;
    if (s.in_pass == 0) return 0;
    return double(s.slots_done) / (double(s.width) * s.height * s.in_pass);
}

void PathTracer::measure_kernels(bool on)
{
    state_->timing = on;
}
const std::vector<KernelTime>& PathTracer::kernel_times() const
{
    return state_->times;
}

}  // namespace etalon
