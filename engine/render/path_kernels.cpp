#include "engine/render/path_kernels.h"

#include <algorithm>
#include <bit>

#include "engine/base/error.h"
#include "engine/base/parallel.h"
#include "etalon_shaders.h"

namespace etalon {
namespace {

using Constants = std::vector<gpu::Constant>;

/// Rays that a lane of the persistent kernel takes: enough that the loops' tails are rare, few enough that the steps of
/// all of them stay far below lavapipe's limit of loop iterations.
constexpr std::uint32_t kRaysPerLane = 32;
/// Entries of the stack in registers: beyond 24 it costs more than the rare retry.
constexpr int kMostRegisterStack = 24;
/// Visits that a lane may need at worst before retries must be possible: see kMaxSteps of trace.comp.
constexpr std::size_t kSurelyFewSteps = 20000;

Constants operator+(Constants a, const Constants& b)
{
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

bool persistent(const gpu::Device& device)
{
    const std::uint32_t size = device.limits().subgroup_size;
    return device.kind() == gpu::DeviceKind::cpu && std::has_single_bit(size) && size <= shared::kPathWorkgroup;
}

}  // namespace

const gpu::ComputePipeline& PathKernel::on(gpu::Device& device)
{
    if (!pipeline_)
        pipeline_.emplace(device,
                          gpu::ComputePipelineSpec{.shader = {etalon_shaders::find(path_), constants_}, .name = path_});
    return *pipeline_;
}

PathKernels make_path_kernels(const gpu::Device& device, const PathScene& scene, Traversal traversal)
{
    using namespace shared;
    PathKernels out;
    const bool persists = persistent(device) && traversal != Traversal::exact;
    // Each visit of a node or primitive is a step, and a lane's rays visit each at most once.
    const bool few_steps = (scene.nodes + scene.primitives) * kRaysPerLane < kSurelyFewSteps;
    out.retries = persists && (scene.stack_need > kMostRegisterStack || !few_steps);
    out.rays_per_lane = persists ? kRaysPerLane : 1;
    out.fuses = persists && traversal == Traversal::by_device && scene.stack_need <= kMostRegisterStack &&
                !scene.features.alpha && !scene.features.glass_shadows;

    const auto lanes_log2 = static_cast<std::uint32_t>(std::bit_width(device.limits().subgroup_size) - 1);
    const Constants common = path_constants(scene.features) + Constants{{kSpecSubgroupLog2, lanes_log2},
                                                                        {kSpecRaysPerLane, out.rays_per_lane},
                                                                        {kSpecLightTree, scene.light_tree}};
    const auto kernel = [&](const char* path, const Constants& more = {}) { return PathKernel(path, common + more); };
    const std::int32_t in_registers = std::clamp((scene.stack_need + 3) / 4 * 4, 4, kMostRegisterStack);
    const std::int32_t in_memory = std::max(scene.stack_need + 4, 64);
    // In small scenes rays take about as many steps each, so lanes wait for one another and load their rays together;
    // in large ones a lane that is free takes the next ray at once (thresholds measured on lavapipe with 8 lanes).
    const auto lanes = static_cast<std::int32_t>(device.limits().subgroup_size);
    const Constants stack{{kSpecStack, persists ? in_registers : in_memory},
                          {kSpecFewAtNodes, few_steps ? 0 : 2},
                          {kSpecFewAtLeaves, few_steps ? 0 : 1},
                          {kSpecRefill, few_steps ? lanes : 1}};
    const char* const trace = persists ? "path/trace.comp" : "path/trace_exact.comp";
    const Constants shadows{{kSpecShadow, true}};
    const Constants centres{{kSpecBlendSolid, true}};

    out.generate = kernel("path/generate.comp");
    out.generate_centres = kernel("path/generate.comp", centres);
    if (out.fuses) {
        // Fewer lanes than this are not worth a turn of shading while others can take new paths (measured on lavapipe).
        out.fused = kernel("path/fused.comp", stack + Constants{{kSpecTurn, lanes / 2 + lanes / 4}});
        out.generate_left = kernel("path/generate.comp", {{kSpecRetry, true}});
    }
    out.trace_paths = kernel(trace, stack);
    out.trace_shadows = kernel(trace, stack + shadows);
    out.trace_centres = kernel(trace, stack + centres);
    if (out.retries) {
        const Constants again{{kSpecStack, in_memory}, {kSpecRetry, true}};
        out.retry_paths = kernel("path/trace_exact.comp", again);
        out.retry_shadows = kernel("path/trace_exact.comp", again + shadows);
        out.retry_centres = kernel("path/trace_exact.comp", again + centres);
        out.plan_retries = kernel("path/plan.comp", {{kSpecRetry, true}});
    }
    out.shade = kernel("path/shade.comp");
    out.plan = kernel("path/plan.comp");
    out.accumulate = kernel("path/accumulate.comp");
    out.aovs = kernel("path/aov.comp");
    return out;
}

PathQueues make_path_queues(gpu::Device& device, std::uint32_t capacity, std::uint32_t max_depth, bool with_more)
{
    const auto list = [&](const char* name, std::uint64_t bytes_each) {
        PathBuffer out;
        out.buffer = gpu::Buffer(device, {.size = bytes_each * capacity, .name = name});
        out.view = gpu::TexelView(device, out.buffer, VK_FORMAT_R32G32B32A32_UINT);
        return out;
    };
    PathQueues out;
    out.capacity = capacity;
    const std::uint64_t bytes_of_path = with_more ? 64 : 48;
    out.paths[0] = list("paths 0", bytes_of_path);
    out.paths[1] = list("paths 1", bytes_of_path);
    out.hits.buffer = gpu::Buffer(device, {.size = 4 * std::uint64_t{capacity}, .name = "hits"});
    out.hits.view = gpu::TexelView(device, out.hits.buffer, VK_FORMAT_R32_UINT);
    out.shadows = list("shadow rays", 48);
    const std::uint64_t counters = shared::kCountersPerIteration * (std::uint64_t{max_depth} + 1);
    out.counters = gpu::Buffer(device, {.size = 4 * counters, .name = "counters"});
    out.dispatches = gpu::Buffer(device, {.size = 12 * shared::kDispatchRows, .name = "dispatches"});
    out.retries = gpu::Buffer(device, {.size = 4 * std::uint64_t{capacity}, .name = "retries"});
    return out;
}

void compile_ahead(gpu::Device& device, PathKernels& kernels, unsigned threads)
{
    std::vector<PathKernel*> all{&kernels.fused, &kernels.accumulate};
    if (!kernels.fuses)
        all = {&kernels.shade,    &kernels.trace_paths, &kernels.trace_shadows,
               &kernels.generate, &kernels.plan,        &kernels.accumulate};
    parallel_for(
        all.size(), [&](std::size_t i) { all[i]->on(device); }, threads);
}

PathBand make_path_band(gpu::Device& device, const PathScene& scene, std::uint32_t first_pixel,
                        std::uint32_t pixel_count, std::uint32_t slots)
{
    PathBand out;
    out.first_pixel = first_pixel;
    out.pixel_count = pixel_count;
    out.radiance.buffer = gpu::Buffer(device, {.size = 16 * std::uint64_t{slots}, .name = "radiance"});
    out.radiance.view = gpu::TexelView(device, out.radiance.buffer, VK_FORMAT_R32G32B32A32_UINT);
    const std::uint64_t chosen = scene.features.chosen_pixels ? pixel_count : 1;
    out.pixels.buffer = gpu::Buffer(device, {.size = 4 * chosen, .name = "chosen pixels"});
    out.pixels.view = gpu::TexelView(device, out.pixels.buffer, VK_FORMAT_R32_UINT);
    const std::uint64_t sums = 16 * std::uint64_t{pixel_count} * scene.features.replicates();
    out.mean = gpu::Buffer(device, {.size = sums, .name = "film mean"});
    out.m2 = gpu::Buffer(device, {.size = sums, .name = "film deviations"});
    return out;
}

std::vector<gpu::Bind> path_binds(const PathScene& scene, const gpu::Buffer& frame, const PathQueues& queues,
                                  const PathBand& band, const gpu::Buffer& aovs, std::size_t from)
{
    using namespace shared;
    return {{kBindFrame, frame},
            {kBindNodes, scene.node_list.view},
            {kBindPrimitives, scene.primitive_list.view},
            {kBindAttributes, scene.attributes.view},
            {kBindMaterials, scene.materials.view},
            {kBindTextures, scene.textures.view},
            {kBindTexels8, scene.texels_8.view},
            {kBindTexelsWide, scene.texels_wide.view},
            {kBindLights, scene.lights.view},
            {kBindEmitters, scene.emitters.view},
            {kBindSkyCells, scene.sky_cells.view},
            {kBindSkyMap, scene.sky_map.view},
            {kBindPathsIn, queues.paths[from].view},
            {kBindHits, queues.hits.view},
            {kBindShadows, queues.shadows.view},
            {kBindRadianceIn, band.radiance.view},
            {kBindPathsOut, queues.paths[1 - from].buffer},
            {kBindHitsOut, queues.hits.buffer},
            {kBindShadowsOut, queues.shadows.buffer},
            {kBindRadiance, band.radiance.buffer},
            {kBindCounters, queues.counters},
            {kBindDispatches, queues.dispatches},
            {kBindRetries, queues.retries},
            {kBindMean, band.mean},
            {kBindM2, band.m2},
            {kBindAovs, aovs},
            {kBindAlbedo, scene.albedo.view},
            {kBindPixels, band.pixels.view}};
}

}  // namespace etalon
