#include "engine/render/costs.h"

#include <algorithm>
#include <map>
#include <set>

#include "engine/base/error.h"
#include "engine/gpu/shader.h"
#include "engine/render/path_features.h"
#include "engine/render/raster_variant.h"
#include "etalon_shaders.h"

namespace etalon {
namespace {

/// The five words of the header, then instructions whose first word has their length in its upper half.
std::size_t instructions(std::span<const std::uint32_t> code)
{
    std::size_t count = 0;
    for (std::size_t at = 5; at < code.size(); at += std::max(code[at] >> 16, 1u)) ++count;
    return count;
}

ShaderCost cost_of(const std::string& path, const std::vector<std::vector<gpu::Constant>>& variants)
{
    const auto code = etalon_shaders::find(path);
    assume(!code.empty());
    ShaderCost out{.shader = path, .written = instructions(code), .variants = variants.size()};
    for (const std::vector<gpu::Constant>& constants : variants)
        out.special = std::max(out.special, instructions(gpu::specialize({code, constants})));
    return out;
}

std::vector<ShaderCost> path_shaders(const PathFeatures& features)
{
    std::vector<ShaderCost> out;
    for (const char* path : {"path/generate.comp", "path/trace.comp", "path/shade.comp"})
        out.push_back(cost_of(path, {path_constants(features)}));
    return out;
}

std::vector<ShaderCost> raster_shaders(const PosedScene& posed, const Requirements& required,
                                       const RenderSettings& settings)
{
    const RasterVariants variants(posed, required, settings);
    std::map<RasterShape, std::set<RasterVariant>> all;
    for (const Draw& draw : posed.draws) all[RasterShape::mesh].insert(variants.of(draw, RasterTarget::color));
    for (const PosedSphere& sphere : posed.spheres)
        all[RasterShape::sphere].insert(variants.of(sphere, RasterTarget::color));
    std::vector<ShaderCost> out;
    for (const auto& [shape, of_shape] : all) {
        std::vector<std::vector<gpu::Constant>> constants;
        for (const RasterVariant& variant : of_shape) {
            auto& list = constants.emplace_back();
            for (std::uint32_t id = 0; id < variant.constants.size(); ++id)
                list.emplace_back(id, variant.constants[id]);
        }
        const bool mesh = shape == RasterShape::mesh;
        out.push_back(cost_of(mesh ? "raster/mesh.vert" : "raster/screen.vert", constants));
        out.push_back(cost_of(mesh ? "raster/mesh.frag" : "raster/sphere.frag", constants));
    }
    return out;
}

std::uint64_t bytes_of(const Texels& image)
{
    return std::uint64_t(image.width) * std::uint64_t(image.height) * (image.is_8_bit ? 4u : 16u);
}

}  // namespace

std::size_t SceneCosts::written() const
{
    std::size_t sum = 0;
    for (const ShaderCost& shader : shaders) sum += shader.written;
    return sum;
}

std::size_t SceneCosts::special() const
{
    std::size_t sum = 0;
    for (const ShaderCost& shader : shaders) sum += shader.special;
    return sum;
}

Requirements everything(Requirements required)
{
    required.bits.set();
    required.texture_used.assign(required.texture_used.size(), true);
    return required;
}

SceneCosts scene_costs(const PosedScene& posed, const Requirements& required, const RenderSettings& settings)
{
    constexpr std::uint64_t kTexelBytes = 16;
    SceneCosts out;
    const PathFeatures features = path_features(posed, required, settings);
    out.shaders =
        settings.renderer == Renderer::path ? path_shaders(features) : raster_shaders(posed, required, settings);
    out.vertex_bytes = kTexelBytes * features.attribute_stride();
    out.vertex_bytes_uber = kTexelBytes * path_features(posed, everything(required), settings).attribute_stride();
    std::set<Index> read;
    for (std::size_t i = 0; i < posed.scene->textures.size(); ++i)
        if (required.texture_used[i] && posed.scene->textures[i].image != kNone)
            read.insert(posed.scene->textures[i].image);
    for (std::size_t i = 0; i < posed.scene->images.size(); ++i) {
        const std::uint64_t bytes = bytes_of(posed.scene->images[i]);
        out.texture_bytes_uber += bytes;
        if (read.contains(static_cast<Index>(i))) out.texture_bytes += bytes;
    }
    return out;
}

}  // namespace etalon
