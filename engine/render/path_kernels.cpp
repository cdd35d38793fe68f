#include "engine/render/path_kernels.h"

#include <algorithm>
#include <bit>

#include "engine/base/error.h"
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

class Compiler {
 public:
    Compiler(gpu::Device& device, Constants common) : device_(device), common_(std::move(common)) {}
    gpu::ComputePipeline operator()(std::string_view path, const Constants& more = {}) const
    {
        return gpu::ComputePipeline(
            device_, {.shader = {etalon_shaders::find(path), common_ + more}, .name = std::string(path)});
    }

 private:
    gpu::Device& device_;
    Constants common_;
};

bool persistent(const gpu::Device& device)
{
    const std::uint32_t size = device.limits().subgroup_size;
    return device.kind() == gpu::DeviceKind::cpu && std::has_single_bit(size) && size <= shared::kPathWorkgroup;
}

}  // namespace

PathKernels make_path_kernels(gpu::Device& device, const PathScene& scene, bool exact)
{
    using namespace shared;
    PathKernels out;
    const bool persists = persistent(device) && !exact;
    // Each visit of a node or primitive is a step, and a lane's rays visit each at most once.
    const bool few_steps = (scene.nodes + scene.primitives) * kRaysPerLane < kSurelyFewSteps;
    out.retries = persists && (scene.stack_need > kMostRegisterStack || !few_steps);
    out.rays_per_lane = persists ? kRaysPerLane : 1;

    const auto lanes_log2 = static_cast<std::uint32_t>(std::bit_width(device.limits().subgroup_size) - 1);
    const Compiler compile(device, path_constants(scene.features) + Constants{{kSpecSubgroupLog2, lanes_log2},
                                                                              {kSpecRaysPerLane, out.rays_per_lane},
                                                                              {kSpecLightTree, scene.light_tree}});
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

    out.generate = compile("path/generate.comp");
    out.generate_centres = compile("path/generate.comp", centres);
    out.trace_paths = compile(trace, stack);
    out.trace_shadows = compile(trace, stack + shadows);
    out.trace_centres = compile(trace, stack + centres);
    if (out.retries) {
        const Constants again{{kSpecStack, in_memory}, {kSpecRetry, true}};
        out.retry_paths = compile("path/trace_exact.comp", again);
        out.retry_shadows = compile("path/trace_exact.comp", again + shadows);
        out.retry_centres = compile("path/trace_exact.comp", again + centres);
        out.plan_retries = compile("path/plan.comp", {{kSpecRetry, true}});
    }
    out.shade = compile("path/shade.comp");
    out.plan = compile("path/plan.comp");
    out.accumulate = compile("path/accumulate.comp");
    out.aovs = compile("path/aov.comp");
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

PathBand make_path_band(gpu::Device& device, const PathScene& scene, const gpu::Buffer& frame,
                        const PathKernels& kernels, const PathQueues& queues, std::uint32_t first_pixel,
                        std::uint32_t pixel_count, std::uint32_t slots, const gpu::Buffer& aovs)
{
    using namespace shared;
    PathBand out;
    out.first_pixel = first_pixel;
    out.pixel_count = pixel_count;
    out.radiance.buffer = gpu::Buffer(device, {.size = 16 * std::uint64_t{slots}, .name = "radiance"});
    out.radiance.view = gpu::TexelView(device, out.radiance.buffer, VK_FORMAT_R32G32B32A32_UINT);
    out.mean = gpu::Buffer(device, {.size = 16 * std::uint64_t{pixel_count}, .name = "film mean"});
    out.m2 = gpu::Buffer(device, {.size = 16 * std::uint64_t{pixel_count}, .name = "film deviations"});
    for (std::size_t from = 0; from < 2; ++from) {
        const std::vector<gpu::Bind> binds{{kBindFrame, frame},
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
                                           {kBindRadianceIn, out.radiance.view},
                                           {kBindPathsOut, queues.paths[1 - from].buffer},
                                           {kBindHitsOut, queues.hits.buffer},
                                           {kBindShadowsOut, queues.shadows.buffer},
                                           {kBindRadiance, out.radiance.buffer},
                                           {kBindCounters, queues.counters},
                                           {kBindDispatches, queues.dispatches},
                                           {kBindRetries, queues.retries},
                                           {kBindMean, out.mean},
                                           {kBindM2, out.m2},
                                           {kBindAovs, aovs},
                                           {kBindAlbedo, scene.albedo.view}};
        for (const gpu::ComputePipeline* kernel :
             {&kernels.generate, &kernels.generate_centres, &kernels.trace_paths, &kernels.trace_shadows,
              &kernels.trace_centres, &kernels.retry_paths, &kernels.retry_shadows, &kernels.retry_centres,
              &kernels.shade, &kernels.plan, &kernels.plan_retries, &kernels.accumulate, &kernels.aovs})
            if (kernel->handle() != VK_NULL_HANDLE)
                out.bindings[from].emplace(kernel, gpu::Bindings(device, kernel->layout(), binds));
    }
    return out;
}

}  // namespace etalon
