#include "engine/render/raster_pipelines.h"

#include "engine/base/error.h"
#include "etalon_shaders.h"

namespace etalon {
namespace {

struct Stages {
    const char* vertex;
    const char* fragment;
};

Stages stages(const RasterVariant& variant)
{
    const bool aovs = variant.target == RasterTarget::aovs;
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

VkPrimitiveTopology topology(Topology topology)
{
    switch (topology) {
        case Topology::points:
            return VK_PRIMITIVE_TOPOLOGY_POINT_LIST;
        case Topology::lines:
            return VK_PRIMITIVE_TOPOLOGY_LINE_LIST;
        default:
            return VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
    }
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
    const bool blends = !aovs && variant.get(RasterConstant::alpha_blend) != 0;
    const bool background = variant.shape == RasterShape::background;
    const auto [vertex, fragment] = stages(variant);
    gpu::GraphicsPipelineSpec spec{.vertex = shader(vertex, variant),
                                   .fragment = shader(fragment, variant),
                                   .streams = {},
                                   .attributes = {},
                                   .colors = {},
                                   // The background goes where nothing has been drawn: infinitely far.
                                   .depth = {.format = kRasterDepth,
                                             .test = true,
                                             .write = !background && !blends,
                                             .passes = background ? VK_COMPARE_OP_EQUAL : VK_COMPARE_OP_GREATER},
                                   .samples = aovs ? 1 : variant.get(RasterConstant::samples),
                                   .topology = topology(variant.topology),
                                   .cull = VK_CULL_MODE_NONE,
                                   .name = fragment};
    if (mesh) {
        spec.streams = streams_;
        spec.attributes = attributes_;
    }
    if (aovs) {
        spec.colors.assign(kRasterAovTargets, {.format = kRasterColor, .blend = gpu::Blend::none});
        spec.colors.back().format = kRasterIds;
    } else {
        spec.colors = {{.format = kRasterColor, .blend = blends ? gpu::Blend::premultiplied : gpu::Blend::none}};
    }
    return spec;
}

}  // namespace etalon
