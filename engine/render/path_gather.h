#pragma once
#include <map>
#include <vector>

#include "engine/gpu/commands.h"
#include "engine/render/path.h"
#include "engine/render/path_scene.h"

namespace etalon {

/// What rays find at the surfaces that a picture's pixels show, for the rasterizer: the path tracer's kernels over its
/// BVH, begun at the surfaces that the pixels' centres show. Alpha-masked occluders are asked texel by texel, blended
/// ones hide light with the probability of their alpha (SH-6).
class PathGather {
 public:
    struct Wanted {
        int paths = 0;         ///< per pixel, of (SH-44)
        bool shadows = false;  ///< of punctual lights (SH-45)
    };
    /// `posed` (with its scene) must outlive it. Throws Error(machine) by OpenGL, where the path tracer does not run,
    /// Error(input) for shadows of more lights than kMostLitLights of shaders/shared/gather.h.
    PathGather(gpu::Device& device, const PosedScene& posed, const RenderSettings& settings, const Wanted& wanted,
               const Progress& progress);

    /// Images for pictures of this size. True when they are others than before.
    bool resize(const View& view);
    /// Fills them for a view of the size asked for last; waits. When `progress` says stop, with as many paths as there
    /// are by then.
    void run(const View& view);

    /// Of each pixel, in use `sampled`: radiance of all light but that of punctual lights that shine directly, and
    /// the metres along the viewing axis of the surface.
    const gpu::Image& light() const { return light_; }
    /// Bit i % 32 of word i / 32: light i reaches the surface. The last word is its object, 0 for none.
    const gpu::Image& lit() const { return lit_; }

 private:
    struct Kernels {
        gpu::ComputePipeline points, start, light, shadow, sum_light, sum_shadow;
    };
    using Bound = std::map<const gpu::ComputePipeline*, gpu::Bindings>;

    void bind();
    std::uint32_t find_points(std::size_t band, const shared::PathPush& push);
    void add_path(std::size_t band, shared::PathPush push);
    void add_shadow(std::size_t band, shared::PathPush push);
    void launch(gpu::Commands& commands, std::size_t band, const gpu::ComputePipeline& kernel,
                const shared::PathPush& push) const;

    gpu::Device& device_;
    Wanted wanted_;
    Progress progress_;
    PathTracer tracer_;
    Kernels kernels_;
    PathBuffer points_;
    gpu::Buffer known_, sums_;
    std::vector<std::uint32_t> lights_;  ///< of the path tracer's lights, the number in the posed scene
    std::vector<Bound> bound_;           ///< of each band
    gpu::Image light_, lit_;
};

}  // namespace etalon
