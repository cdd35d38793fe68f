#pragma once
#include <array>
#include <map>
#include <string>
#include <vector>

#include "engine/gpu/commands.h"
#include "engine/render/path_scene.h"

namespace etalon {

/// The kernels of shaders/path, compiled for one scene on one device.
struct PathKernels {
    gpu::ComputePipeline generate, generate_centres;
    gpu::ComputePipeline trace_paths, trace_shadows, trace_centres;
    gpu::ComputePipeline retry_paths, retry_shadows, retry_centres;  ///< only where `retries`
    gpu::ComputePipeline shade, plan, plan_retries, accumulate, aovs;
    bool retries = false;             ///< the trace kernels may leave rays to the exact ones
    std::uint32_t rays_per_lane = 1;  ///< rays that an invocation of a trace kernel takes
};

/// How rays are traced, decided by the device alone: software devices get the persistent kernel with its stack in
/// registers, GPUs one ray an invocation. `exact` forces the latter, for tests.
PathKernels make_path_kernels(gpu::Device& device, const PathScene& scene, bool exact = false);

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
    PathBuffer radiance;   ///< per slot of a pass
    gpu::Buffer mean, m2;  ///< per pixel: the film of the block
    /// By pipeline, for either direction of the path queues: [0] reads queue 0 and writes queue 1.
    std::array<std::map<const gpu::ComputePipeline*, gpu::Bindings>, 2> bindings;
};
PathBand make_path_band(gpu::Device& device, const PathScene& scene, const gpu::Buffer& frame,
                        const PathKernels& kernels, const PathQueues& queues, std::uint32_t first_pixel,
                        std::uint32_t pixel_count, std::uint32_t slots, const gpu::Buffer& aovs);

}  // namespace etalon
