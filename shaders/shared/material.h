// Material and light records, one definition for C++ and GLSL (scalar layout, no padding members).
#ifndef ETALON_SHADERS_SHARED_MATERIAL_H
#define ETALON_SHADERS_SHARED_MATERIAL_H
#include "shaders/shared/types.h"
ETALON_SHARED_BEGIN

// Which BSDF a material has: docs/shading.md §2. Values of MaterialRecord::model.
ETALON_CONSTANT uint kModelMetallicRoughness = 0u;
ETALON_CONSTANT uint kModelUnlit = 1u;
ETALON_CONSTANT uint kModelLambert = 2u;
ETALON_CONSTANT uint kModelMirror = 3u;
ETALON_CONSTANT uint kModelRoughConductor = 4u;
ETALON_CONSTANT uint kModelDielectric = 5u;
ETALON_CONSTANT uint kModelRoughDielectric = 6u;
ETALON_CONSTANT uint kModelSpecularGlossiness = 7u;  // k: specular factor, roughness: 1 - glossiness factor

// Bits of MaterialRecord::flags.
ETALON_CONSTANT uint kMaterialDoubleSided = 1u;     // lit and seen from both sides
ETALON_CONSTANT uint kMaterialAlphaMask = 2u;       // absent where alpha < alpha_cutoff
ETALON_CONSTANT uint kMaterialAlphaBlend = 4u;      // lets (1 - alpha) straight through
ETALON_CONSTANT uint kMaterialEmitsFrontOnly = 8u;  // extras.etalon.emission "front"
ETALON_CONSTANT uint kMaterialBlackBack = 16u;      // exact BSDF without doubleSided: the back is black and opaque

ETALON_CONSTANT uint kNoTexture = 0xffffffffu;

/// A texture as a material uses it: which texture, which uv set, and KHR_texture_transform as two rows:
/// uv' = (dot(u_row.xy, uv) + u_row.z, dot(v_row.xy, uv) + v_row.z).
struct TextureSlot {
    vec3 u_row;
    vec3 v_row;
    uint texture;  // kNoTexture: absent
    uint uv_set;   // 0 or 1
};

struct MaterialRecord {
    vec4 base_color;  // linear Rec.709 albedo and alpha; `reflectance` of lambert and mirror
    vec3 emission;    // radiance, nit: emissiveFactor * emissive strength
    float metallic;
    vec3 eta;         // index of refraction per channel of rough_conductor; .x is the ior of dielectrics
    float roughness;  // perceptual, glTF's; alpha_x of GGX = roughness^2
    vec3 k;           // extinction per channel of rough_conductor
    float alpha_cutoff;
    float normal_scale;
    float occlusion_strength;
    float ggx_alpha;  // exact GGX alpha of rough_conductor and rough_dielectric
    uint model;
    uint flags;
    TextureSlot base_color_texture;
    TextureSlot metallic_roughness_texture;
    TextureSlot normal_texture;
    TextureSlot occlusion_texture;
    TextureSlot emissive_texture;
    uint layers;  // index of its LayerRecord; kNoLayers: none
};

ETALON_CONSTANT uint kNoLayers = 0xffffffffu;

/// What glTF's extensions add to a material: docs/shading.md §2b; fields as MaterialLayers of engine/scene/scene.h.
struct LayerRecord {
    vec3 specular_color;
    float specular;
    vec3 sheen_color;
    float sheen_roughness;
    vec3 absorption;  // 1/m per channel: -ln(attenuation colour) / attenuation distance
    float thickness;  // metres in mesh space; 0: thin-walled
    vec3 diffuse_transmission_color;
    float diffuse_transmission;
    float ior;  // 0: infinite
    float dispersion;
    float clearcoat;
    float clearcoat_roughness;
    float clearcoat_normal_scale;
    float transmission;
    float iridescence;
    float iridescence_ior;
    float iridescence_thickness_min;  // nanometres
    float iridescence_thickness_max;
    float anisotropy;
    float anisotropy_cos;  // of the rotation
    float anisotropy_sin;
    TextureSlot specular_texture;
    TextureSlot specular_color_texture;
    TextureSlot clearcoat_texture;
    TextureSlot clearcoat_roughness_texture;
    TextureSlot clearcoat_normal_texture;
    TextureSlot sheen_color_texture;
    TextureSlot sheen_roughness_texture;
    TextureSlot transmission_texture;
    TextureSlot thickness_texture;
    TextureSlot iridescence_texture;
    TextureSlot iridescence_thickness_texture;
    TextureSlot anisotropy_texture;
    TextureSlot diffuse_transmission_texture;
    TextureSlot diffuse_transmission_color_texture;
};

ETALON_CONSTANT uint kLightPoint = 0u;
ETALON_CONSTANT uint kLightSpot = 1u;
ETALON_CONSTANT uint kLightDirectional = 2u;

/// KHR_lights_punctual in camera-relative world space.
struct LightRecord {
    vec3 color_intensity;  // color * intensity: candela (point, spot) or lux (directional)
    uint type;
    vec3 position;      // metres, camera-relative
    float range;        // metres; 0: unlimited
    vec3 direction;     // in which the light travels, unit
    float spot_scale;   // 1 / max(1e-6, cos(inner) - cos(outer))
    float spot_offset;  // -cos(outer) * spot_scale
};

ETALON_SHARED_END
#ifdef __cplusplus
static_assert(sizeof(etalon::shared::TextureSlot) == 32);
static_assert(sizeof(etalon::shared::MaterialRecord) == 84 + 5 * 32 + 4);
static_assert(sizeof(etalon::shared::LayerRecord) == 116 + 14 * 32);
static_assert(sizeof(etalon::shared::LightRecord) == 52);
#endif
#endif
