// How the rasterizer's surfaces scatter light from one direction: docs/shading.md (SH-11) to (SH-14), (SH-37), (SH-38),
// (SH-50) to (SH-62).
#ifndef ETALON_SHADERS_RASTER_REFLECT_GLSL
#define ETALON_SHADERS_RASTER_REFLECT_GLSL
#include "shaders/raster/layers.glsl"
#include "shaders/lib/albedo.glsl"  // reads by albedo_cell of frame.glsl

/// What is left of a material once textures and model have been resolved (SH-14), (SH-37), (SH-50).
struct Reflectance {
    vec3 diffuse;     // c_diff
    vec3 f0;          // specular reflectance at normal incidence
    float roughness;  // perceptual
    float alpha;      // of GGX
    vec3 metal;       // b: F0 of the metallic part
    float metallic;
};

/// glTF's own models: energy of rough reflection (SH-53), layers.
const bool kGltfModel = kModel == kModelMetallicRoughness || kModel == kModelSpecularGlossiness;
/// F is Schlick's of one F0 with F90 = 1, and F̂ = F.
const bool kPlainFresnel = !kSpecularLayer && !kIridescence && kModel != kModelSpecularGlossiness;

/// (SH-11), for D(h) from |n × h|² so that sharp highlights keep their digits (S6).
float ggx(vec3 n, vec3 h, float alpha)
{
    const vec3 sine = cross(n, h);
    const float n_h = dot(n, h);
    const float k = alpha / (dot(sine, sine) + n_h * n_h * alpha * alpha);
    return k * k / kPi;
}

/// (SH-12)
float smith_visibility(float n_l, float n_v, float alpha)
{
    const float a2 = alpha * alpha;
    return 0.5 / (n_l * sqrt(n_v * n_v * (1.0 - a2) + a2) + n_v * sqrt(n_l * n_l * (1.0 - a2) + a2));
}

/// (1 - c)⁵
float schlick_weight(float c)
{
    const float m = 1.0 - clamp(c, 0.0, 1.0);
    const float m2 = m * m;
    return m2 * m2 * m;
}

/// F and F̂ of (SH-50), (SH-51): what is reflected, and what is lost to what lies below.
struct Fresnel {
    vec3 f;
    vec3 hat;
};

Fresnel blend_fresnel(Reflectance r, Layers l, vec3 dielectric, vec3 metal, ThinFilm film)
{
    if (kIridescence && l.film > 0.0 && l.film_thickness > 0.0) {
        dielectric = mix(dielectric, film_reflectance(film, l.f0), l.film);
        if (r.metallic > 0.0) metal = mix(metal, film_reflectance(film, r.metal), l.film);
    }
    return Fresnel(mix(dielectric, metal, r.metallic), mix(vec3(max_component(dielectric)), metal, r.metallic));
}

Fresnel fresnel(Reflectance r, Layers l, float c)
{
    const float w = schlick_weight(c);
    if (kPlainFresnel) {
        const vec3 f = r.f0 + (1.0 - r.f0) * w;
        return Fresnel(f, f);
    }
    return blend_fresnel(r, l, l.f0 + (l.f90 - l.f0) * w, r.metal + (1.0 - r.metal) * w,
                         make_film(c, l.film_ior, l.film_thickness));
}

/// log(1 - x) for x in [0, 1], within 2e-7 relative where x ≤ 1/2: by 2 artanh, because log2 of lavapipe is off by 5%
/// near 1. Beyond 1/2 the exponentials it feeds leave room for log's own error.
float log_one_minus(float x)
{
    if (x > 0.5) return log(max(1.0 - x, 1e-30));
    const float s = -x / (2.0 - x);
    const float s2 = s * s;
    const float series =
        1.0 + s2 * (1.0 / 3.0 + s2 * (1.0 / 5.0 + s2 * (1.0 / 7.0 + s2 * (1.0 / 9.0 + s2 * (1.0 / 11.0 + s2 / 13.0)))));
    return 2.0 * s * series;
}

/// The Blinn-Phong lobe with its normalization, (p + 2)(p + 4)/(8π(2^(−p/2) + p)) (n·h)^p (SH-38), (S1).
float blinn_phong_lobe(vec3 n, vec3 h, float alpha)
{
    const float p = clamp(2.0 / (alpha * alpha) - 2.0, 0.0, 1e6);
    const vec3 chord = n - h;
    const float power = exp(p * log_one_minus(min(0.5 * dot(chord, chord), 1.0)));
    return (p + 2.0) * (p + 4.0) / (8.0 * kPi * (exp2(-0.5 * p) + p)) * power;
}

#endif
