#include "engine/render/raster_pipelines.h"

#include "engine/base/error.h"
#include "etalon_shaders.h"

namespace etalon {
namespace {

bool is_shadow(RasterTarget target)
{
    return target == RasterTarget::shadow || target == RasterTarget::parallel_shadow;
}

struct Stages {
    const char* vertex;
    const char* fragment;
};

Stages stages(const RasterVariant& variant)
{
    const bool aovs = variant.target == RasterTarget::aovs;
    if (is_shadow(variant.target) && variant.shape == RasterShape::mesh)
        return {"raster/mesh.vert", "raster/mesh_shadow.frag"};
    if (is_shadow(variant.target)) return {"raster/screen.vert", "raster/sphere_shadow.frag"};
    switch (variant.shape) {
        case RasterShape::mesh:
            return {"raster/mesh.vert", aovs ? "raster/mesh_aov.frag" : "raster/mesh.frag"};
        case RasterShape::sphere:
            return {"raster/screen.vert", aovs ? "raster/sphere_aov.frag" : "raster/sphere.frag"};
        case RasterShape::background:
            return {"raster/screen.vert", "raster/background.frag"};
    }
    assume(false);
    return {};
}

gpu::ShaderSpec shader(const char* path, const RasterVariant& variant)
{
    const auto code = etalon_shaders::find(path);
    assume(!code.empty());
    gpu::ShaderSpec spec{.code = code, .constants = {}};
    for (std::uint32_t id = 0; id < variant.constants.size(); ++id)
        spec.constants.emplace_back(id, variant.constants[id]);
    return spec;
}

}  // namespace

VkFormat depth_format(DepthKind kind)
{
    switch (kind) {
        case DepthKind::forward_24:
            return VK_FORMAT_X8_D24_UNORM_PACK32;
        case DepthKind::forward_16:
            return VK_FORMAT_D16_UNORM;
        default:
            return VK_FORMAT_D32_SFLOAT;
    }
}

RasterPipelines::RasterPipelines(gpu::Device& device, std::vector<gpu::VertexStream> streams,
                                 std::vector<gpu::VertexAttribute> attributes)
    : device_(device), streams_(std::move(streams)), attributes_(std::move(attributes))
{}

const gpu::GraphicsPipeline& RasterPipelines::get(const RasterVariant& variant)
{
    const auto found = pipelines_.find(variant);
    if (found != pipelines_.end()) return found->second;
    return pipelines_.emplace(variant, gpu::GraphicsPipeline(device_, describe(variant))).first->second;
}

gpu::GraphicsPipelineSpec RasterPipelines::describe(const RasterVariant& variant) const
{
    const bool mesh = variant.shape == RasterShape::mesh;
    const bool aovs = variant.target == RasterTarget::aovs;
    const bool blends = variant.target == RasterTarget::color && variant.get(RasterConstant::alpha_blend) != 0;
    const bool background = variant.shape == RasterShape::background;
    const auto kind = static_cast<DepthKind>(variant.get(RasterConstant::depth));
    const VkCompareOp nearer = kind == DepthKind::reversed_32 ? VK_COMPARE_OP_GREATER : VK_COMPARE_OP_LESS;
    const auto [vertex, fragment] = stages(variant);
    gpu::GraphicsPipelineSpec spec{.vertex = shader(vertex, variant),
                                   .fragment = shader(fragment, variant),
                                   .streams = {},
                                   .attributes = {},
                                   .colors = {},
                                   // The background goes where nothing has been drawn: infinitely far.
                                   .depth = {.format = depth_format(kind),
                                             .test = true,
                                             .write = !background && !blends,
                                             .passes = background ? VK_COMPARE_OP_EQUAL : nearer},
                                   .samples = variant.get(RasterConstant::samples),
                                   .cull = VK_CULL_MODE_NONE,
                                   .name = fragment};
    if (mesh) {
        spec.streams = streams_;
        spec.attributes = attributes_;
        // Triangles have no corners of their own (RasterStream::beside, the last).
        if (variant.get(RasterConstant::element) == 0) spec.attributes.pop_back();
    }
    if (aovs) {
        spec.colors.assign(kRasterAovTargets, {.format = kRasterColor, .blend = gpu::Blend::none});
        spec.colors.back().format = kRasterIds;
    } else if (!is_shadow(variant.target)) {
        spec.colors = {{.format = kRasterColor, .blend = blends ? gpu::Blend::premultiplied : gpu::Blend::none}};
    }
    return spec;
}

}  // namespace etalon
