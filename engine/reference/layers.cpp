#include "engine/reference/layers.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/reference/layers_lobes.h"

namespace etalon::reference {
namespace {

double mean(const dvec3& c)
{
    return (c.x + c.y + c.z) / 3;
}

double max_channel(const dvec3& c)
{
    return std::max({c.x, c.y, c.z});
}

dvec3 mirrored(const dvec3& w)  // by the plane of the surface
{
    return {w.x, w.y, -w.z};
}

// The unit vector along `sum`, on +Z's side; nothing for directions that cancel but for rounding (S4).
std::optional<dvec3> upper_unit(const dvec3& sum)
{
    const double square = dot(sum, sum);
    if (!(square > 1e-28)) return std::nullopt;
    return (sum.z < 0 ? -1 : 1) / std::sqrt(square) * sum;
}

/// What every lobe needs to know about wo.
class Scattering {
 public:
    Scattering(const LayeredBsdf& bsdf, const dvec3& wo);

    dvec3 value(const dvec3& wi) const;
    double density(const dvec3& wi) const;
    std::optional<BsdfSample> draw(const dvec3& u) const;

 private:
    enum Lobe { coat, sheen, diffuse, diffuse_through, interface, straight, lobe_count };

    // An interface's half vector for transmission, by channel of a body that disperses.
    struct Crossing {
        dvec3 h{0};
        double oh = 0, ih = 0;   // cosines of wo (> 0) and wi (< 0) with it
        double jacobian = 0;     // dh/dwi
        double by_radiance = 1;  // (η on wo's side / η on wi's side)²
    };

    BaseReflectance::Value fresnel(double cosine) const;
    dvec3 transmitted(const BaseReflectance::Value& f) const;
    double reflect_chance(double cosine) const;
    double visible(const dvec3& h) const;
    std::optional<Crossing> crossing(const dvec3& wi, int channel) const;
    int channels() const;
    bool is_straight() const { return bsdf_->body && bsdf_->body->ior.y == 1; }
    bool transmits() const;

    dvec3 reflected(const dvec3& wi) const;
    dvec3 through(const dvec3& wi) const;
    double sheen_scale(const dvec3& wi) const;
    double sheen_value(const dvec3& wi) const;
    double coat_value(const dvec3& wi) const;
    double interface_density(const dvec3& wi) const;
    double coat_density(const dvec3& wi) const;
    void choose_chances();

    std::optional<dvec3> interface_direction(const dvec3& u) const;
    std::optional<dvec3> coat_direction(const dvec2& u) const;

