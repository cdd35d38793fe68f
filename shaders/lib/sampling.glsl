// Warps of uniform numbers in [0, 1) and their densities.
#ifndef ETALON_LIB_SAMPLING_GLSL
#define ETALON_LIB_SAMPLING_GLSL
#include "shaders/lib/numeric.glsl"

// (MC-5) z is never 0 for u.x < 1 (S18).
vec3 sample_cosine_hemisphere(vec2 u)
{
    return vec3(sqrt(u.x) * cos_sin_turns(u.y), sqrt(1.0 - u.x));
}
float cosine_hemisphere_pdf(float cosine) { return max(cosine, 0.0) / kPi; }

vec2 sample_disk(vec2 u) { return sqrt(u.x) * cos_sin_turns(u.y); }

// Barycentrics of p1 and p2, uniform by area.
vec2 sample_triangle(vec2 u)
{
    float root = sqrt(u.x);
    return vec2(root * (1.0 - u.y), root * u.y);
}

vec3 sample_sphere(vec2 u)
{
    float z = 1.0 - 2.0 * u.x;
    return vec3(2.0 * sqrt(u.x * (1.0 - u.x)) * cos_sin_turns(u.y), z);
}

// Directions about +z within the cone that a sphere fills; sin2 = (r/d)². The form without 1 - cos (S19).
float cone_solid_angle(float sin2) { return 2.0 * kPi * sin2 / (1.0 + sqrt(max(1.0 - sin2, 0.0))); }
vec3 sample_cone(vec2 u, float sin2)
{
    float below_pole = u.x * sin2 / (1.0 + sqrt(max(1.0 - sin2, 0.0)));  // 1 - cos of the sample
    return vec3(sqrt(below_pole * (2.0 - below_pole)) * cos_sin_turns(u.y), 1.0 - below_pole);
}

// (MC-3) The weight of a sample of density p where the other technique has density q (S25).
float power_heuristic(float p, float q)
{
    if (!(p > 0.0)) return 0.0;
    float ratio = min(p, q) / max(p, q);
    float square = ratio * ratio;
    return q > p ? square / (1.0 + square) : 1.0 / (1.0 + square);
}

#endif
