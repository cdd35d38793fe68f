// How the rasterizer's surfaces reflect punctual lights: docs/shading.md (SH-11) to (SH-14), (SH-37), (SH-38).
#ifndef ETALON_SHADERS_RASTER_REFLECT_GLSL
#define ETALON_SHADERS_RASTER_REFLECT_GLSL
#include "shaders/raster/features.glsl"

/// What is left of a material once textures and model have been resolved (SH-14), (SH-37).
struct Reflectance {
    vec3 diffuse;     // c_diff
    vec3 f0;          // specular reflectance at normal incidence
    float roughness;  // perceptual
    float alpha;      // of GGX
};

/// (SH-11), for D(h) from |n × h|² so that sharp highlights keep their digits (S6).
float ggx(vec3 n, vec3 h, float alpha)
{
    const vec3 sine = cross(n, h);
    const float n_h = dot(n, h);
    const float k = alpha / (dot(sine, sine) + n_h * n_h * alpha * alpha);
    return k * k / 3.14159265358979323846;
}

/// (SH-12)
float smith_visibility(float n_l, float n_v, float alpha)
{
    const float a2 = alpha * alpha;
    return 0.5 / (n_l * sqrt(n_v * n_v * (1.0 - a2) + a2) + n_v * sqrt(n_l * n_l * (1.0 - a2) + a2));
}

/// (SH-13)
vec3 schlick(vec3 f0, float o_h)
{
    const float m = 1.0 - clamp(o_h, 0.0, 1.0);
    const float m2 = m * m;
    return f0 + (1.0 - f0) * (m2 * m2 * m);
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
    return (p + 2.0) * (p + 4.0) / (8.0 * 3.14159265358979323846 * (exp2(-0.5 * p) + p)) * power;
}

/// f(wi, wo), 1/sr, where n·wi, n·wo and ng·wi are positive; n_v is the clamped n·wo (SH-32).
vec3 reflected(Reflectance r, vec3 n, vec3 wo, vec3 wi, float n_v)
{
    const vec3 lambert = r.diffuse / 3.14159265358979323846;
    if (kModel == kModelLambert) return lambert;
    const vec3 h = normalize(wo + wi);
    if (kBlinnPhong) return lambert + r.f0 * blinn_phong_lobe(n, h, r.alpha);
    const vec3 f = schlick(r.f0, dot(wo, h));
    return (1.0 - f) * lambert + f * (ggx(n, h, r.alpha) * smith_visibility(dot(n, wi), n_v, r.alpha));
}

#endif
