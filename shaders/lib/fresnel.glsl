#ifndef ETALON_LIB_FRESNEL_GLSL
#define ETALON_LIB_FRESNEL_GLSL
#include "shaders/lib/numeric.glsl"

// (SH-13, S14)
vec3 schlick_fresnel(vec3 f0, float cosine)
{
    float x = clamp(1.0 - cosine, 0.0, 1.0);
    float x2 = x * x;
    return f0 + (1.0 - f0) * (x2 * x2 * x);
}

// (SH-18) Exact unpolarized reflectance where light meets a dielectric at cosine ≥ 0; `excess` is eta - 1, eta the index of
// the far side over that of the near one. cos_t receives the cosine on the far side, 0 under total internal reflection.
// The form of S10: it does not cancel for eta near 1, and one number decides between refraction and total reflection (S11).
float dielectric_fresnel(float cosine, float excess, out float cos_t)
{
    float eta = 1.0 + excess;
    float q = excess * (2.0 + excess);  // eta² - 1
    float square = q + cosine * cosine;
    cos_t = 0.0;
    if (square <= 0.0) return 1.0;
    float eta_cos_t = sqrt(square);
    cos_t = eta_cos_t / eta;
    float s_sum = cosine + eta_cos_t;
    float p_sum = eta * cosine + cos_t;
    float sine2 = max(1.0 - cosine * cosine, 0.0);
    float r_s = -q / (s_sum * s_sum);
    float r_p = q * (cosine * cosine - sine2 / (eta * eta)) / (p_sum * p_sum);
    return min(0.5 * (r_s * r_s + r_p * r_p), 1.0);
}

// (SH-17) Exact unpolarized reflectance of a conductor of index eta + i k in vacuum, one channel. Everything is divided by
// the largest magnitude first, so that k up to 1e18 does not overflow (S13).
float conductor_fresnel(float cosine, float eta, float k)
{
    float m = 1.0 / max(max(eta, k), 1.0);
    float e2 = (eta * m) * (eta * m);
    float k2 = (k * m) * (k * m);
    float c2 = (cosine * m) * (cosine * m);
    float s2 = max(1.0 - cosine * cosine, 0.0) * m * m;
    float t0 = e2 - k2 - s2;
    float a2b2 = sqrt(t0 * t0 + 4.0 * e2 * k2);
    // (a2b2 + t0) / 2, without the cancellation of t0 < 0.
    float a = sqrt(t0 < 0.0 ? 2.0 * e2 * k2 / (a2b2 - t0) : 0.5 * (a2b2 + t0));
    float t1 = a2b2 + c2;
    float t2 = 2.0 * a * cosine * m;
    float r_s = (t1 - t2) / (t1 + t2);
    float t3 = c2 * a2b2 + s2 * s2;
    float t4 = t2 * s2;
    float r_p = r_s * (t3 - t4) / (t3 + t4);
    return clamp(0.5 * (r_s + r_p), 0.0, 1.0);
}

vec3 conductor_fresnel(float cosine, vec3 eta, vec3 k)
{
    return vec3(conductor_fresnel(cosine, eta.x, k.x), conductor_fresnel(cosine, eta.y, k.y),
                conductor_fresnel(cosine, eta.z, k.z));
}

#endif
