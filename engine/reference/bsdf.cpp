#include "engine/reference/bsdf.h"

#include <algorithm>
#include <cmath>

namespace etalon::reference {
namespace {

double mean(const dvec3& c)
{
    return (c.x + c.y + c.z) / 3;
}

// Half vector, nothing for directions that are opposite but for rounding (S4).
std::optional<dvec3> half_vector(const dvec3& a, const dvec3& b)
{
    const dvec3 sum = a + b;
    const double square = dot(sum, sum);
    if (!(square > 1e-28)) return std::nullopt;
    return sum / std::sqrt(square);
}

dvec3 conductor_reflectance(double cosine, const dvec3& eta, const dvec3& k)
{
    const double red = fresnel_conductor(cosine, eta.x, k.x);
    const bool grey = eta.x == eta.y && eta.y == eta.z && k.x == k.y && k.y == k.z;
    if (grey) return dvec3(red);
    return {red, fresnel_conductor(cosine, eta.y, k.y), fresnel_conductor(cosine, eta.z, k.z)};
}

}  // namespace

bool Bsdf::is_delta() const
{
    return model == BsdfModel::mirror || model == BsdfModel::dielectric ||
           (model == BsdfModel::rough_dielectric && ior == 1);  // no bending, no reflection: straight through (S29)
}

bool Bsdf::is_black() const
{
    switch (model) {
        case BsdfModel::unlit:
            return true;
        case BsdfModel::lambert:
        case BsdfModel::mirror:
            return color == dvec3(0);
        case BsdfModel::metallic_roughness:
            return false;  // F reaches 1 at grazing angles
        default:
            return false;
    }
}

double ggx_d(const dvec3& h, double alpha)  // (SH-11)
{
    const double sine2 = h.x * h.x + h.y * h.y;
    const double k = alpha / (sine2 + h.z * h.z * alpha * alpha);
    return k * k / kPi;
}

double ggx_g1(double cosine, double alpha)  // (SH-17): 2 / (1 + √(1 + α² tan²θ)) times cos/cos
{
    const double c2 = cosine * cosine;
    return 2 * cosine / (cosine + std::sqrt(c2 + alpha * alpha * (1 - c2)));
}

double ggx_v(double cos_o, double cos_i, double alpha)  // (SH-12)
{
    const double a2 = alpha * alpha;
    return 0.5 / (cos_i * std::sqrt(cos_o * cos_o * (1 - a2) + a2) + cos_o * std::sqrt(cos_i * cos_i * (1 - a2) + a2));
}

// (MC-6) Heitz, "Sampling the GGX Distribution of Visible Normals", JCGT 7(4), 2018.
dvec3 sample_visible_normal(const dvec3& wo, double alpha, const dvec2& u)
{
    const dvec3 v = normalize(dvec3(alpha * wo.x, alpha * wo.y, wo.z));  // stretched: the ellipsoid is a hemisphere
    const double across = v.x * v.x + v.y * v.y;
    const dvec3 t1 = across > 0 ? dvec3(-v.y, v.x, 0) / std::sqrt(across) : dvec3(1, 0, 0);
    const dvec3 t2 = cross(v, t1);
    const double r = std::sqrt(u.x), phi = 2 * kPi * u.y;
    const double p1 = r * std::cos(phi);
    const double s = 0.5 * (1 + v.z);
    const double p2 = (1 - s) * std::sqrt(1 - p1 * p1) + s * r * std::sin(phi);
    const dvec3 n = p1 * t1 + p2 * t2 + std::sqrt(std::max(0.0, 1 - p1 * p1 - p2 * p2)) * v;
    return normalize(dvec3(alpha * n.x, alpha * n.y, std::max(1e-300, n.z)));
}

dvec3 sample_cosine(const dvec2& u)  // (MC-5)
{
    const double r = std::sqrt(u.x), phi = 2 * kPi * u.y;
    return {r * std::cos(phi), r * std::sin(phi), std::sqrt(1 - u.x)};
}

dvec3 fresnel_schlick(const dvec3& f0, double cosine)  // (SH-13)
{
    const double x = 1 - std::clamp(cosine, 0.0, 1.0);
    const double x2 = x * x;
    return f0 + (dvec3(1) - f0) * (x2 * x2 * x);
}

dvec3 energy_compensation(const dvec3& head_on, double share)  // (SH-53)
{
    return dvec3(1) + head_on * ((1 - share) / share);
}

// (SH-18) With q = η² − 1 nothing cancels as η → 1 (S10).
double fresnel_dielectric(double cosine, double ior)
{
    const double c = std::clamp(cosine, 0.0, 1.0);
    const double q = (ior - 1) * (ior + 1);
    const double bent = q + c * c;  // (η cosθ_t)²
    if (bent < 0) return 1;
    const double eta_ct = std::sqrt(bent), ct = eta_ct / ior;
    const double s2 = 1 - c * c;
    if (c + eta_ct == 0) return 1;
    const double rs = -q / ((c + eta_ct) * (c + eta_ct));
    const double rp = q * (c * c - s2 / (ior * ior)) / ((ior * c + ct) * (ior * c + ct));
    return 0.5 * (rs * rs + rp * rp);
}

// (SH-17) Born & Wolf, Principles of Optics, §14.2, in real numbers.
double fresnel_conductor(double cosine, double eta, double k)
{
    const double c = std::clamp(cosine, 0.0, 1.0);
    const double c2 = c * c, s2 = 1 - c2;
    const double t0 = eta * eta - k * k - s2;
    const double a2b2 = std::sqrt(t0 * t0 + 4 * eta * eta * k * k);
    const double a = std::sqrt(std::max(0.0, 0.5 * (a2b2 + t0)));
    if (a2b2 + c2 == 0) return 1;
    const double rs = (a2b2 + c2 - 2 * a * c) / (a2b2 + c2 + 2 * a * c);
    const double denominator = c2 * a2b2 + s2 * s2 + 2 * a * c * s2;
    if (denominator == 0) return rs;
    return 0.5 * rs * (1 + (c2 * a2b2 + s2 * s2 - 2 * a * c * s2) / denominator);
}

std::optional<dvec3> refract(const dvec3& wo, const dvec3& h, double ior)  // (SH-18) Snell
{
    const double c = std::clamp(dot(wo, h), 0.0, 1.0);
    const double bent = (ior - 1) * (ior + 1) + c * c;  // the same number that decides total reflection above (S11)
    if (bent < 0) return std::nullopt;
    return normalize(-wo + (c - std::sqrt(bent)) * h);
}

namespace {

// (SH-14) Share of samples that go to the specular lobe: what it reflects head on against what is left for the diffuse
// one.
double specular_share(const Bsdf& bsdf, double cos_o)
{
    const double diffuse = mean(bsdf.color);
    if (diffuse == 0) return 1;
    const double specular = mean(fresnel_schlick(bsdf.f0, cos_o));
    return std::clamp(specular / (specular + (1 - specular) * diffuse), 0.1, 0.9);
}

dvec3 evaluate_metallic_roughness(const Bsdf& bsdf, const dvec3& wo, const dvec3& wi)  // (SH-14)
{
    const auto h = half_vector(wo, wi);
    if (!h) return dvec3(0);
    const dvec3 f = fresnel_schlick(bsdf.f0, dot(wo, *h));
    dvec3 specular = f * (ggx_d(*h, bsdf.alpha) * ggx_v(wo.z, wi.z, bsdf.alpha));
    if (bsdf.energy != nullptr) specular *= energy_compensation(bsdf.f0, (*bsdf.energy)(wo.z, bsdf.alpha));
    return ((dvec3(1) - f) * bsdf.color / kPi + specular) * wi.z;
}

dvec3 evaluate_rough_conductor(const Bsdf& bsdf, const dvec3& wo, const dvec3& wi)  // (SH-17)
{
    const auto h = half_vector(wo, wi);
    if (!h) return dvec3(0);
    const double shape = ggx_d(*h, bsdf.alpha) * ggx_g1(wo.z, bsdf.alpha) * ggx_g1(wi.z, bsdf.alpha) / (4 * wo.z);
    return conductor_reflectance(dot(wo, *h), bsdf.eta, bsdf.k) * shape;
}

// (SH-19) The half vector that takes wo to wi, on +Z's side; nothing where none does.
std::optional<dvec3> dielectric_half(const Bsdf& bsdf, const dvec3& wo, const dvec3& wi)
{
    const auto sum = wi.z > 0 ? half_vector(wo, wi) : half_vector(wo, bsdf.ior * wi);
    if (!sum) return std::nullopt;
    const dvec3 h = sum->z < 0 ? -*sum : *sum;
    if (dot(wo, h) <= 0 || dot(wi, h) * wi.z <= 0) return std::nullopt;
    return h;
}

dvec3 evaluate_rough_dielectric(const Bsdf& bsdf, const dvec3& wo, const dvec3& wi)  // (SH-19)
{
    const auto h = dielectric_half(bsdf, wo, wi);
    if (!h) return dvec3(0);
    const double oh = dot(wo, *h), ih = dot(wi, *h);
    const double f = fresnel_dielectric(oh, bsdf.ior);
    const double dgg = ggx_d(*h, bsdf.alpha) * ggx_g1(wo.z, bsdf.alpha) * ggx_g1(std::abs(wi.z), bsdf.alpha);
    if (wi.z > 0) return dvec3(f * dgg / (4 * wo.z));
    const double denominator = oh + bsdf.ior * ih;
    return dvec3((1 - f) * dgg * oh * std::abs(ih) / (wo.z * denominator * denominator));
}

double pdf_rough_dielectric(const Bsdf& bsdf, const dvec3& wo, const dvec3& wi)
{
    const auto h = dielectric_half(bsdf, wo, wi);
    if (!h) return 0;
    const double oh = dot(wo, *h), ih = dot(wi, *h);
    const double f = fresnel_dielectric(oh, bsdf.ior);
    const double visible = ggx_d(*h, bsdf.alpha) * ggx_g1(wo.z, bsdf.alpha) / wo.z;  // density of h over wo·h (MC-6)
    if (wi.z > 0) return f * visible / 4;
    const double denominator = oh + bsdf.ior * ih;
    return (1 - f) * visible * oh * bsdf.ior * bsdf.ior * std::abs(ih) / (denominator * denominator);
}

}  // namespace

dvec3 evaluate(const Bsdf& bsdf, const dvec3& wo, const dvec3& wi)
{
    if (bsdf.is_delta() || wo.z <= 0) return dvec3(0);
    if (bsdf.model == BsdfModel::rough_dielectric)
        return wi.z == 0 ? dvec3(0) : evaluate_rough_dielectric(bsdf, wo, wi);
    if (wi.z <= 0) return dvec3(0);
    switch (bsdf.model) {
        case BsdfModel::lambert:
            return bsdf.color * (wi.z / kPi);  // (SH-10), (SH-16)
        case BsdfModel::metallic_roughness:
            return evaluate_metallic_roughness(bsdf, wo, wi);
        case BsdfModel::rough_conductor:
            return evaluate_rough_conductor(bsdf, wo, wi);
        default:
            return dvec3(0);
    }
}

double pdf(const Bsdf& bsdf, const dvec3& wo, const dvec3& wi)
{
    if (bsdf.is_delta() || wo.z <= 0) return 0;
    if (bsdf.model == BsdfModel::rough_dielectric) return wi.z == 0 ? 0 : pdf_rough_dielectric(bsdf, wo, wi);
    if (wi.z <= 0) return 0;
    if (bsdf.model == BsdfModel::lambert) return wi.z / kPi;
    if (bsdf.model == BsdfModel::unlit) return 0;
    const auto h = half_vector(wo, wi);
    const double specular = h ? ggx_d(*h, bsdf.alpha) * ggx_g1(wo.z, bsdf.alpha) / (4 * wo.z) : 0;
    if (bsdf.model == BsdfModel::rough_conductor) return specular;
    const double share = specular_share(bsdf, wo.z);
    return share * specular + (1 - share) * wi.z / kPi;
}

namespace {

std::optional<BsdfSample> sample_dielectric(const Bsdf& bsdf, const dvec3& wo, double u)  // (SH-18)
{
    const dvec3 n(0, 0, 1);
    if (bsdf.ior == 1) return BsdfSample{.wi = -wo, .weight = dvec3(1), .pdf = 1, .delta = true};
    const double f = fresnel_dielectric(wo.z, bsdf.ior);
    if (u < f) return BsdfSample{.wi = dvec3(-wo.x, -wo.y, wo.z), .weight = dvec3(1), .pdf = f, .delta = true};
    const auto wi = refract(wo, n, bsdf.ior);
    if (!wi) return std::nullopt;
    return BsdfSample{.wi = *wi, .weight = dvec3(1 / (bsdf.ior * bsdf.ior)), .pdf = 1 - f, .delta = true};
}

std::optional<BsdfSample> sample_rough_dielectric(const Bsdf& bsdf, const dvec3& wo, const dvec3& u)  // (SH-19)
{
    if (bsdf.ior == 1) return sample_dielectric(bsdf, wo, u.z);
    const dvec3 h = sample_visible_normal(wo, bsdf.alpha, dvec2(u));
    const double oh = dot(wo, h);
    const bool reflects = u.z < fresnel_dielectric(oh, bsdf.ior);
    const auto wi = reflects ? std::optional(normalize(2 * oh * h - wo)) : refract(wo, h, bsdf.ior);
    if (!wi || (reflects ? wi->z <= 0 : wi->z >= 0)) return std::nullopt;
    const double g = ggx_g1(std::abs(wi->z), bsdf.alpha);
    const double density = pdf_rough_dielectric(bsdf, wo, *wi);
    if (!(density > 0)) return std::nullopt;
    return BsdfSample{
        .wi = *wi, .weight = dvec3(reflects ? g : g / (bsdf.ior * bsdf.ior)), .pdf = density, .delta = false};
}

}  // namespace

std::optional<BsdfSample> sample(const Bsdf& bsdf, const dvec3& wo, const dvec3& u)
{
    if (wo.z <= 0) return std::nullopt;
    switch (bsdf.model) {
        case BsdfModel::unlit:
        case BsdfModel::specular_glossiness:  // LayeredBsdf's
            return std::nullopt;
        case BsdfModel::mirror:
            return BsdfSample{.wi = {-wo.x, -wo.y, wo.z}, .weight = bsdf.color, .pdf = 1, .delta = true};
        case BsdfModel::dielectric:
            return sample_dielectric(bsdf, wo, u.z);
        case BsdfModel::rough_dielectric:
            return sample_rough_dielectric(bsdf, wo, u);
        case BsdfModel::lambert: {
            const dvec3 wi = sample_cosine(dvec2(u));
            if (wi.z <= 0) return std::nullopt;  // pdf 0 (S18)
            return BsdfSample{.wi = wi, .weight = bsdf.color, .pdf = wi.z / kPi, .delta = false};
        }
        case BsdfModel::rough_conductor: {
            const dvec3 h = sample_visible_normal(wo, bsdf.alpha, dvec2(u));
            const dvec3 wi = normalize(2 * dot(wo, h) * h - wo);
            if (wi.z <= 0) return std::nullopt;
            const dvec3 f = conductor_reflectance(dot(wo, h), bsdf.eta, bsdf.k);
            return BsdfSample{
                .wi = wi, .weight = f * ggx_g1(wi.z, bsdf.alpha), .pdf = pdf(bsdf, wo, wi), .delta = false};
        }
        case BsdfModel::metallic_roughness:
            break;
    }
    dvec3 wi;
    if (u.z < specular_share(bsdf, wo.z)) {
        const dvec3 h = sample_visible_normal(wo, bsdf.alpha, dvec2(u));
        wi = normalize(2 * dot(wo, h) * h - wo);
    } else {
        wi = sample_cosine(dvec2(u));
    }
    const double density = pdf(bsdf, wo, wi);
    if (wi.z <= 0 || !(density > 0)) return std::nullopt;
    return BsdfSample{.wi = wi, .weight = evaluate(bsdf, wo, wi) / density, .pdf = density, .delta = false};
}

}  // namespace etalon::reference
