// The GGX microfacet distribution in the local frame of the shading normal (+z).
#ifndef ETALON_LIB_GGX_GLSL
#define ETALON_LIB_GGX_GLSL
#include "shaders/lib/numeric.glsl"

// (SH-11) For a unit h with h.z > 0, in the form that keeps its precision at the peak (S6).
float ggx_d(vec3 h, float alpha)
{
    float k = alpha / (dot(h.xy, h.xy) + h.z * h.z * alpha * alpha);
    return k * k / kPi;
}

// (SH-12) Height-correlated G / (4 n·wi n·wo) (S9).
float ggx_v_correlated(float cos_i, float cos_o, float alpha)
{
    float a2 = alpha * alpha;
    return 0.5 / (cos_i * sqrt(cos_o * cos_o * (1.0 - a2) + a2) + cos_o * sqrt(cos_i * cos_i * (1.0 - a2) + a2));
}

// (SH-52) The same with alpha.x along the frame's x and alpha.y along its y.
float ggx_d(vec3 h, vec2 alpha)
{
    vec2 crossed = alpha.yx * h.xy;
    float product = alpha.x * alpha.y;
    float k = product / (dot(crossed, crossed) + h.z * h.z * product * product);
    return k * k * product / kPi;
}

float ggx_stretched_length(vec3 w, vec2 alpha)
{
    vec3 stretched = vec3(alpha * w.xy, w.z);
    return sqrt(dot(stretched, stretched));
}

float ggx_v_correlated(vec3 wi, vec3 wo, vec2 alpha)
{
    return 0.5 / (abs(wi.z) * ggx_stretched_length(wo, alpha) + abs(wo.z) * ggx_stretched_length(wi, alpha));
}

// G1(w) / (2 |n·w|): finite at grazing angles.
float ggx_g1_over_2cos(float cosine, float alpha)
{
    float a2 = alpha * alpha;
    float c = abs(cosine);
    return 1.0 / (c + sqrt(c * c * (1.0 - a2) + a2));
}
float ggx_g1(float cosine, float alpha) { return 2.0 * abs(cosine) * ggx_g1_over_2cos(cosine, alpha); }

// (MC-6) A normal as wo (wo.z > 0) sees them (Dupuy & Benyoub 2023, spherical caps).
vec3 sample_ggx_vndf(vec3 wo, float alpha, vec2 u)
{
    vec3 stretched = robust_normalize(vec3(alpha * wo.xy, wo.z));
    float z = 1.0 - u.x * (1.0 + stretched.z);
    float radius = sqrt(clamp(u.x * (1.0 + stretched.z) * (1.0 + z), 0.0, 1.0));  // √((1-z)(1+z))
    vec3 h = vec3(radius * cos_sin_turns(u.y), z) + stretched;
    return robust_normalize(vec3(alpha * h.xy, max(h.z, 0.0)));
}

vec3 sample_ggx_vndf(vec3 wo, vec2 alpha, vec2 u)
{
    vec3 stretched = robust_normalize(vec3(alpha * wo.xy, wo.z));
    float z = 1.0 - u.x * (1.0 + stretched.z);
    float radius = sqrt(clamp(u.x * (1.0 + stretched.z) * (1.0 + z), 0.0, 1.0));
    vec3 h = vec3(radius * cos_sin_turns(u.y), z) + stretched;
    return robust_normalize(vec3(alpha * h.xy, max(h.z, 0.0)));
}

// Density of h over solid angle, divided by |wo·h|: D G1(wo) / |n·wo|.
float ggx_vndf_over_cos(vec3 wo, vec3 h, float alpha) { return 2.0 * ggx_g1_over_2cos(wo.z, alpha) * ggx_d(h, alpha); }

#endif
