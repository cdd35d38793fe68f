#include "engine/render/raster_variant.h"

#include <fmt/format.h>

#include "engine/base/error.h"
#include "shaders/shared/material.h"

namespace etalon {
namespace {

enum EnvironmentKind : std::uint32_t { none, constant, map };  // of features.glsl

struct Model {
    std::uint32_t code;
    Feature feature;
};

Model describe(BsdfModel model)
{
    switch (model) {
        case BsdfModel::metallic_roughness:
            return {shared::kModelMetallicRoughness, Feature::metallic_roughness};
        case BsdfModel::unlit:
            return {shared::kModelUnlit, Feature::unlit};
        case BsdfModel::lambert:
            return {shared::kModelLambert, Feature::lambert};
        case BsdfModel::mirror:
            return {shared::kModelMirror, Feature::mirror};
        case BsdfModel::rough_conductor:
            return {shared::kModelRoughConductor, Feature::rough_conductor};
        case BsdfModel::dielectric:
            return {shared::kModelDielectric, Feature::dielectric};
        case BsdfModel::rough_dielectric:
            return {shared::kModelRoughDielectric, Feature::rough_dielectric};
    }
    assume(false);
    return {};
}

bool is_dielectric(BsdfModel model)
{
    return model == BsdfModel::dielectric || model == BsdfModel::rough_dielectric;
}

/// What cannot be left out without drawing something else is refused.
void insist(const Requirements& required, Feature feature, const char* kind, const std::string& who)
{
    if (required.has(feature)) return;
    throw Error(Blame::input,
                fmt::format("{} \"{}\" needs the feature {}, which the requirements lack", kind, who, name(feature)));
}

std::uint32_t environment_kind(const Environment& environment, const Requirements& required)
{
    if (environment.is_black()) return EnvironmentKind::none;
    if (environment.map) return required.has(Feature::environment_map) ? EnvironmentKind::map : EnvironmentKind::none;
    return required.has(Feature::environment_constant) ? EnvironmentKind::constant : EnvironmentKind::none;
}

}  // namespace

RasterVariants::RasterVariants(const PosedScene& posed, const Requirements& required, const RenderSettings& settings)
    : posed_(posed),
      required_(required),
      blinn_phong_(settings.shading == Shading::blinn_phong && required.has(Feature::blinn_phong)),
      samples_(settings.msaa > 1 && required.has(Feature::msaa) ? 4 : 1),
      environment_(environment_kind(posed.environment, required))
{
    if (posed.view.camera.orthographic) insist(required, Feature::orthographic, "camera", posed.view.camera.name);
}

RasterVariant RasterVariants::of(const Draw& draw, RasterTarget target) const
{
    const Primitive& primitive = posed_.primitive(draw);
    const Material& material = posed_.material(draw);
    const bool triangles = primitive.topology == Topology::triangles;
    RasterVariant variant{
        .shape = RasterShape::mesh, .target = target, .topology = primitive.topology, .constants = {}};
    set_frame(variant);
    set_material(variant, material);
    const bool normals = primitive.has_normals && required_.has(Feature::normals);
    variant.set(RasterConstant::normals, normals);
    // Points and lines without normals are not lit (glTF 2.0, point and line materials).
    variant.set(RasterConstant::lit, triangles || normals);
    variant.set(RasterConstant::triangles, triangles);
    variant.set(RasterConstant::vertex_colors, !primitive.colors.empty() && required_.has(Feature::vertex_colors));
    if (primitive.tangents.empty() || !required_.has(Feature::tangents)) variant.set(RasterConstant::normal_texture, 0);
    return variant;
}

RasterVariant RasterVariants::of(const PosedSphere& sphere, RasterTarget target) const
{
    const Material& material = posed_.scene->materials[sphere.material];
    // A sphere has neither texture coordinates nor tangents: its factors alone count.
    Material plain = material;
    plain.base_color_texture = plain.metallic_roughness_texture = plain.normal_texture = {};
    plain.occlusion_texture = plain.emissive_texture = {};
    RasterVariant variant{
        .shape = RasterShape::sphere, .target = target, .topology = Topology::triangles, .constants = {}};
    set_frame(variant);
    set_material(variant, plain);
    variant.set(RasterConstant::normals, 1);
    variant.set(RasterConstant::lit, 1);
    variant.set(RasterConstant::triangles, 1);
    variant.set(RasterConstant::cull_back, culls_back(material));
    if (target == RasterTarget::aovs) variant.set(RasterConstant::samples, 1);
    return variant;
}

RasterVariant RasterVariants::background() const
{
    RasterVariant variant{.shape = RasterShape::background,
                          .target = RasterTarget::color,
                          .topology = Topology::triangles,
                          .constants = {}};
    set_frame(variant);
    return variant;
}

bool RasterVariants::culls_back(const Material& material) const
{
    return !is_dielectric(material.model) && !(material.double_sided && required_.has(Feature::double_sided));
}

void RasterVariants::set_frame(RasterVariant& variant) const
{
    variant.set(RasterConstant::environment, environment_);
    variant.set(RasterConstant::punctual_lights, !posed_.lights.empty() && required_.has(Feature::punctual_lights));
    variant.set(RasterConstant::emitters, required_.has(Feature::emission));
    variant.set(RasterConstant::blinn_phong, blinn_phong_);
    variant.set(RasterConstant::orthographic, posed_.view.camera.orthographic);
    variant.set(RasterConstant::samples, variant.target == RasterTarget::aovs ? 1 : samples_);
}

void RasterVariants::set_material(RasterVariant& variant, const Material& material) const
{
    const Model model = describe(material.model);
    insist(required_, model.feature, "material", material.name);
    const bool emits = material.emission != dvec3(0) && required_.has(Feature::emission);
    const bool occludes = environment_ != EnvironmentKind::none && material.occlusion_strength != 0;
    variant.set(RasterConstant::model, model.code);
    variant.set(RasterConstant::alpha_mask, material.alpha_mode == AlphaMode::mask);
    variant.set(RasterConstant::alpha_blend, material.alpha_mode == AlphaMode::blend);
    variant.set(RasterConstant::emission, emits);
    using C = RasterConstant;
    use_texture(variant, C::base_color_texture, Feature::base_color_texture, material.base_color_texture);
    if (material.model == BsdfModel::metallic_roughness)
        use_texture(variant, C::metallic_roughness_texture, Feature::metallic_roughness_texture,
                    material.metallic_roughness_texture);
    if (material.model != BsdfModel::unlit)
        use_texture(variant, C::normal_texture, Feature::normal_texture, material.normal_texture);
    if (occludes) use_texture(variant, C::occlusion_texture, Feature::occlusion_texture, material.occlusion_texture);
    if (emits) use_texture(variant, C::emissive_texture, Feature::emissive_texture, material.emissive_texture);
}

void RasterVariants::use_texture(RasterVariant& variant, RasterConstant constant, Feature feature,
                                 const TextureUse& use) const
{
    if (!use.present() || !required_.has(feature) || !required_.texture_used[use.texture]) return;
    variant.set(constant, 1);
    if (use.uv_set == 1 && required_.has(Feature::uv1)) variant.set(RasterConstant::uv1, 1);
    if (use.transform != dmat3(1) && required_.has(Feature::texture_transform))
        variant.set(RasterConstant::texture_transform, 1);
}

}  // namespace etalon
