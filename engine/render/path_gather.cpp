#include "engine/render/path_gather.h"

#include <fmt/format.h>

#include <bit>

#include "engine/base/error.h"
#include "engine/render/path_state.h"
#include "etalon_shaders.h"
#include "shaders/shared/gather.h"

namespace etalon {
namespace {

using gpu::Commands;
using gpu::Work;
using shared::PathPush;

/// The path tracer's settings under which rays are followed: evenly spread, as few paths are taken.
RenderSettings settings_of_paths(RenderSettings settings)
{
    settings.renderer = Renderer::path;
    settings.sampler = Sequence::sobol;
    settings.aovs = false;
    settings.shard = {};
    return settings;
}

PathTracer make_tracer(gpu::Device& device, const PosedScene& posed, const RenderSettings& settings,
                       const Progress& progress)
{
    if (device.backend() != gpu::Backend::vulkan)
        throw Error(Blame::machine, "rays in rasterized pictures are traced by Vulkan alone",
                    "render with --backend vulkan, or without --ambient-rays and --shadows ray");
    const RenderSettings paths = settings_of_paths(settings);
    return {device, posed, require(posed, paths), paths, progress, Traversal::queues};
}

gpu::Image make_image(gpu::Device& device, const View& view, VkFormat format, const char* name)
{
    return {device,
            {.format = format,
             .width = static_cast<std::uint32_t>(view.width),
             .height = static_cast<std::uint32_t>(view.height),
             .usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_STORAGE_BIT,
             .name = name}};
}

}  // namespace

PathGather::PathGather(gpu::Device& device, const PosedScene& posed, const RenderSettings& settings,
                       const Wanted& wanted, const Progress& progress)
    : device_(device), wanted_(wanted), progress_(progress), tracer_(make_tracer(device, posed, settings, progress))
{
    using namespace shared;
    const PathTracer::State& state = *tracer_.state_;
    for (std::uint32_t i = 0; i < posed.lights.size(); ++i)
        if (posed.lights[i].light.color * posed.lights[i].light.intensity != dvec3(0)) lights_.push_back(i);
    if (wanted.shadows && !lights_.empty() && lights_.back() >= kMostLitLights)
        throw Error(Blame::input,
                    fmt::format("the scene has {} lights, and --shadows ray knows the shadows of {}",
                                posed.lights.size(), kMostLitLights),
                    "render with --shadows map");
    std::vector<gpu::Constant> constants = path_constants(state.scene.features);
    const auto lanes = static_cast<std::uint32_t>(std::bit_width(device.limits().subgroup_size) - 1);
    constants.insert(constants.end(), {{kSpecSubgroupLog2, lanes}, {kSpecLightTree, state.scene.light_tree}});
    const auto compile = [&](const char* path, bool shadows = false) {
        std::vector<gpu::Constant> all = constants;
        all.emplace_back(kSpecShadow, shadows);
        return gpu::ComputePipeline(device, {.shader = {etalon_shaders::find(path), all}, .name = path});
    };
    kernels_.points = compile("path/gather_points.comp");
    if (wanted.paths > 0) {
        kernels_.start = compile("path/gather_start.comp");
        kernels_.light = compile("path/gather_light.comp");
        kernels_.sum_light = compile("path/gather_sum.comp");
    }
    if (wanted.shadows) {
        kernels_.shadow = compile("path/gather_shadow.comp");
        kernels_.sum_shadow = compile("path/gather_sum.comp", true);
    }
    points_.buffer = gpu::Buffer(device, {.size = 32 * std::uint64_t{kWaveCapacity}, .name = "gathering points"});
    points_.view = gpu::TexelView(device, points_.buffer, VK_FORMAT_R32G32B32A32_UINT);
    known_ = gpu::Buffer(device, {.size = 32 * std::uint64_t{kWaveCapacity}, .name = "gathering controls"});
    sums_ = gpu::Buffer(device, {.size = 48 * std::uint64_t{kWaveCapacity}, .name = "gathering sums"});
    resize(posed.view);
}

bool PathGather::resize(const View& view)
{
    if (light_ && light_.width() == static_cast<std::uint32_t>(view.width) &&
        light_.height() == static_cast<std::uint32_t>(view.height))
        return false;
    bound_.clear();
    light_ = make_image(device_, view, VK_FORMAT_R32G32B32A32_SFLOAT, "gathered light");
    lit_ = make_image(device_, view, VK_FORMAT_R32G32B32A32_UINT, "gathered shadows");
    tracer_.start(view);
    bind();
    return true;
}

/// What a kernel reads and writes at the first segment: that of queue 0, towards queue 1.
void PathGather::bind()
{
    using namespace shared;
    const PathTracer::State& state = *tracer_.state_;
    for (const PathBand& band : state.bands) {
        std::vector<gpu::Bind> binds = path_binds(state.scene, state.frame, state.queues, band, state.aovs, 0);
        binds.insert(binds.end(), {{kBindPoints, points_.view},
                                   {kBindPointsOut, points_.buffer},
                                   {kBindKnown, known_},
                                   {kBindSums, sums_},
                                   {kBindGathered, light_},
                                   {kBindLit, lit_}});
        Bound& bound = bound_.emplace_back();
        const auto add = [&](const gpu::ComputePipeline& kernel) {
            if (kernel.handle() != VK_NULL_HANDLE)
                bound.emplace(&kernel, gpu::Bindings(device_, kernel.layout(), binds));
        };
        for (const gpu::ComputePipeline* kernel :
             {&kernels_.points, &kernels_.light, &kernels_.shadow, &kernels_.sum_light, &kernels_.sum_shadow})
            add(*kernel);
        // Viewing rays go where the first segment reads them.
        std::erase_if(binds, [](const gpu::Bind& bind) { return bind.binding == kBindPathsOut; });
        binds.emplace_back(kBindPathsOut, state.queues.paths[0].buffer);
        add(kernels_.start);
    }
}

void PathGather::launch(Commands& commands, std::size_t band, const gpu::ComputePipeline& kernel,
                        const PathPush& push) const
{
    commands.bind(kernel, bound_[band].at(&kernel));
    commands.push(push);
    commands.dispatch(groups_for(push.slot_count));
}

/// How many of the wave's pixels show a surface.
std::uint32_t PathGather::find_points(std::size_t band, const PathPush& push)
{
    PathTracer::State& state = *tracer_.state_;
    Commands commands(device_, "gathering points");
    commands.fill(sums_, 0);
    state.trace_centres(commands, state.bands[band], push);
    launch(commands, band, kernels_.points, push);
    state.finish(commands);
    const std::uint64_t counter = 4 * std::uint64_t{shared::kCountersPerIteration + shared::kCountPoints};
    return gpu::read_back<std::uint32_t>(device_, state.queues.counters, 1, counter)[0];
}

/// One path from each point: its own first segment, then as the path tracer goes on.
void PathGather::add_path(std::size_t band, PathPush push)
{
    PathTracer::State& state = *tracer_.state_;
    PathBand& at = state.bands[band];
    Commands commands(device_, "gathering");
    commands.fill(state.queues.counters, 0);
    commands.barrier(Work::copy, Work::copy);
    commands.fill(state.queues.counters, push.slot_count, 4 * std::uint64_t{shared::kCountPaths}, 4);
    commands.barrier(Work::copy, Work::all);
    launch(commands, band, kernels_.start, push);
    commands.barrier(Work::all, Work::compute);
    state.trace(commands, at, state.kernels.trace_centres, state.kernels.retry_centres, push,
                shared::kDispatchRetryPaths, std::nullopt);
    commands.barrier(Work::compute, Work::compute);
    launch(commands, band, kernels_.light, push);
    commands.barrier(Work::all, Work::compute);
    state.launch(commands, at, state.kernels.plan, push, 1);
    commands.barrier(Work::compute, Work::all);
    if (state.scene.frame.strategy_count > 0) state.trace_shadows(commands, at, push);
    for (push.iteration = 1; push.iteration < state.scene.frame.max_depth; ++push.iteration) {
        commands.barrier(Work::compute, Work::all);
        state.bounce(commands, at, push);
    }
    commands.barrier(Work::compute, Work::compute);
    push.iteration = 0;
    launch(commands, band, kernels_.sum_light, push);
    state.finish(commands);
}

/// A ray from each point towards one light: `done` in the path tracer's list, `sample_count` in the posed scene's.
void PathGather::add_shadow(std::size_t band, PathPush push)
{
    PathTracer::State& state = *tracer_.state_;
    PathBand& at = state.bands[band];
    Commands commands(device_, "gathering shadows");
    commands.fill(state.queues.counters, 0);
    commands.barrier(Work::copy, Work::all);
    launch(commands, band, kernels_.shadow, push);
    commands.barrier(Work::all, Work::compute);
    state.launch(commands, at, state.kernels.plan, push, 1);
    commands.barrier(Work::compute, Work::all);
    state.trace_shadows(commands, at, push);
    commands.barrier(Work::compute, Work::compute);
    launch(commands, band, kernels_.sum_shadow, push);
    state.finish(commands);
}

void PathGather::run(const View& view)
{
    tracer_.start(view);
    PathTracer::State& state = *tracer_.state_;
    gpu::run(device_, [&](Commands& commands) {
        commands.prepare(light_, gpu::ImageUse::storage, true);
        commands.prepare(lit_, gpu::ImageUse::storage, true);
    });
    for (std::size_t band = 0; band < state.bands.size(); ++band) {
        const PathBand& at = state.bands[band];
        for (std::uint32_t slot = 0; slot < at.pixel_count; slot += kWaveCapacity) {
            PathPush push{};
            push.first_slot = slot;
            push.slot_count = std::min(kWaveCapacity, at.pixel_count - slot);
            push.pixel_count = at.pixel_count;
            push.first_pixel = at.first_pixel;
            push.slot_count = find_points(band, push);
            if (push.slot_count == 0) continue;
            push.first_slot = 0;
            for (std::uint32_t i = 0; wanted_.shadows && i < lights_.size(); ++i) {
                push.done = i;
                push.sample_count = lights_[i];
                push.first_sample = i;
                add_shadow(band, push);
            }
            for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(wanted_.paths) && !progress_.stopped(); ++i) {
                push.first_sample = i;
                add_path(band, push);
                progress_.report({.stage = "ambient rays",
                                  .fraction = double(slot) / double(at.pixel_count),
                                  .error = {},
                                  .samples = i + 1});
            }
        }
    }
    gpu::run(device_, [&](Commands& commands) {
        commands.prepare(light_, gpu::ImageUse::sampled);
        commands.prepare(lit_, gpu::ImageUse::sampled);
    });
}

}  // namespace etalon
