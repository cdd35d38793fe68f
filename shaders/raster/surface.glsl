// From a rasterized point to a surface: textures, vertex colours, normal mapping, model (docs/shading.md §1, §4).
#ifndef ETALON_SHADERS_RASTER_SURFACE_GLSL
#define ETALON_SHADERS_RASTER_SURFACE_GLSL
#include "shaders/raster/layers.glsl"
#include "shaders/raster/reflect.glsl"

layout(set = 1, binding = 0) uniform sampler2D base_color_map;
layout(set = 1, binding = 1) uniform sampler2D metallic_roughness_map;
layout(set = 1, binding = 2) uniform sampler2D normal_map;
layout(set = 1, binding = 3) uniform sampler2D occlusion_map;
layout(set = 1, binding = 4) uniform sampler2D emissive_map;

struct Surface {
    Reflectance reflectance;
    Layers layers;
    vec3 base;  // base colour
    float alpha;
    vec3 emission;
    float occlusion;
    vec3 n;   // turned to the drawn side (SH-3)
    vec3 ng;
};

/// (SH-2) of the front. `spread`: what the normals that a texel is the mean of add to alpha squared (TX-7).
vec3 shading_normal(MaterialRecord material, Point point, out float spread)
{
    spread = 0.0;
    if (!kNormalTexture) return point.n;
    const vec3 texel = read(normal_map, material.normal_texture, point).xyz;
    const float size = length(2.0 * texel - 1.0);
    const float scale = material.normal_scale;
    const float minified = clamp(level_of(normal_map, material.normal_texture, point), 0.0, 1.0);
    if (size > 0.0) spread = 2.0 * minified * scale * scale * max(1.0 / size - 1.0001, 0.0);
    return mapped_normal(texel, scale, point);
}

Reflectance reflectance_of(vec3 diffuse, vec3 f0, float roughness)
{
    return Reflectance(diffuse, f0, roughness, 0.0, vec3(0.0), 0.0);
}

/// (SH-50) specular_glossiness: `layers` receives what it calls specular.
Reflectance resolve_glossiness(MaterialRecord material, Point point, vec3 base, inout Layers layers)
{
    vec3 specular = material.k;
    float glossiness = 1.0 - material.roughness;
    if (kMetallicRoughnessTexture) {
        const vec4 texel = read(metallic_roughness_map, material.metallic_roughness_texture, point);
        specular *= texel.rgb;
        glossiness *= texel.a;
    }
    layers.f0 = specular;
    layers.f90 = 1.0;
    const vec3 diffuse = base * (1.0 - max_component(specular));
    return Reflectance(diffuse, specular, 1.0 - glossiness, 0.0, diffuse, 0.0);
}

/// (SH-14), (SH-37), (SH-50)
Reflectance resolve_model(MaterialRecord material, Point point, vec3 base, inout Layers layers)
{
    if (kModel == kModelSpecularGlossiness) return resolve_glossiness(material, point, base, layers);
    if (kModel == kModelLambert) return reflectance_of(base, vec3(0.0), 1.0);
    if (kModel == kModelMirror) return reflectance_of(vec3(0.0), base, 0.0);
    if (kModel == kModelRoughConductor) {
        const vec3 k2 = material.k * material.k;
        const vec3 less = material.eta - 1.0;
        const vec3 more = material.eta + 1.0;
        return reflectance_of(vec3(0.0), (less * less + k2) / (more * more + k2), sqrt(material.ggx_alpha));
    }
    if (kModel == kModelDielectric || kModel == kModelRoughDielectric) {
        const float ratio = (material.eta.x - 1.0) / (material.eta.x + 1.0);
        const float rough = kModel == kModelDielectric ? 0.0 : sqrt(material.ggx_alpha);
        return reflectance_of(vec3(0.0), vec3(ratio * ratio), rough);
    }
    float metallic = material.metallic;
    float roughness = material.roughness;
    if (kMetallicRoughnessTexture) {
        const vec4 texel = read(metallic_roughness_map, material.metallic_roughness_texture, point);
        roughness *= texel.g;
        metallic *= texel.b;
    }
    return Reflectance(base * (1.0 - metallic), mix(layers.f0, base, metallic), roughness, 0.0, base, metallic);
}

/// (SH-21): factor times texture; a back of `emits_front_only` gives none.
vec3 emitted(MaterialRecord material, Point point)
{
    if (!kEmission) return vec3(0.0);
    if (!point.front && (material.flags & kMaterialEmitsFrontOnly) != 0u) return vec3(0.0);
    vec3 emission = material.emission;
    if (kEmissiveTexture) emission *= read(emissive_map, material.emissive_texture, point).rgb;
    return emission;
}

Surface resolve_surface(MaterialRecord material, Point point)
{
    vec4 base = material.base_color;
    if (kBaseColorTexture) base *= read(base_color_map, material.base_color_texture, point);
    if (kVertexColors) base *= point.color;
    Surface s;
    s.base = base.rgb;
    s.alpha = base.a;
    s.emission = emitted(material, point);
    s.occlusion = 1.0;
    if (kOcclusionTexture)
        s.occlusion = 1.0 + material.occlusion_strength * (read(occlusion_map, material.occlusion_texture, point).r - 1.0);
    float spread;
    const vec3 n = shading_normal(material, point, spread);
    s.layers = kLayered ? resolve_layers(layer_records[material.layers], point, n) : no_layers();
    s.reflectance = resolve_model(material, point, base.rgb, s.layers);
    s.reflectance.alpha = max(s.reflectance.roughness * s.reflectance.roughness, 1e-3);
    if (kGltfModel && spread > 0.0) {
        s.reflectance.alpha = min(sqrt(s.reflectance.alpha * s.reflectance.alpha + spread), 1.0);
        s.reflectance.roughness = sqrt(s.reflectance.alpha);
    }
    const float side = point.front ? 1.0 : -1.0;
    s.n = side * n;
    s.ng = side * point.ng;
    return s;
}

#endif
