// Materials as packed by engine/render/material.h, 16 texels each, and after them their layers, 36 texels each, of which only
// those required are read. MaterialRecord::layers is here the texel at which they begin; every material has some.
#ifndef ETALON_PATH_MATERIAL_GLSL
#define ETALON_PATH_MATERIAL_GLSL
#include "shaders/path/textures.glsl"
#include "shaders/shared/material.h"

// Texels at which fields of MaterialRecord begin. Slot k of the textures starts at word 21 + 8 k: its u_row is the yzw of
// texel 5 + 2 k, its v_row and texture index the next texel, its uv set the x of the one after.
const uint kMaterialTexels = 16u;
const uint kBaseColorSlot = 5u;
const uint kMetallicRoughnessSlot = 7u;
const uint kNormalSlot = 9u;
const uint kEmissiveSlot = 13u;
const uint kLayersTexel = 15u;  // .y
// Slot k of a LayerRecord starts at word 29 + 8 k, in the same place within texel 7 + 2 k.
const uint kSpecularSlot = 7u;
const uint kSpecularColorSlot = 9u;
const uint kClearcoatSlot = 11u;
const uint kClearcoatRoughnessSlot = 13u;
const uint kClearcoatNormalSlot = 15u;
const uint kSheenColorSlot = 17u;
const uint kSheenRoughnessSlot = 19u;
const uint kTransmissionSlot = 21u;
const uint kIridescenceSlot = 25u;
const uint kIridescenceThicknessSlot = 27u;
const uint kAnisotropySlot = 29u;
const uint kDiffuseTransmissionSlot = 31u;
const uint kDiffuseTransmissionColorSlot = 33u;

vec4 load_record(uint record, uint texel) { return uintBitsToFloat(imageLoad(materials, int(record + texel))); }
vec4 load_material(uint material, uint texel) { return load_record(kMaterialTexels * material, texel); }
uint layers_of(uint material) { return floatBitsToUint(load_material(material, kLayersTexel).y); }

// The texture of a slot of the record at texel `record`, or `otherwise` where it has none.
vec4 sample_record_slot(uint record, uint slot, vec4 uvs, bool srgb, vec4 otherwise)
{
    vec4 second = load_record(record, slot + 1u);
    uint texture_index = floatBitsToUint(second.w);
    bool second_set = floatBitsToUint(load_record(record, slot + 2u).x) == 1u;
    vec2 uv = second_set ? uvs.zw : uvs.xy;
    if (kTextureTransform) {
        vec3 u_row = load_record(record, slot).yzw;
        uv = vec2(dot(u_row.xy, uv) + u_row.z, dot(second.xy, uv) + second.z);
    }
    bool present = texture_index != kNoTexture;
    vec4 texel = sample_texture(present ? texture_index : 0u, uv, srgb);
    return present ? texel : otherwise;
}

vec4 sample_slot(uint material, uint slot, vec4 uvs, bool srgb, vec4 otherwise)
{
    return sample_record_slot(kMaterialTexels * material, slot, uvs, srgb, otherwise);
}

// A texture of the layers at texel `layers`: white where there is none.
vec4 sample_layer(uint layers, uint slot, vec4 uvs, bool srgb)
{
    if (!kLayerTextures) return vec4(1.0);
    return sample_record_slot(layers, slot, uvs, srgb, vec4(1.0));
}

// Base colour and alpha: factor, texture and vertex colour.
vec4 base_color(uint material, vec4 uvs, vec4 color)
{
    vec4 value = load_material(material, 0u);
    if (kBaseColorTexture) value *= sample_slot(material, kBaseColorSlot, uvs, true, vec4(1.0));
    if (kColors) value *= color;
    return value;
}

vec3 emission(uint material, vec4 uvs)
{
    vec3 value = load_material(material, 1u).xyz;
    if (kEmissiveTexture) value *= sample_slot(material, kEmissiveSlot, uvs, true, vec4(1.0)).xyz;
    return value;
}

uint material_flags(uint material) { return floatBitsToUint(load_material(material, 5u).x); }

// How much of the surface is there: MASK all or nothing, BLEND its alpha, else all (SH-6).
float coverage(uint material, float alpha)
{
    uint flags = material_flags(material);
    if ((flags & kMaterialAlphaMask) != 0u) return alpha < load_material(material, 3u).w ? 0.0 : 1.0;
    return (flags & kMaterialAlphaBlend) != 0u ? clamp(alpha, 0.0, 1.0) : 1.0;
}

// (SH-50) F0_d and F90_d of the dielectric part.
void add_specular(uint layers, vec4 uvs, inout vec3 f0, inout float f90)
{
    vec4 factors = load_record(layers, 0u);
    float ior = load_record(layers, 4u).x;
    float root = (ior - 1.0) / (ior + 1.0);
    float f_i = ior == 0.0 ? 1.0 : (ior == 1.5 ? 0.04 : root * root);
    f90 = factors.w * sample_layer(layers, kSpecularSlot, uvs, false).w;
    f0 = min(f_i * factors.xyz * sample_layer(layers, kSpecularColorSlot, uvs, true).xyz, 1.0) * f90;
}

// (SH-70) T: what smooth thin glass lets straight through at a cosine to its geometric normal.
vec3 passed_by_glass(uint material, vec4 uvs, vec4 color, float cosine)
{
    vec3 f0 = vec3(0.04);
    float f90 = 1.0;
    if (kSpecular) add_specular(layers_of(material), uvs, f0, f90);
    float x = clamp(1.0 - cosine, 0.0, 1.0);
    float most = max_component(f0);
    float reflected = most + (f90 - most) * ((x * x) * (x * x) * x);
    return (1.0 - reflected) * base_color(material, uvs, color).xyz;
}

vec4 uvs_at(uint primitive, vec3 weights)
{
    vec4 uvs = vec4(0.0);
    if (kUv) uvs = interpolate(primitive, kUvAt, weights);
    return uvs;
}

vec4 color_at(uint primitive, vec3 weights)
{
    vec4 color = vec4(1.0);
    if (kColors) color = interpolate(primitive, kColorAt, weights);
    return color;
}

float coverage_at(uint primitive, uint material, vec3 weights)
{
    return coverage(material, base_color(material, uvs_at(primitive, weights), color_at(primitive, weights)).w);
}

#endif
