// What glTF's extensions add to a surface: docs/shading.md §2b. Each part is compiled away unless the material has it.
#ifndef ETALON_SHADERS_RASTER_LAYERS_GLSL
#define ETALON_SHADERS_RASTER_LAYERS_GLSL
#include "shaders/lib/iridescence.glsl"
#include "shaders/lib/sheen.glsl"
#include "shaders/raster/point.glsl"

layout(set = 1, binding = 5) uniform sampler2D specular_map;
layout(set = 1, binding = 6) uniform sampler2D specular_color_map;
layout(set = 1, binding = 7) uniform sampler2D clearcoat_map;
layout(set = 1, binding = 8) uniform sampler2D clearcoat_roughness_map;
layout(set = 1, binding = 9) uniform sampler2D clearcoat_normal_map;
layout(set = 1, binding = 10) uniform sampler2D sheen_color_map;
layout(set = 1, binding = 11) uniform sampler2D sheen_roughness_map;
layout(set = 1, binding = 12) uniform sampler2D transmission_map;
layout(set = 1, binding = 13) uniform sampler2D thickness_map;
layout(set = 1, binding = 14) uniform sampler2D iridescence_map;
layout(set = 1, binding = 15) uniform sampler2D iridescence_thickness_map;
layout(set = 1, binding = 16) uniform sampler2D anisotropy_map;
layout(set = 1, binding = 17) uniform sampler2D diffuse_transmission_map;
layout(set = 1, binding = 18) uniform sampler2D diffuse_transmission_color_map;

// Bits of kLayerTextures; engine/render/raster_variant.h has the same order.
const bool kSpecularMap = (kLayerTextures & 1u) != 0u;
const bool kSpecularColorMap = (kLayerTextures & 2u) != 0u;
const bool kClearcoatMap = (kLayerTextures & 4u) != 0u;
const bool kClearcoatRoughnessMap = (kLayerTextures & 8u) != 0u;
const bool kClearcoatNormalMap = (kLayerTextures & 16u) != 0u;
const bool kSheenColorMap = (kLayerTextures & 32u) != 0u;
const bool kSheenRoughnessMap = (kLayerTextures & 64u) != 0u;
const bool kTransmissionMap = (kLayerTextures & 128u) != 0u;
const bool kThicknessMap = (kLayerTextures & 256u) != 0u;
const bool kIridescenceMap = (kLayerTextures & 512u) != 0u;
const bool kIridescenceThicknessMap = (kLayerTextures & 1024u) != 0u;
const bool kAnisotropyMap = (kLayerTextures & 2048u) != 0u;
const bool kDiffuseTransmissionMap = (kLayerTextures & 4096u) != 0u;
const bool kDiffuseTransmissionColorMap = (kLayerTextures & 8192u) != 0u;

/// Some layer is there.
const bool kLayered = kSpecularLayer || kClearcoat || kSheen || kTransmission || kIridescence || kAnisotropy ||
                      kDiffuseTransmission;

/// Layers at one point; what the material lacks is left at values that change nothing, or is not read.
struct Layers {
    vec3 f0;  // of the dielectric part (SH-50)
    float f90;
    float film;  // strength of iridescence
    float film_ior;
    float film_thickness;  // nm
    float anisotropy;      // strength
    vec3 tangent;          // t' and b' of (SH-52)
    vec3 bitangent;
    float coat;
    float coat_roughness;
    vec3 coat_normal;  // turned to the drawn side
    vec3 sheen_color;
    float sheen_roughness;
    float transmission;
    float thickness;  // metres in the world
    vec3 absorption;  // 1/m
    float ior;
    float ior_spread;  // h of (SH-60)
    float diffuse_transmission;
    vec3 diffuse_transmission_color;
};

/// (SH-50) What the dielectric part reflects head on.
vec3 dielectric_f0(LayerRecord layer, Point point, out float f90)
{
    float specular = layer.specular;
    vec3 color = layer.specular_color;
    if (kSpecularMap) specular *= read(specular_map, layer.specular_texture, point).a;
    if (kSpecularColorMap) color *= read(specular_color_map, layer.specular_color_texture, point).rgb;
    const float ratio = (layer.ior - 1.0) / (layer.ior + 1.0);
    const float head_on = layer.ior == 0.0 ? 1.0 : ratio * ratio;
    f90 = specular;
    return min(head_on * color, vec3(1.0)) * specular;
}

