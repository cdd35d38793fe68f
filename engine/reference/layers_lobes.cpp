#include "engine/reference/layers_lobes.h"

#include <algorithm>
#include <cmath>

namespace etalon::reference {

ShadingFrame::ShadingFrame(const dvec3& normal) : n(normal)
{
    const dvec3 other = std::abs(n.x) > 0.7 ? dvec3(0, 1, 0) : dvec3(1, 0, 0);
    t = normalize(cross(other, n));
    b = cross(n, t);
}

ShadingFrame::ShadingFrame(const dvec3& tangent, const dvec3& normal) : t(tangent), b(cross(normal, tangent)), n(normal)
{}

double ggx_d(const dvec3& h, const dvec2& alpha)  // (SH-52)
{
    const double x = h.x / alpha.x, y = h.y / alpha.y;
    const double q = x * x + y * y + h.z * h.z;
    return 1 / (kPi * alpha.x * alpha.y * q * q);
}

double ggx_v(const dvec3& wo, const dvec3& wi, const dvec2& alpha)  // (SH-52)
{
    const double stretched_o = length(dvec3(alpha.x * wo.x, alpha.y * wo.y, wo.z));
    const double stretched_i = length(dvec3(alpha.x * wi.x, alpha.y * wi.y, wi.z));
    return 0.5 / (wi.z * stretched_o + wo.z * stretched_i);
}

double ggx_g1(const dvec3& w, const dvec2& alpha)
{
    return 2 * w.z / (w.z + length(dvec3(alpha.x * w.x, alpha.y * w.y, w.z)));
}

// (MC-6) By spherical caps: Dupuy & Benyoub, "Sampling Visible GGX Normals with Spherical Caps", 2023.
dvec3 sample_visible_normal(const dvec3& wo, const dvec2& alpha, const dvec2& u)
{
    const dvec3 v = normalize(dvec3(alpha.x * wo.x, alpha.y * wo.y, wo.z));
    const double z = (1 - u.x) * (1 + v.z) - v.z, phi = 2 * kPi * u.y;
    const double rim = std::sqrt(std::max(0.0, 1 - z * z));
    const dvec3 h = dvec3(rim * std::cos(phi), rim * std::sin(phi), z) + v;
    return normalize(dvec3(alpha.x * h.x, alpha.y * h.y, std::max(1e-300, h.z)));
}

double sheen_d(const dvec3& h, double alpha)  // (SH-61)
{
    const double sine2 = h.x * h.x + h.y * h.y;
    return (2 + 1 / alpha) * std::pow(sine2, 0.5 / alpha) / (2 * kPi);
}

namespace {

// (SH-61) Estevez and Kulla's fit of ln Λ below 60° from grazing.
double log_lambda(double x, double alpha)
{
    const double w = (1 - alpha) * (1 - alpha);
    const auto mix = [&](double p1, double p0) { return p1 + w * (p0 - p1); };
    const double a = mix(21.5473, 25.3245), b = mix(3.82987, 3.32435), c = mix(0.19823, 0.16801),
                 d = mix(-1.97760, -1.27393), e = mix(-4.32054, -4.85967);
    return a / (1 + b * std::pow(x, c)) + d * x + e;
}

double sheen_lambda(double cosine, double alpha)
{
    if (cosine < 0.5) return std::exp(log_lambda(cosine, alpha));
    return std::exp(2 * log_lambda(0.5, alpha) - log_lambda(1 - std::min(cosine, 1.0), alpha));
}

}  // namespace

double sheen_v(double cos_o, double cos_i, double alpha)  // (SH-61)
{
    return 1 / ((1 + sheen_lambda(cos_o, alpha) + sheen_lambda(cos_i, alpha)) * 4 * cos_o * cos_i);
}

}  // namespace etalon::reference
