#include "engine/render/material.h"

#include <algorithm>
#include <cmath>

namespace etalon {
namespace {

static_assert(shared::kModelSpecularGlossiness == static_cast<shared::uint>(BsdfModel::specular_glossiness));

shared::uint model_of(BsdfModel model)
{
    switch (model) {
        case BsdfModel::metallic_roughness:
            return shared::kModelMetallicRoughness;
        case BsdfModel::unlit:
            return shared::kModelUnlit;
        case BsdfModel::lambert:
            return shared::kModelLambert;
        case BsdfModel::mirror:
            return shared::kModelMirror;
        case BsdfModel::rough_conductor:
            return shared::kModelRoughConductor;
        case BsdfModel::dielectric:
            return shared::kModelDielectric;
        case BsdfModel::rough_dielectric:
            return shared::kModelRoughDielectric;
        case BsdfModel::specular_glossiness:
            return shared::kModelSpecularGlossiness;
    }
    return shared::kModelMetallicRoughness;
}

bool has_black_back(const Material& material)
{
    if (material.double_sided) return false;
    return material.model == BsdfModel::lambert || material.model == BsdfModel::mirror ||
           material.model == BsdfModel::rough_conductor;
}

shared::uint flags_of(const Material& material)
{
    shared::uint flags = 0;
    if (material.double_sided) flags |= shared::kMaterialDoubleSided;
    if (material.alpha_mode == AlphaMode::mask) flags |= shared::kMaterialAlphaMask;
    if (material.alpha_mode == AlphaMode::blend) flags |= shared::kMaterialAlphaBlend;
    if (material.emits_front_only) flags |= shared::kMaterialEmitsFrontOnly;
    if (has_black_back(material)) flags |= shared::kMaterialBlackBack;
    return flags;
}

shared::TextureSlot pack(const TextureUse& use)
{
    const dmat3& m = use.transform;
    return {.u_row = vec3(dvec3(m[0][0], m[1][0], m[2][0])),
            .v_row = vec3(dvec3(m[0][1], m[1][1], m[2][1])),
            .texture = use.present() ? use.texture : shared::kNoTexture,
            .uv_set = use.uv_set == 1 ? 1u : 0u};
}

// A colour of 0 absorbs all within any distance; floats hold that as a large finite number.
dvec3 absorption_of(const MaterialLayers& layers)
{
    if (std::isinf(layers.attenuation_distance)) return dvec3(0);
    return glm::min(-glm::log(layers.attenuation_color) / layers.attenuation_distance, dvec3(1e30));
}

shared::LayerRecord pack(const MaterialLayers& layers)
{
    return {.specular_color = vec3(layers.specular_color),
            .specular = static_cast<float>(layers.specular),
            .sheen_color = vec3(layers.sheen_color),
            .sheen_roughness = static_cast<float>(layers.sheen_roughness),
            .absorption = vec3(absorption_of(layers)),
            .thickness = static_cast<float>(layers.thickness),
            .diffuse_transmission_color = vec3(layers.diffuse_transmission_color),
            .diffuse_transmission = static_cast<float>(layers.diffuse_transmission),
            .ior = static_cast<float>(layers.ior),
            .dispersion = static_cast<float>(layers.dispersion),
            .clearcoat = static_cast<float>(layers.clearcoat),
            .clearcoat_roughness = static_cast<float>(layers.clearcoat_roughness),
            .clearcoat_normal_scale = static_cast<float>(layers.clearcoat_normal_scale),
            .transmission = static_cast<float>(layers.transmission),
            .iridescence = static_cast<float>(layers.iridescence),
            .iridescence_ior = static_cast<float>(layers.iridescence_ior),
            .iridescence_thickness_min = static_cast<float>(layers.iridescence_thickness_min),
            .iridescence_thickness_max = static_cast<float>(layers.iridescence_thickness_max),
            .anisotropy = static_cast<float>(layers.anisotropy),
            .anisotropy_cos = static_cast<float>(std::cos(layers.anisotropy_rotation)),
            .anisotropy_sin = static_cast<float>(std::sin(layers.anisotropy_rotation)),
            .specular_texture = pack(layers.specular_texture),
            .specular_color_texture = pack(layers.specular_color_texture),
            .clearcoat_texture = pack(layers.clearcoat_texture),
            .clearcoat_roughness_texture = pack(layers.clearcoat_roughness_texture),
            .clearcoat_normal_texture = pack(layers.clearcoat_normal_texture),
            .sheen_color_texture = pack(layers.sheen_color_texture),
            .sheen_roughness_texture = pack(layers.sheen_roughness_texture),
            .transmission_texture = pack(layers.transmission_texture),
            .thickness_texture = pack(layers.thickness_texture),
            .iridescence_texture = pack(layers.iridescence_texture),
            .iridescence_thickness_texture = pack(layers.iridescence_thickness_texture),
            .anisotropy_texture = pack(layers.anisotropy_texture),
            .diffuse_transmission_texture = pack(layers.diffuse_transmission_texture),
            .diffuse_transmission_color_texture = pack(layers.diffuse_transmission_color_texture)};
}

}  // namespace

dvec3 eye_of(const View& view)
{
    return dvec3(view.world_from_camera[3]);
}

shared::MaterialRecord pack(const Material& material)
{
    return {.base_color = vec4(material.base_color),
            .emission = vec3(material.emission),
            .metallic = static_cast<float>(material.metallic),
            .eta = vec3(material.eta),
            .roughness = static_cast<float>(material.roughness),
            .k = vec3(material.k),
            .alpha_cutoff = static_cast<float>(material.alpha_cutoff),
            .normal_scale = static_cast<float>(material.normal_scale),
            .occlusion_strength = static_cast<float>(material.occlusion_strength),
            .ggx_alpha = static_cast<float>(material.ggx_alpha),
            .model = model_of(material.model),
            .flags = flags_of(material),
            .base_color_texture = pack(material.base_color_texture),
            .metallic_roughness_texture = pack(material.metallic_roughness_texture),
            .normal_texture = pack(material.normal_texture),
            .occlusion_texture = pack(material.occlusion_texture),
            .emissive_texture = pack(material.emissive_texture),
            .layers = shared::kNoLayers};
}

shared::LightRecord pack(const PosedLight& posed, const dvec3& eye)
{
    const Light& light = posed.light;
    const double cos_outer = std::cos(light.outer_cone);
    // Finite for a hard cone, yet no softer than floats can tell (SH-22); KHR_lights_punctual's 0.001 blurs a rim of
    // degrees.
    const double scale = 1 / std::max(1e-6, std::cos(light.inner_cone) - cos_outer);
    const shared::uint type = light.type == LightType::point  ? shared::kLightPoint
                              : light.type == LightType::spot ? shared::kLightSpot
                                                              : shared::kLightDirectional;
    return {.color_intensity = vec3(light.color * light.intensity),
            .type = type,
            .position = vec3(posed.position - eye),
            .range = static_cast<float>(std::max(0.0, light.range)),
            .direction = vec3(posed.direction),
            .spot_scale = static_cast<float>(scale),
            .spot_offset = static_cast<float>(-cos_outer * scale)};
}

std::vector<shared::MaterialRecord> pack_materials(std::span<const Material> materials)
{
    std::vector<shared::MaterialRecord> records;
    records.reserve(materials.size());
    shared::uint layer_count = 0;
    for (const Material& material : materials) {
        records.push_back(pack(material));
        if (material.layers) records.back().layers = layer_count++;
    }
    return records;
}

std::vector<shared::LayerRecord> pack_layers(std::span<const Material> materials)
{
    std::vector<shared::LayerRecord> records;
    for (const Material& material : materials)
        if (material.layers) records.push_back(pack(*material.layers));
    return records;
}

std::vector<shared::LightRecord> pack_lights(const PosedScene& posed)
{
    const dvec3 eye = eye_of(posed.view);
    std::vector<shared::LightRecord> records;
    for (const PosedLight& light : posed.lights)
        if (light.light.color * light.light.intensity != dvec3(0)) records.push_back(pack(light, eye));
    return records;
}

}  // namespace etalon