/// (SH-52) about the shading normal `n` of the front.
void resolve_anisotropy(LayerRecord layer, Point point, vec3 n, inout Layers l)
{
    vec2 direction = vec2(1.0, 0.0);
    l.anisotropy = layer.anisotropy;
    if (kAnisotropyMap) {
        const vec3 texel = read(anisotropy_map, layer.anisotropy_texture, point).rgb;
        const vec2 d = 2.0 * texel.rg - 1.0;
        const float size = length(d);
        direction = size > 0.0 ? d / size : direction;
        l.anisotropy *= texel.b;
    }
    direction = vec2(layer.anisotropy_cos * direction.x - layer.anisotropy_sin * direction.y,
                     layer.anisotropy_sin * direction.x + layer.anisotropy_cos * direction.y);
    vec3 across = point.tangent.xyz - n * dot(n, point.tangent.xyz);
    float sign = point.tangent.w;
    if (dot(across, across) == 0.0) {  // no tangents: any frame (SH-65)
        across = cross(abs(n.x) > 0.7 ? vec3(0.0, 1.0, 0.0) : vec3(1.0, 0.0, 0.0), n);
        sign = 1.0;
    }
    const vec3 t = normalize(across);
    l.tangent = direction.x * t + direction.y * sign * cross(n, t);
    l.bitangent = cross(n, l.tangent);
}

void resolve_coat(LayerRecord layer, Point point, inout Layers l)
{
    l.coat = layer.clearcoat;
    l.coat_roughness = layer.clearcoat_roughness;
    if (kClearcoatMap) l.coat *= read(clearcoat_map, layer.clearcoat_texture, point).r;
    if (kClearcoatRoughnessMap) l.coat_roughness *= read(clearcoat_roughness_map, layer.clearcoat_roughness_texture, point).g;
    l.coat_normal = point.n;
    if (kClearcoatNormalMap)
        l.coat_normal = mapped_normal(read(clearcoat_normal_map, layer.clearcoat_normal_texture, point).xyz,
                                      layer.clearcoat_normal_scale, point);
    if (!point.front) l.coat_normal = -l.coat_normal;
}

void resolve_film(LayerRecord layer, Point point, inout Layers l)
{
    l.film = layer.iridescence;
    l.film_ior = layer.iridescence_ior;
    l.film_thickness = layer.iridescence_thickness_max;
    if (kIridescenceMap) l.film *= read(iridescence_map, layer.iridescence_texture, point).r;
    if (kIridescenceThicknessMap)
        l.film_thickness = mix(layer.iridescence_thickness_min, layer.iridescence_thickness_max,
                               read(iridescence_thickness_map, layer.iridescence_thickness_texture, point).g);
}

void resolve_transmission(LayerRecord layer, Point point, inout Layers l)
{
    l.transmission = layer.ior == 0.0 ? 0.0 : layer.transmission;
    if (kTransmissionMap) l.transmission *= read(transmission_map, layer.transmission_texture, point).r;
    if (!kVolume) return;
    l.thickness = layer.thickness * point.scale;
    if (kThicknessMap) l.thickness *= read(thickness_map, layer.thickness_texture, point).g;
    l.absorption = layer.absorption;
    l.ior = max(layer.ior, 1.0);
    l.ior_spread = kDispersion ? (layer.ior - 1.0) * 0.025 * layer.dispersion : 0.0;
}

Layers no_layers()
{
    return Layers(vec3(0.04), 1.0, 0.0, 1.0, 0.0, 0.0, vec3(0.0), vec3(0.0), 0.0, 0.0, vec3(0.0), vec3(0.0), 0.0, 0.0, 0.0,
                  vec3(0.0), 1.0, 0.0, 0.0, vec3(0.0));
}

/// `n`: the shading normal of the front.
Layers resolve_layers(LayerRecord layer, Point point, vec3 n)
{
    Layers l = no_layers();
    if (kSpecularLayer) l.f0 = dielectric_f0(layer, point, l.f90);
    if (kIridescence) resolve_film(layer, point, l);
    if (kAnisotropy) resolve_anisotropy(layer, point, n, l);
    if (kClearcoat) resolve_coat(layer, point, l);
    if (kTransmission) resolve_transmission(layer, point, l);
    if (kSheen) {
        l.sheen_color = layer.sheen_color;
        l.sheen_roughness = layer.sheen_roughness;
        if (kSheenColorMap) l.sheen_color *= read(sheen_color_map, layer.sheen_color_texture, point).rgb;
        if (kSheenRoughnessMap) l.sheen_roughness *= read(sheen_roughness_map, layer.sheen_roughness_texture, point).a;
    }
    if (kDiffuseTransmission) {
        l.diffuse_transmission = layer.diffuse_transmission;
        l.diffuse_transmission_color = layer.diffuse_transmission_color;
        if (kDiffuseTransmissionMap)
            l.diffuse_transmission *= read(diffuse_transmission_map, layer.diffuse_transmission_texture, point).a;
        if (kDiffuseTransmissionColorMap)
            l.diffuse_transmission_color *=
                read(diffuse_transmission_color_map, layer.diffuse_transmission_color_texture, point).rgb;
    }
    return l;
}

#endif
