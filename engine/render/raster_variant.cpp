#include "engine/render/raster_variant.h"

#include <fmt/format.h>

#include "engine/base/error.h"
#include "shaders/shared/material.h"

namespace etalon {
namespace {

enum EnvironmentKind : std::uint32_t { none, constant, map };  // of features.glsl

/// kElementTriangle, … of features.glsl
std::uint32_t element(Topology topology)
{
    return topology == Topology::points ? 2 : topology == Topology::lines ? 1 : 0;
}

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
        case BsdfModel::specular_glossiness:
            return {shared::kModelSpecularGlossiness, Feature::specular_glossiness};
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
      shadows_(!posed.lights.empty() && required.has(Feature::punctual_lights) ? settings.shadows : Shadows::none),
      gathered_light_(settings.ambient_rays > 0 && !blinn_phong_),
      samples_(settings.msaa > 1 && required.has(Feature::msaa) ? static_cast<std::uint32_t>(settings.msaa) : 1),
      depth_(settings.depth),
      probes_(static_cast<std::uint32_t>(settings.anisotropy)),
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
    variant.set(RasterConstant::element, element(primitive.topology));
    variant.set(RasterConstant::vertex_colors, !primitive.colors.empty() && required_.has(Feature::vertex_colors));
    if (primitive.tangents.empty() || !required_.has(Feature::tangents)) {
        variant.set(RasterConstant::normal_texture, 0);
        constexpr std::uint32_t kCoatNormal = 1u << static_cast<unsigned>(LayerTexture::clearcoat_normal);
        variant.set(RasterConstant::layer_textures, variant.get(RasterConstant::layer_textures) & ~kCoatNormal);
    }
    return variant;
}

RasterVariant RasterVariants::of(const PosedSphere& sphere, RasterTarget target) const
{
    const Material& material = posed_.materials()[sphere.material];
    // A sphere has neither texture coordinates nor tangents: its factors alone count.
    Material plain = material;
    plain.base_color_texture = plain.metallic_roughness_texture = plain.normal_texture = {};
    plain.occlusion_texture = plain.emissive_texture = {};
    RasterVariant variant{
        .shape = RasterShape::sphere, .target = target, .topology = Topology::triangles, .constants = {}};
    set_frame(variant);
    set_material(variant, plain);
    variant.set(RasterConstant::layer_textures, 0);
    variant.set(RasterConstant::normals, 1);
    variant.set(RasterConstant::lit, 1);
    variant.set(RasterConstant::triangles, 1);
    variant.set(RasterConstant::cull_back, culls_back(material));
    return variant;
}

RasterVariant RasterVariants::background(bool environment) const
{
    RasterVariant variant{.shape = RasterShape::background,
                          .target = RasterTarget::color,
                          .topology = Topology::triangles,
                          .constants = {}};
    set_frame(variant);
    if (!environment) variant.set(RasterConstant::environment, EnvironmentKind::none);
    return variant;
}

bool RasterVariants::has_layers(const Material& material) const
{
    return !blinn_phong_ &&
           (material.model == BsdfModel::metallic_roughness || material.model == BsdfModel::specular_glossiness);
}

bool RasterVariants::is_glossy(const Material& material) const
{
    return !blinn_phong_ && (material.model == BsdfModel::rough_conductor || is_dielectric(material.model));
}

bool RasterVariants::culls_back(const Material& material) const
{
    return !is_dielectric(material.model) && !(material.double_sided && required_.has(Feature::double_sided));
}

void RasterVariants::set_frame(RasterVariant& variant) const
{
    variant.set(RasterConstant::environment, environment_);
    variant.set(RasterConstant::punctual_lights, !posed_.lights.empty() && required_.has(Feature::punctual_lights));
    // Rays meet emitters themselves.
    variant.set(RasterConstant::emitters, required_.has(Feature::emission) && !gathered_light_);
    variant.set(RasterConstant::blinn_phong, blinn_phong_);
    const bool shadow = variant.target == RasterTarget::shadow;
    variant.set(RasterConstant::orthographic,
                variant.target == RasterTarget::parallel_shadow || (!shadow && posed_.view.camera.orthographic));
    if (variant.target == RasterTarget::color) {
        variant.set(RasterConstant::shadows, static_cast<std::uint32_t>(shadows_));
        variant.set(RasterConstant::gathered_light, gathered_light_);
    }
    variant.set(RasterConstant::probes, probes_);
    if (variant.target == RasterTarget::color) variant.set(RasterConstant::depth, static_cast<std::uint32_t>(depth_));
    variant.set(RasterConstant::samples, variant.target == RasterTarget::color ? samples_ : 1);
}

void RasterVariants::set_material(RasterVariant& variant, const Material& material) const
{
    const Model model = describe(material.model);
    insist(required_, model.feature, "material", material.name);
    const bool emits = material.emission != dvec3(0) && required_.has(Feature::emission);
    // Occlusion maps stand in for what rays find.
    const bool occludes = environment_ != EnvironmentKind::none && material.occlusion_strength != 0 && !gathered_light_;
    variant.set(RasterConstant::model, model.code);
    variant.set(RasterConstant::alpha_mask, material.alpha_mode == AlphaMode::mask);
    variant.set(RasterConstant::alpha_blend, material.alpha_mode == AlphaMode::blend);
    variant.set(RasterConstant::emission, emits);
    using C = RasterConstant;
    use_texture(variant, C::base_color_texture, Feature::base_color_texture, material.base_color_texture);
    if (material.model == BsdfModel::metallic_roughness || material.model == BsdfModel::specular_glossiness)
        use_texture(variant, C::metallic_roughness_texture, Feature::metallic_roughness_texture,
                    material.metallic_roughness_texture);
    if (material.model != BsdfModel::unlit)
        use_texture(variant, C::normal_texture, Feature::normal_texture, material.normal_texture);
    if (occludes) use_texture(variant, C::occlusion_texture, Feature::occlusion_texture, material.occlusion_texture);
    if (emits) use_texture(variant, C::emissive_texture, Feature::emissive_texture, material.emissive_texture);
    if (material.layers && has_layers(material)) set_layers(variant, *material.layers);
}

void RasterVariants::set_layers(RasterVariant& variant, const MaterialLayers& m) const
{
    using C = RasterConstant;
    using T = LayerTexture;
    const bool specular = m.ior != 1.5 || m.specular != 1 || m.specular_color != dvec3(1) ||
                          m.specular_texture.present() || m.specular_color_texture.present();
    if (specular) set_layer(variant, C::specular_layer, Feature::specular, m, {T::specular, T::specular_color});
    if (m.clearcoat > 0)
        set_layer(variant, C::clearcoat, Feature::clearcoat, m,
                  {T::clearcoat, T::clearcoat_roughness, T::clearcoat_normal});
    if (m.sheen_color != dvec3(0))
        set_layer(variant, C::sheen, Feature::sheen, m, {T::sheen_color, T::sheen_roughness});
    // An infinite index is a mirror (SH-58).
    if (m.transmission > 0 && m.ior != 0)
        set_layer(variant, C::transmission, Feature::transmission, m, {T::transmission});
    if (m.volumetric() && m.ior != 0) set_layer(variant, C::volume, Feature::volume, m, {T::thickness});
    if (m.volumetric() && m.dispersion > 0) set_layer(variant, C::dispersion, Feature::dispersion, m, {});
    if (m.iridescence > 0)
        set_layer(variant, C::iridescence, Feature::iridescence, m, {T::iridescence, T::iridescence_thickness});
    if (m.anisotropy != 0) set_layer(variant, C::anisotropy, Feature::anisotropy, m, {T::anisotropy});
    if (m.diffuse_transmission > 0)
        set_layer(variant, C::diffuse_transmission, Feature::diffuse_transmission, m,
                  {T::diffuse_transmission, T::diffuse_transmission_color});
}

void RasterVariants::set_layer(RasterVariant& variant, RasterConstant constant, Feature feature,
                               const MaterialLayers& layers, std::initializer_list<LayerTexture> textures) const
{
    if (!required_.has(feature)) return;
    variant.set(constant, 1);
    for (const LayerTexture texture : textures) {
        if (!uses(variant, Feature::layer_textures, layer_texture(layers, texture))) continue;
        const std::uint32_t bit = 1u << static_cast<unsigned>(texture);
        variant.set(RasterConstant::layer_textures, variant.get(RasterConstant::layer_textures) | bit);
    }
}

bool RasterVariants::uses(RasterVariant& variant, Feature feature, const TextureUse& use) const
{
    if (!use.present() || !required_.has(feature) || !required_.texture_used[use.texture]) return false;
    if (use.uv_set == 1 && required_.has(Feature::uv1)) variant.set(RasterConstant::uv1, 1);
    if (use.transform != dmat3(1) && required_.has(Feature::texture_transform))
        variant.set(RasterConstant::texture_transform, 1);
    return true;
}

void RasterVariants::use_texture(RasterVariant& variant, RasterConstant constant, Feature feature,
                                 const TextureUse& use) const
{
    if (uses(variant, feature, use)) variant.set(constant, 1);
}

const TextureUse& layer_texture(const MaterialLayers& layers, LayerTexture texture)
{
    switch (texture) {
        case LayerTexture::specular:
            return layers.specular_texture;
        case LayerTexture::specular_color:
            return layers.specular_color_texture;
        case LayerTexture::clearcoat:
            return layers.clearcoat_texture;
        case LayerTexture::clearcoat_roughness:
            return layers.clearcoat_roughness_texture;
        case LayerTexture::clearcoat_normal:
            return layers.clearcoat_normal_texture;
        case LayerTexture::sheen_color:
            return layers.sheen_color_texture;
        case LayerTexture::sheen_roughness:
            return layers.sheen_roughness_texture;
        case LayerTexture::transmission:
            return layers.transmission_texture;
        case LayerTexture::thickness:
            return layers.thickness_texture;
        case LayerTexture::iridescence:
            return layers.iridescence_texture;
        case LayerTexture::iridescence_thickness:
            return layers.iridescence_thickness_texture;
        case LayerTexture::anisotropy:
            return layers.anisotropy_texture;
        case LayerTexture::diffuse_transmission:
            return layers.diffuse_transmission_texture;
        case LayerTexture::diffuse_transmission_color:
        case LayerTexture::count:
            break;
    }
    return layers.diffuse_transmission_color_texture;
}

}  // namespace etalon
