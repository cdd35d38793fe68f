#pragma once
#include <map>
#include <vector>

#include "engine/gpu/pipeline.h"
#include "engine/render/raster_variant.h"

namespace etalon {

/// Formats that the rasterizer draws to. Colour is float32: 16-bit floats have 11 bits and end at 65504.
inline constexpr VkFormat kRasterColor = VK_FORMAT_R32G32B32A32_SFLOAT;
inline constexpr VkFormat kRasterIds = VK_FORMAT_R32G32_UINT;
inline constexpr VkFormat kRasterDepth = VK_FORMAT_D32_SFLOAT;
/// (TF-7) What depth is kept in.
VkFormat depth_format(DepthKind kind);
/// Targets of the AOV pass: normal and depth, albedo and u, emission and v, ids (aov.glsl).
inline constexpr std::uint32_t kRasterAovTargets = 4;

/// The pipelines of a scene: one per variant, made at first use and kept.
class RasterPipelines {
 public:
    RasterPipelines(gpu::Device& device, std::vector<gpu::VertexStream> streams,
                    std::vector<gpu::VertexAttribute> attributes);

    /// Stays valid as long as this object.
    const gpu::GraphicsPipeline& get(const RasterVariant& variant);

 private:
    gpu::GraphicsPipelineSpec describe(const RasterVariant& variant) const;

    gpu::Device& device_;
    std::vector<gpu::VertexStream> streams_;
    std::vector<gpu::VertexAttribute> attributes_;
    std::map<RasterVariant, gpu::GraphicsPipeline> pipelines_;
};

}  // namespace etalon
