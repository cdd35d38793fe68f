#include "engine/reference/layers_fresnel.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/reference/bsdf.h"

namespace etalon::reference {
namespace {

double schlick(double f0, double f90, double cosine)
{
    const double x = 1 - std::clamp(cosine, 0.0, 1.0);
    const double x2 = x * x;
    return f0 + (f90 - f0) * (x2 * x2 * x);
}

// Reflectance head on between two indices.
double head_on(double beyond, double here)
{
    const double r = (beyond - here) / (beyond + here);
    return r * r;
}

// (SH-51) S: what a phase difference does to each channel. Gaussians fitted to the CIE 1931 observer's curves in the
// frequency domain: Belcour & Barla, "A Practical Extension to Microfacet Theory for the Modeling of Varying
// Iridescence", 2017.
dvec3 sensitivity(double path, const dvec3& phase)
{
    const double p = 2 * kPi * path * 1e-9;
    const auto gaussian = [&](double height, double center, double width, double shift) {
        return height * std::sqrt(2 * kPi * width) * std::cos(center * p + shift) * std::exp(-width * p * p);
    };
    const dvec3 xyz =
        dvec3(gaussian(5.4856e-13, 1.6810e6, 4.3278e9, phase.x) + gaussian(9.7470e-14, 2.2399e6, 4.5282e9, phase.x),
              gaussian(4.4201e-13, 1.7953e6, 9.3046e9, phase.y), gaussian(5.2481e-13, 2.2084e6, 6.6121e9, phase.z)) /
        1.0685e-7;
    return {dot(xyz, {3.2404542, -1.5371385, -0.4985314}), dot(xyz, {-0.9692660, 1.8760108, 0.0415560}),
            dot(xyz, {0.0556434, -0.2040259, 1.0572252})};
}

// The two interfaces of a film for one channel.
struct Airy {
    double constant = 0;             // C₀
    std::array<double, 2> orders{};  // C₁, C₂
    double phase = 0;                // φ
};

Airy airy(double f0, double film_ior, double cosine, double cosine_in_film)
{
    const double root = std::sqrt(std::clamp(f0, 0.0, 0.9999));
    const double base_ior = (1 + root) / (1 - root);
    const double r12 = schlick(head_on(film_ior, 1), 1, cosine), t = 1 - r12;
    const double r23 = schlick(head_on(base_ior, film_ior), 1, cosine_in_film);
    Airy out;
    out.phase = (film_ior < 1 ? 0 : kPi) + (base_ior < film_ior ? kPi : 0);
    const double both = std::clamp(r12 * r23, 1e-5, 0.9999), r = std::sqrt(both);
    const double rs = t * t * r23 / (1 - both);
    out.constant = r12 + rs;
    out.orders = {(rs - t) * r, (rs - t) * both};
    return out;
}

}  // namespace

dvec3 thin_film(double cosine, const dvec3& f0, double ior, double thickness)  // (SH-51)
{
    const double c1 = std::clamp(cosine, 0.0, 1.0);
    const double x = std::clamp(thickness / 0.03, 0.0, 1.0);
    const double film_ior = 1 + (ior - 1) * (x * x * (3 - 2 * x));  // a film of no thickness is air
    const double sine2 = (1 - c1 * c1) / (film_ior * film_ior);
    if (sine2 >= 1) return dvec3(1);
    const double c2 = std::sqrt(1 - sine2);
    const Airy red = airy(f0.x, film_ior, c1, c2), green = airy(f0.y, film_ior, c1, c2),
               blue = airy(f0.z, film_ior, c1, c2);
    const dvec3 phase(red.phase, green.phase, blue.phase);
    const double path = 2 * film_ior * thickness * c2;
    dvec3 sum(red.constant, green.constant, blue.constant);
    for (std::size_t k = 0; k < 2; ++k)
        sum += dvec3(red.orders[k], green.orders[k], blue.orders[k]) * 2.0 *
               sensitivity(static_cast<double>(k + 1) * path, static_cast<double>(k + 1) * phase);
    return glm::clamp(sum, 0.0, 1.0);
}

BaseReflectance::Value BaseReflectance::at(double cosine) const
{
    dvec3 dielectric(0), metal(0);
    for (int c = 0; c < 3; ++c) {
        dielectric[c] = schlick(f0[c], f90, cosine);
        metal[c] = schlick(color[c], 1, cosine);
    }
    if (film.strength > 0 && film.thickness > 0) {
        if (metallic < 1) dielectric += film.strength * (thin_film(cosine, f0, film.ior, film.thickness) - dielectric);
        if (metallic > 0) metal += film.strength * (thin_film(cosine, color, film.ior, film.thickness) - metal);
    }
    const dvec3 most(std::max({dielectric.x, dielectric.y, dielectric.z}));
    return {.f = dielectric + metallic * (metal - dielectric),
            .hat = glm::clamp(most + metallic * (metal - most), 0.0, 1.0)};
}

BaseReflectance::Value BaseReflectance::total() const
{
    const dvec3 all(f90 + metallic * (1 - f90));
    return {.f = all, .hat = all};
}

dvec3 dielectric_f0(double ior, double specular, const dvec3& specular_color)
{
    const double head = ior == 0 ? 1 : head_on(ior, 1);
    return specular * glm::min(head * specular_color, dvec3(1));
}

}  // namespace etalon::reference
