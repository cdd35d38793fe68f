// From a rasterized point to a surface: textures, vertex colours, normal mapping, model (docs/shading.md §1, §4).
#ifndef ETALON_SHADERS_RASTER_SURFACE_GLSL
#define ETALON_SHADERS_RASTER_SURFACE_GLSL
#include "shaders/raster/frame.glsl"
#include "shaders/raster/reflect.glsl"

layout(set = 1, binding = 0) uniform sampler2D base_color_map;
layout(set = 1, binding = 1) uniform sampler2D metallic_roughness_map;
layout(set = 1, binding = 2) uniform sampler2D normal_map;
layout(set = 1, binding = 3) uniform sampler2D occlusion_map;
layout(set = 1, binding = 4) uniform sampler2D emissive_map;

/// A texture coordinate with its screen derivatives.
struct Uv {
    vec2 at;
    vec2 dx;
    vec2 dy;
};

/// What rasterization gives for a pixel, extrapolated to its centre (SH-30).
struct Point {
    vec3 position;  // camera-relative world
    vec3 ng;        // unit, on the glTF front's side
    vec3 n;         // unit, on the same side
    vec4 tangent;   // world, not unit; w the bitangent's sign
    Uv uv[2];
    vec4 color;
    bool front;
};

struct Surface {
    Reflectance reflectance;
    vec3 base;  // base colour
    float alpha;
    vec3 emission;
    float occlusion;
    vec3 n;   // turned to the drawn side (SH-3)
    vec3 ng;
};

/// (TX-1) from the interpolated coordinate times q = 1/w and q itself: both are linear on the screen, so their
/// differences are exact derivatives, the same on every pixel of a quad.
Uv with_derivatives(vec2 uv, float q)
{
    const vec2 linear = uv * q;
    return Uv(uv, (dFdx(linear) - uv * dFdx(q)) / q, (dFdy(linear) - uv * dFdy(q)) / q);
}

/// Filtered as its sampler says, at level (TX-2).
vec4 read(sampler2D map, TextureSlot slot, Point point)
{
    Uv uv = point.uv[0];
    if (kUv1 && slot.uv_set == 1u) uv = point.uv[1];
    if (kTextureTransform) {
        const mat2 m = mat2(slot.u_row.x, slot.v_row.x, slot.u_row.y, slot.v_row.y);
        uv = Uv(m * uv.at + vec2(slot.u_row.z, slot.v_row.z), m * uv.dx, m * uv.dy);
    }
    const vec2 size = vec2(textureSize(map, 0));
    const vec2 dx = uv.dx * size;
    const vec2 dy = uv.dy * size;
    // 1e-30: a constant coordinate reads level 0 (T1).
    return textureLod(map, uv.at, 0.5 * log2(max(max(dot(dx, dx), dot(dy, dy)), 1e-30)));
}

/// (SH-2)
vec3 shading_normal(MaterialRecord material, Point point)
{
    if (!kNormalTexture) return point.n;
    vec3 texel = 2.0 * read(normal_map, material.normal_texture, point).xyz - 1.0;
    texel.xy *= material.normal_scale;
    const vec3 t = normalize(point.tangent.xyz);
    const vec3 b = cross(point.n, t) * point.tangent.w;
    return normalize(t * texel.x + b * texel.y + point.n * texel.z);
}

/// (SH-14), (SH-37)
Reflectance resolve_model(MaterialRecord material, Point point, vec3 base)
{
    float metallic = material.metallic;
    float roughness = material.roughness;
    if (kMetallicRoughnessTexture) {
        const vec4 texel = read(metallic_roughness_map, material.metallic_roughness_texture, point);
        roughness *= texel.g;
        metallic *= texel.b;
    }
    Reflectance r = Reflectance(base * (1.0 - metallic), mix(vec3(0.04), base, metallic), roughness, 0.0);
    if (kModel == kModelLambert) r = Reflectance(base, vec3(0.0), 1.0, 0.0);
    if (kModel == kModelMirror) r = Reflectance(vec3(0.0), base, 0.0, 0.0);
    if (kModel == kModelRoughConductor) {
        const vec3 k2 = material.k * material.k;
        const vec3 less = material.eta - 1.0;
        const vec3 more = material.eta + 1.0;
        r = Reflectance(vec3(0.0), (less * less + k2) / (more * more + k2), sqrt(material.ggx_alpha), 0.0);
    }
    if (kModel == kModelDielectric || kModel == kModelRoughDielectric) {
        const float ratio = (material.eta.x - 1.0) / (material.eta.x + 1.0);
        const float rough = kModel == kModelDielectric ? 0.0 : sqrt(material.ggx_alpha);
        r = Reflectance(vec3(0.0), vec3(ratio * ratio), rough, 0.0);
    }
    r.alpha = max(r.roughness * r.roughness, 1e-3);
    return r;
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
    s.reflectance = resolve_model(material, point, base.rgb);
    s.occlusion = 1.0;
    if (kOcclusionTexture)
        s.occlusion = 1.0 + material.occlusion_strength * (read(occlusion_map, material.occlusion_texture, point).r - 1.0);
    const float side = point.front ? 1.0 : -1.0;
    s.n = side * shading_normal(material, point);
    s.ng = side * point.ng;
    return s;
}

#endif