    const LayeredBsdf* bsdf_;
    dvec3 wo_;
    dvec3 compensation_{1};   // M
    double sheen_share_ = 0;  // E_s(n·wo)
    std::array<double, lobe_count> chance_{};
};

Scattering::Scattering(const LayeredBsdf& bsdf, const dvec3& wo) : bsdf_(&bsdf), wo_(wo)
{
    if (bsdf.ggx_share != nullptr)
        compensation_ = energy_compensation(bsdf.reflectance.at(1).f,
                                            (*bsdf.ggx_share)(wo.z, std::sqrt(bsdf.alpha.x * bsdf.alpha.y)));
    if (bsdf.sheen_color != dvec3(0)) sheen_share_ = (*bsdf.sheen_share)(wo.z, bsdf.sheen_alpha);
    choose_chances();
}

// (SH-58) At the cosine on the outer side of a body.
BaseReflectance::Value Scattering::fresnel(double cosine) const
{
    if (!bsdf_->body || !bsdf_->body->inside || bsdf_->body->ior.y == 0) return bsdf_->reflectance.at(cosine);
    const double ior = bsdf_->body->ior.y;
    const double square = 1 - ior * ior * (1 - cosine) * (1 + cosine);
    return square < 0 ? bsdf_->reflectance.total() : bsdf_->reflectance.at(std::sqrt(square));
}

// What crosses the interface, of a body or a thin wall: (1 − F̂) t b (1 − m).
dvec3 Scattering::transmitted(const BaseReflectance::Value& f) const
{
    if (!transmits()) return dvec3(0);
    return (dvec3(1) - f.hat) * bsdf_->reflectance.color * (bsdf_->transmission * (1 - bsdf_->reflectance.metallic));
}

bool Scattering::transmits() const
{
    return bsdf_->transmission > 0 && !(bsdf_->body && bsdf_->body->ior.y == 0);
}

// Of a microfacet that wo meets at `cosine`: the chance that a draw is reflected rather than transmitted.
double Scattering::reflect_chance(double cosine) const
{
    if (!transmits() || is_straight()) return 1;
    const BaseReflectance::Value f = fresnel(cosine);
    const double reflects = mean(f.f), crosses = mean(transmitted(f));
    return reflects + crosses > 0 ? reflects / (reflects + crosses) : 1;
}

// (MC-6) Density of visible normals over wo·h.
double Scattering::visible(const dvec3& h) const
{
    return ggx_d(h, bsdf_->alpha) * ggx_g1(wo_, bsdf_->alpha) / wo_.z;
}

int Scattering::channels() const
{
    const dvec3 ior = bsdf_->body ? bsdf_->body->ior : dvec3(1);
    return ior.x == ior.z ? 1 : 3;
}

// (SH-57), (SH-58) How a microfacet takes wo to wi on the other side; nothing where none does.
std::optional<Scattering::Crossing> Scattering::crossing(const dvec3& wi, int channel) const
{
    Crossing out;
    if (!bsdf_->body) {
        const auto h = upper_unit(wo_ + mirrored(wi));
        if (!h) return std::nullopt;
        out.h = *h;
        out.oh = dot(wo_, *h);
        out.jacobian = 1 / (4 * out.oh);
        return out;
    }
    const double outer = bsdf_->body->ior[channel], ior = bsdf_->body->inside ? 1 / outer : outer;
    const auto h = upper_unit(wo_ + ior * wi);
    if (!h) return std::nullopt;
    out.h = *h;
    out.oh = dot(wo_, *h);
    out.ih = dot(wi, *h);
    if (!(out.oh > 0 && out.ih < 0)) return std::nullopt;
    const double sum = out.oh + ior * out.ih;
    out.jacobian = ior * ior * -out.ih / (sum * sum);
    out.by_radiance = 1 / (ior * ior);
    return out;
}

dvec3 Scattering::reflected(const dvec3& wi) const  // (SH-54), (SH-55)
{
    const auto h = upper_unit(wo_ + wi);
    if (!h) return dvec3(0);
    const BaseReflectance& r = bsdf_->reflectance;
    const BaseReflectance::Value f = fresnel(dot(wo_, *h));
    const double share = (1 - bsdf_->transmission) * (1 - bsdf_->diffuse_transmission) * (1 - r.metallic);
    const double lobe = ggx_d(*h, bsdf_->alpha) * ggx_v(wo_, wi, bsdf_->alpha);
    return ((dvec3(1) - f.hat) * r.color * (share / kPi) + f.f * compensation_ * lobe) * wi.z;
}

dvec3 Scattering::through(const dvec3& wi) const  // (SH-56), (SH-57), (SH-58), (SH-60)
{
    const dvec3 up = mirrored(wi);
    dvec3 sum(0);
    if (bsdf_->diffuse_transmission > 0) {
        const auto h = upper_unit(wo_ + up);
        if (!h) return dvec3(0);
        const double share =
            (1 - bsdf_->transmission) * bsdf_->diffuse_transmission * (1 - bsdf_->reflectance.metallic);
        sum += (dvec3(1) - fresnel(dot(wo_, *h)).hat) * bsdf_->diffuse_transmission_color * (share / kPi * up.z);
    }
    if (!transmits() || is_straight()) return sum;
    const auto of_channel = [&](int channel) {
        const auto c = crossing(wi, channel);
        if (!c) return dvec3(0);
        // D G₂ |wo·h| / |n·wo| times dh/dwi: for a thin wall that is D V |n·wi|.
        const double lobe = ggx_d(c->h, bsdf_->alpha) * ggx_v(wo_, up, bsdf_->alpha) * 4 * up.z * c->oh;
        return transmitted(fresnel(c->oh)) * (lobe * c->jacobian * c->by_radiance);
    };
    if (channels() == 1) return sum + of_channel(0);
    return sum + dvec3(of_channel(0).x, of_channel(1).y, of_channel(2).z);
}

double Scattering::sheen_scale(const dvec3& wi) const  // (SH-61) S
{
    if (sheen_share_ == 0) return 1;
    const double both = std::max(sheen_share_, (*bsdf_->sheen_share)(std::abs(wi.z), bsdf_->sheen_alpha));
    return std::max(0.0, 1 - max_channel(bsdf_->sheen_color) * std::min(1.0, both));
}

double Scattering::sheen_value(const dvec3& wi) const  // (SH-61)
{
    const auto h = upper_unit(wo_ + wi);
    if (!h) return 0;
    const double excess = std::max({1.0, sheen_share_, (*bsdf_->sheen_share)(wi.z, bsdf_->sheen_alpha)});
    return sheen_d(*h, bsdf_->sheen_alpha) * sheen_v(wo_.z, wi.z, bsdf_->sheen_alpha) / excess * wi.z;
}

double Scattering::coat_value(const dvec3& wi) const  // (SH-62) D V of n_c times its own cosine
{
    const ShadingFrame frame(bsdf_->coat_normal);
    const dvec3 o = frame.local(wo_), i = frame.local(wi);
    if (!(o.z > 0 && i.z > 0)) return 0;
    const auto h = upper_unit(o + i);
    return h ? ggx_d(*h, bsdf_->coat_alpha) * ggx_v(o.z, i.z, bsdf_->coat_alpha) * i.z : 0;
}

dvec3 Scattering::value(const dvec3& wi) const
{
    const double side = dot(bsdf_->ng, wi);
    dvec3 below(0);
    if (wi.z > 0 && side > 0) {
        below = reflected(wi);
        if (bsdf_->sheen_color != dvec3(0)) below = below * sheen_scale(wi) + bsdf_->sheen_color * sheen_value(wi);
    } else if (wi.z < 0 && side < 0) {
        below = through(wi) * sheen_scale(wi);
    }
    if (bsdf_->coat_weight == 0) return below;
    return below * (1 - bsdf_->coat_weight) + dvec3(side > 0 ? bsdf_->coat_weight * coat_value(wi) : 0);
}

// (SH-64) By what each lobe gives back head on; none that may carry light is drawn less than kFloor of the time.
void Scattering::choose_chances()
{
    constexpr double kFloor = 0.05;
    const LayeredBsdf& b = *bsdf_;
    const BaseReflectance::Value f = fresnel(wo_.z);
    const dvec3 kept = (dvec3(1) - f.hat) * ((1 - b.transmission) * (1 - b.reflectance.metallic));
    const double crosses = mean(transmitted(f));
    std::array<double, lobe_count> weight{};
    weight[coat] = bsdf_->coat_weight;
    weight[sheen] = mean(b.sheen_color) * std::min(1.0, sheen_share_);
    weight[diffuse] = mean(kept * b.reflectance.color) * (1 - b.diffuse_transmission);
    weight[diffuse_through] = mean(kept * b.diffuse_transmission_color) * b.diffuse_transmission;
    weight[interface] = mean(f.f) + (is_straight() ? 0 : crosses);
    weight[straight] = is_straight() ? crosses : 0;
    const bool scatters = b.transmission < 1 && b.reflectance.metallic < 1;
    const std::array<bool, lobe_count> possible{b.coat_weight > 0,
                                                b.sheen_color != dvec3(0),
                                                scatters && b.diffuse_transmission < 1,
                                                scatters && b.diffuse_transmission > 0,
                                                true,
                                                is_straight() && transmits()};
    double total = 0, floors = 0;
    for (std::size_t i = 0; i < lobe_count; ++i) {
        if (i > coat) weight[i] *= 1 - bsdf_->coat_weight;
        total += weight[i];
        floors += possible[i] ? kFloor : 0;
    }
    for (std::size_t i = 0; i < lobe_count; ++i)
        if (possible[i]) chance_[i] = total > 0 ? kFloor + (1 - floors) * weight[i] / total : kFloor / floors;
}

double Scattering::interface_density(const dvec3& wi) const
{
    if (wi.z > 0) {
        const auto h = upper_unit(wo_ + wi);
        return h ? reflect_chance(dot(wo_, *h)) * visible(*h) / 4 : 0;
    }
    if (!transmits() || is_straight()) return 0;
    double sum = 0;
    for (int channel = 0; channel < channels(); ++channel)
        if (const auto c = crossing(wi, channel))
            sum += (1 - reflect_chance(c->oh)) * visible(c->h) * c->oh * c->jacobian;
    return sum / channels();
}

double Scattering::coat_density(const dvec3& wi) const
{
    const ShadingFrame frame(bsdf_->coat_normal);
    const dvec3 o = frame.local(wo_), i = frame.local(wi);
    if (!(o.z > 0 && i.z > 0)) return 0;
    const auto h = upper_unit(o + i);
    return h ? ggx_d(*h, bsdf_->coat_alpha) * ggx_g1(o.z, bsdf_->coat_alpha) / (4 * o.z) : 0;
}

double Scattering::density(const dvec3& wi) const
{
    double sum = chance_[coat] > 0 ? chance_[coat] * coat_density(wi) : 0;
    if (wi.z > 0) sum += (chance_[sheen] + chance_[diffuse]) * wi.z / kPi;
    if (wi.z < 0) sum += chance_[diffuse_through] * -wi.z / kPi;
    return wi.z == 0 ? sum : sum + chance_[interface] * interface_density(wi);
}

std::optional<dvec3> Scattering::interface_direction(const dvec3& u) const
{
    const dvec3 h = sample_visible_normal(wo_, bsdf_->alpha, dvec2(u));
    const double oh = dot(wo_, h), reflects = reflect_chance(oh);
    const dvec3 up = normalize(2 * oh * h - wo_);
    if (u.z < reflects) return up.z > 0 ? std::optional(up) : std::nullopt;
    if (!bsdf_->body) return up.z > 0 ? std::optional(mirrored(up)) : std::nullopt;
    const int channel = std::min(channels() - 1, static_cast<int>((u.z - reflects) / (1 - reflects) * channels()));
    const double ior = bsdf_->body->ior[channel];
    const auto wi = refract(wo_, h, bsdf_->body->inside ? 1 / ior : ior);
    return wi && wi->z < 0 ? wi : std::nullopt;
}

std::optional<dvec3> Scattering::coat_direction(const dvec2& u) const
{
    const ShadingFrame frame(bsdf_->coat_normal);
    const dvec3 o = frame.local(wo_);
    if (!(o.z > 0)) return std::nullopt;
    const dvec3 h = sample_visible_normal(o, bsdf_->coat_alpha, u);
    const dvec3 i = normalize(2 * dot(o, h) * h - o);
    return i.z > 0 ? std::optional(frame.world(i)) : std::nullopt;
}

std::optional<BsdfSample> Scattering::draw(const dvec3& u) const
{
    std::size_t lobe = 0;
    double below = 0;
    while (lobe + 1 < lobe_count && u.z >= below + chance_[lobe]) below += chance_[lobe++];
    while (chance_[lobe] == 0) --lobe;  // the sum of the chances may round to less than u.z
    const dvec3 rest(dvec2(u), std::clamp((u.z - below) / chance_[lobe], 0.0, 1.0));
    std::optional<dvec3> wi;
    switch (lobe) {
        case coat:
            wi = coat_direction(dvec2(u));
            break;
        case sheen:
        case diffuse:
            wi = sample_cosine(dvec2(u));
            break;
        case diffuse_through:
            wi = mirrored(sample_cosine(dvec2(u)));
            break;
        case straight: {
            const dvec3 weight = transmitted(fresnel(wo_.z)) * (sheen_scale(-wo_) * (1 - bsdf_->coat_weight));
            return BsdfSample{
                .wi = -wo_, .weight = weight / chance_[straight], .pdf = chance_[straight], .delta = true};
        }
        default:
            wi = interface_direction(rest);
    }
    if (!wi) return std::nullopt;
    const double pdf = density(*wi);
    if (!(pdf > 0)) return std::nullopt;
    return BsdfSample{.wi = *wi, .weight = value(*wi) / pdf, .pdf = pdf, .delta = false};
}

}  // namespace

double LayeredBsdf::relative_ior() const
{
    if (!body || body->ior.y == 0) return 1;
    return body->inside ? 1 / body->ior.y : body->ior.y;
}

double coat_weight(double coat, double cosine)  // (SH-62)
{
    const double x = 1 - std::clamp(std::abs(cosine), 0.0, 1.0);
    const double x2 = x * x;
    return coat * (0.04 + 0.96 * (x2 * x2 * x));
}

dvec3 evaluate(const LayeredBsdf& bsdf, const dvec3& wo, const dvec3& wi)
{
    return wo.z > 0 ? Scattering(bsdf, wo).value(wi) : dvec3(0);
}

double pdf(const LayeredBsdf& bsdf, const dvec3& wo, const dvec3& wi)
{
    return wo.z > 0 ? Scattering(bsdf, wo).density(wi) : 0;
}

std::optional<BsdfSample> sample(const LayeredBsdf& bsdf, const dvec3& wo, const dvec3& u)
{
    return wo.z > 0 ? Scattering(bsdf, wo).draw(u) : std::nullopt;
}

}  // namespace etalon::reference
