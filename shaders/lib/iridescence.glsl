// A thin film over a base (SH-51; Belcour and Barla 2017).
#ifndef ETALON_LIB_IRIDESCENCE_GLSL
#define ETALON_LIB_IRIDESCENCE_GLSL
#include "shaders/lib/fresnel.glsl"

// What the film does to light at one cosine, before the base is known.
struct ThinFilm {
    float ior;
    float cos_2;  // inside the film
    float r12;
    bool total;   // nothing enters the film
    vec3 first;   // waves of first and second order in X, Y, Z, for a base without phase jump
    vec3 second;
};

// Sensitivities of X, Y and Z to an optical path difference in nanometres, over the white point (fits of the colour
// matching functions; v √(2π σ) / 1.0685e-7). In turns, so that no cosine is taken of a large angle.
vec3 film_wave(float opd)
{
    vec3 turns = vec3(1.6810e-3, 1.7953e-3, 2.2084e-3) * opd;
    float second = 2.2399e-3 * opd;
    float p2 = (2.0 * kPi * opd) * (2.0 * kPi * opd);
    turns -= floor(turns);
    vec3 wave = vec3(cos_sin_turns(turns.x).x, cos_sin_turns(turns.y).x, cos_sin_turns(turns.z).x);
    vec3 xyz = vec3(0.84659000, 1.00022189, 1.00112249) * wave * exp(-vec3(4.3278e-9, 9.3046e-9, 6.6121e-9) * p2);
    xyz.x += 0.15386831 * cos_sin_turns(second - floor(second)).x * exp(-4.5282e-9 * p2);
    return xyz;
}

ThinFilm make_film(float cos_1, float ior, float nanometres)
{
    ThinFilm film;
    float x = clamp(nanometres / 0.03, 0.0, 1.0);
    film.ior = 1.0 + (ior - 1.0) * (x * x * (3.0 - 2.0 * x));
    float s = max(1.0 - cos_1 * cos_1, 0.0) / (film.ior * film.ior);
    film.total = s >= 1.0;
    film.cos_2 = sqrt(max(1.0 - s, 0.0));
    float root = (film.ior - 1.0) / (film.ior + 1.0);
    film.r12 = schlick_fresnel(vec3(root * root), cos_1).x;
    // Beyond a tenth of a millimetre all waves have died out.
    float opd = 2.0 * film.ior * min(nanometres, 1e5) * film.cos_2;
    // The jump of half a wave at a film denser than air turns the first order round.
    film.first = film_wave(opd) * (film.ior < 1.0 ? 1.0 : -1.0);
    film.second = film_wave(2.0 * opd);
    return film;
}

// Reflectance of the film over a base of reflectance f0 at normal incidence.
vec3 film_reflectance(ThinFilm film, vec3 f0)
{
    vec3 root = sqrt(clamp(f0, 0.0, 0.9999));
    vec3 base_ior = (1.0 + root) / (1.0 - root);
    vec3 ratio = (base_ior - film.ior) / (base_ior + film.ior);
    vec3 r23 = schlick_fresnel(ratio * ratio, film.cos_2);
    float t121 = 1.0 - film.r12;
    vec3 r123 = clamp(film.r12 * r23, 1e-5, 0.9999);
    vec3 r = sqrt(r123);
    vec3 rs = t121 * t121 * r23 / (1.0 - r123);
    // So does the jump at a base less dense than the film; two of them leave the second order as it is.
    vec3 jump = vec3(base_ior.x < film.ior ? -1.0 : 1.0, base_ior.y < film.ior ? -1.0 : 1.0, base_ior.z < film.ior ? -1.0 : 1.0);
    vec3 first = film.first * jump;
    const mat3 rgb_from_xyz = mat3(3.2404542, -0.9692660, 0.0556434, -1.5371385, 1.8760108, -0.2040259, -0.4985314, 0.0415560, 1.0572252);
    vec3 c1 = (rs - t121) * r;
    vec3 value = film.r12 + rs + 2.0 * (c1 * (rgb_from_xyz * first) + c1 * r * (rgb_from_xyz * film.second));
    return film.total ? vec3(1.0) : clamp(value, 0.0, 1.0);
}

#endif
