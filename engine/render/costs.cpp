#include "engine/render/costs.h"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <set>

#include "engine/base/error.h"
#include "engine/base/parallel.h"
#include "engine/gpu/shader.h"
#include "engine/render/path_features.h"
#include "engine/render/raster.h"
#include "engine/render/raster_variant.h"
#include "engine/scene/simplify.h"
#include "etalon_shaders.h"

namespace etalon {
namespace {

using Constants = std::vector<gpu::Constant>;

constexpr std::array kPathShaders = {"path/generate.comp", "path/trace.comp", "path/shade.comp"};

/// The five words of the header, then instructions whose first word has their length in its upper half.
std::size_t instructions(std::span<const std::uint32_t> code)
{
    std::size_t count = 0;
    for (std::size_t at = 5; at < code.size(); at += std::max(code[at] >> 16, 1u)) ++count;
    return count;
}

std::size_t special_instructions(const char* path, const Constants& constants)
{
    const auto code = etalon_shaders::find(path);
    assume(!code.empty());
    return instructions(gpu::specialize({code, constants}));
}

/// A shader and the variants of it that a scene needs.
struct Family {
    const char* path;
    std::vector<Constants> variants;
};

struct Stages {
    const char* vertex;
    const char* fragment;
};
Stages stages_of(RasterShape shape)
{
    if (shape == RasterShape::mesh) return {"raster/mesh.vert", "raster/mesh.frag"};
    return {"raster/screen.vert", "raster/sphere.frag"};
}

Constants constants_of(const RasterVariant& variant)
{
    Constants out;
    for (std::uint32_t id = 0; id < variant.constants.size(); ++id) out.emplace_back(id, variant.constants[id]);
    return out;
}

std::vector<Family> path_families(const PathFeatures& features)
{
    std::vector<Family> out;
    for (const char* path : kPathShaders) out.push_back({path, {path_constants(features)}});
    return out;
}

std::vector<Family> raster_families(const PosedScene& posed, const Requirements& required,
                                    const RenderSettings& settings)
{
    const RasterVariants variants(posed, required, settings);
    std::map<RasterShape, std::set<RasterVariant>> all;
    for (const Draw& draw : posed.draws) all[RasterShape::mesh].insert(variants.of(draw, RasterTarget::color));
    for (const PosedSphere& sphere : posed.spheres)
        all[RasterShape::sphere].insert(variants.of(sphere, RasterTarget::color));
    std::vector<Family> out;
    for (const auto& [shape, of_shape] : all) {
        std::vector<Constants> constants;
        for (const RasterVariant& variant : of_shape) constants.push_back(constants_of(variant));
        const Stages stages = stages_of(shape);
        out.push_back({stages.vertex, constants});
        out.push_back({stages.fragment, constants});
    }
    return out;
}

std::vector<Family> families(const PosedScene& posed, const Requirements& required, const RenderSettings& settings)
{
    return settings.renderer == Renderer::path ? path_families(path_features(posed, required, settings))
                                               : raster_families(posed, required, settings);
}

std::uint64_t texture_bytes(const PosedScene& posed, const std::vector<bool>& image_read, bool rasterizes, bool levels,
                            bool shrinks)
{
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i < posed.scene->images.size(); ++i) {
        if (!image_read[i]) continue;
        const Texels& image = posed.scene->images[i];
        const std::optional<Texels> constant = shrinks ? shrunk_constant(image) : std::nullopt;
        const Texels& held = constant ? *constant : image;
        const std::uint64_t texels = std::uint64_t(held.width) * std::uint64_t(held.height);
        // The rasterizer's texels are RGBA of 16 bits with a third more in levels; the path tracer's are as coded.
        sum += rasterizes ? texels * 8 * (levels ? 4 : 3) / 3 : texels * (held.is_8_bit ? 4 : 16);
    }
    return sum;
}

DataCost data_cost(const PosedScene& posed, const Requirements& required, const RenderSettings& settings, bool uber)
{
    const bool rasterizes = settings.renderer == Renderer::raster;
    const Scene& scene = *posed.scene;
    std::vector<bool> read(scene.images.size(), uber);
    for (std::size_t i = 0; i < scene.textures.size(); ++i)
        if (required.texture_used[i] && scene.textures[i].image != kNone) read[scene.textures[i].image] = true;
    DataCost out;
    out.texture_bytes = texture_bytes(posed, read, rasterizes, required.has(Feature::mipmaps), !uber);
    if (rasterizes) {
        out.attribute_bytes = raster_stream_bytes(posed, required);
        out.passes = raster_passes(required).size();
        return out;
    }
    constexpr std::uint64_t kTexelBytes = 16;
    const std::uint64_t stride = path_features_unchecked(posed, required, settings).attribute_stride();
    for (const Draw& draw : posed.draws)
        if (posed.primitive(draw).topology == Topology::triangles)
            out.attribute_bytes += kTexelBytes * stride * (posed.primitive(draw).indices.size() / 3);
    return out;
}

std::int64_t path_instructions_of(const PosedScene& posed, const Requirements& with, const Requirements& without,
                                  const RenderSettings& settings)
{
    const Constants before = path_constants(path_features_unchecked(posed, with, settings));
    const Constants after = path_constants(path_features_unchecked(posed, without, settings));
    std::int64_t sum = 0;
    for (const char* path : kPathShaders)
        sum += std::int64_t(special_instructions(path, before)) - std::int64_t(special_instructions(path, after));
    return sum;
}

/// A material's or a sphere's variant as it is and as it would be; nothing where they are the same.
struct Changed {
    RasterShape shape;
    Constants before;
    Constants after;
};

std::vector<Changed> changed_variants(const PosedScene& posed, const Requirements& with, const Requirements& without,
                                      const RenderSettings& settings)
{
    const RasterVariants before(posed, with, settings), after(posed, without, settings);
    std::set<std::pair<RasterVariant, RasterVariant>> all;
    for (const Draw& draw : posed.draws)
        all.emplace(before.of(draw, RasterTarget::color), after.of(draw, RasterTarget::color));
    for (const PosedSphere& sphere : posed.spheres)
        all.emplace(before.of(sphere, RasterTarget::color), after.of(sphere, RasterTarget::color));
    std::vector<Changed> out;
    for (const auto& [a, b] : all)
        if (a != b) out.push_back({a.shape, constants_of(a), constants_of(b)});
    return out;
}

std::int64_t raster_instructions_of(const PosedScene& posed, const Requirements& with, const Requirements& without,
                                    const RenderSettings& settings)
{
    // Specialising is the slow part: the longest fragment shader stands for the others.
    std::optional<Changed> longest;
    std::size_t most = 0;
    for (const Changed& changed : changed_variants(posed, with, without, settings)) {
        const std::size_t features = static_cast<std::size_t>(
            std::count_if(changed.before.begin(), changed.before.end(), [](const gpu::Constant& c) { return c.bits; }));
        if (longest && features <= most) continue;
        longest = changed;
        most = features;
    }
    if (!longest) return 0;
    const Stages stages = stages_of(longest->shape);
    std::int64_t sum = 0;
    for (const char* path : {stages.vertex, stages.fragment})
        sum += std::int64_t(special_instructions(path, longest->before)) -
               std::int64_t(special_instructions(path, longest->after));
    return sum;
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

SceneCosts scene_costs(const PosedScene& whole, const PosedScene& posed, const RenderSettings& settings)
{
    const Requirements required = require(posed, settings);
    const std::vector<Family> all = families(posed, required, settings);
    SceneCosts out;
    out.shaders.resize(all.size());
    parallel_for(all.size(), [&](std::size_t i) {
        const Family& family = all[i];
        ShaderCost& cost = out.shaders[i];
        cost = {.shader = family.path,
                .written = instructions(etalon_shaders::find(family.path)),
                .variants = family.variants.size()};
        for (const Constants& variant : family.variants)
            cost.special = std::max(cost.special, special_instructions(family.path, variant));
    });
    out.data = data_cost(posed, required, settings, false);
    out.uber = data_cost(whole, everything(require(whole, settings)), settings, true);
    return out;
}

std::vector<RequirementCost> requirement_costs(const PosedScene& posed, const RenderSettings& settings)
{
    const Requirements required = require(posed, settings);
    const DataCost all = data_cost(posed, required, settings, false);
    std::vector<RequirementCost> out;
    for (std::size_t i = 0; i < kFeatureCount; ++i)
        if (required.bits[i]) out.push_back({.feature = static_cast<Feature>(i)});
    parallel_for(out.size(), [&](std::size_t i) {
        RequirementCost& cost = out[i];
        const Requirements without = require_without(posed, settings, cost.feature);
        try {
            cost.instructions = settings.renderer == Renderer::path
                                    ? path_instructions_of(posed, required, without, settings)
                                    : raster_instructions_of(posed, required, without, settings);
        } catch (const Error&) {
            cost.needed = true;
            return;
        }
        const DataCost data = data_cost(posed, without, settings, false);
        cost.attribute_bytes = std::int64_t(all.attribute_bytes) - std::int64_t(data.attribute_bytes);
        cost.texture_bytes = std::int64_t(all.texture_bytes) - std::int64_t(data.texture_bytes);
        cost.passes = std::int64_t(all.passes) - std::int64_t(data.passes);
    });
    return out;
}

}  // namespace etalon
