#pragma once
#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "engine/gpu/commands.h"
#include "engine/render/path.h"
#include "engine/render/path_scene.h"

namespace etalon {

/// A kernel of shaders/path for one scene, compiled when it is first launched: few pictures need all of them, and each
/// costs a start some 10 to 50 ms.
class PathKernel {
 public:
    PathKernel() = default;
    PathKernel(std::string path, std::vector<gpu::Constant> constants)
        : path_(std::move(path)), constants_(std::move(constants))
    {}
    const gpu::ComputePipeline& on(gpu::Device& device);

 private:
    std::string path_;
    std::vector<gpu::Constant> constants_;
    std::optional<gpu::ComputePipeline> pipeline_;
};

/// The kernels of shaders/path, for one scene on one device.
struct PathKernels {
    PathKernel generate, generate_centres;
    PathKernel fused, generate_left;  ///< whole paths, and what it leaves to the others; only where `fuses`
    PathKernel trace_paths, trace_shadows, trace_centres;
    PathKernel retry_paths, retry_shadows, retry_centres;  ///< only where `retries`
    PathKernel shade, plan, plan_retries, accumulate, aovs;
    bool retries = false;             ///< the trace kernels may leave rays to the exact ones
    std::uint32_t rays_per_lane = 1;  ///< rays that an invocation of a trace kernel takes
    bool fuses = false;               ///< waves are followed by `fused`
};

/// How paths are followed, decided by the device and the size of the scene (`traversal`: see path.h). Software devices:
/// by `fused` where the stack of the traversal fits registers, else persistent lanes over queues. GPUs: one ray an
/// invocation over queues.
PathKernels make_path_kernels(const gpu::Device& device, const PathScene& scene, Traversal traversal);

/// Compiles what every picture needs, side by side.
void compile_ahead(gpu::Device& device, PathKernels& kernels, unsigned threads);

/// Device memory of a wave: as many paths as are in flight at once, and the queues between kernels.
struct PathQueues {
    std::uint32_t capacity = 0;  ///< paths
    std::array<PathBuffer, 2> paths;
    PathBuffer hits, shadows;
    gpu::Buffer counters, dispatches, retries;
};
/// `with_more`: paths carry a fourth texel: in which body they are (SH-59), how far glass is behind (SH-70).
PathQueues make_path_queues(gpu::Device& device, std::uint32_t capacity, std::uint32_t max_depth, bool with_more);

/// Rows of the picture that share one set of buffers: all of it, but for pictures over 4 million pixels.
struct PathBand {
    std::uint32_t first_pixel = 0;
    std::uint32_t pixel_count = 0;
    PathBuffer pixels;     ///< which they are, where they are chosen
    PathBuffer radiance;   ///< per slot of a pass
    gpu::Buffer mean, m2;  ///< per pixel, replicate after replicate: the film of the block
    /// By kernel, for either direction of the path queues: [0] reads queue 0 and writes queue 1.
    std::array<std::map<const PathKernel*, gpu::Bindings>, 2> bindings;
};
PathBand make_path_band(gpu::Device& device, const PathScene& scene, std::uint32_t first_pixel,
                        std::uint32_t pixel_count, std::uint32_t slots);

/// Everything that the kernels bind, reading path queue `from`.
std::vector<gpu::Bind> path_binds(const PathScene& scene, const gpu::Buffer& frame, const PathQueues& queues,
                                  const PathBand& band, const gpu::Buffer& aovs, std::size_t from);

}  // namespace etalon
