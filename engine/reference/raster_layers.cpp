#include "engine/reference/raster_layers.h"

#include <algorithm>
#include <cmath>

#include "engine/reference/layers_lobes.h"
#include "engine/reference/raster_shade.h"

namespace etalon::reference {
namespace {

constexpr double kSmallestCosine = 1e-4;  // (SH-32)
constexpr double kSmallestAlpha = 1e-3;   // (SH-14)

double max_channel(const dvec3& c)
{
    return std::max({c.x, c.y, c.z});
}

double squared_alpha(double roughness)
{
    return std::max(roughness * roughness, kSmallestAlpha);
}

// D of the unit half vector about `n`, in the form that keeps its digits (S6).
double ggx_about(const dvec3& n, const dvec3& h, double alpha)
{
    const dvec3 sine = cross(n, h);
    const double n_h = dot(n, h);
    const double k = alpha / (dot(sine, sine) + n_h * n_h * alpha * alpha);
    return k * k / kPi;
}

dvec3 reflection(const dvec3& wo, const dvec3& n)
{
    return 2 * dot(wo, n) * n - wo;
}

}  // namespace

RasterSurface::RasterSurface(const Material& material, const MaterialPoint& point, const Attributes& attributes,
                             const TextureSet& textures, const Place& place, const RasterSurroundings& around)
    : around_(&around), place_(place), roughness_(point.roughness), occlusion_(point.occlusion)
{
    if (material.layers) layers_ = evaluate(*material.layers, textures, attributes);
    reflectance_ = base_reflectance(material, point, layers_);
    n_o_ = std::max(dot(place.n, place.wo), kSmallestCosine);
    alpha_ = dvec2(squared_alpha(roughness_));
    const bool anisotropic = material.layers && material.layers->anisotropy != 0;
    if (anisotropic) {
        alpha_ = anisotropic_alpha(roughness_, layers_.anisotropy);
        t_ = anisotropy_tangent(attributes, layers_.anisotropy_direction, place.n_front);
        b_ = cross(place.n_front, t_);
    }
    head_on_ = reflectance_.at(1).f;
    compensation_ = energy_compensation(
        head_on_, around.shares->ggx(n_o_, anisotropic ? std::sqrt(alpha_.x * alpha_.y) : alpha_.x));
    if (layers_.sheen_color != dvec3(0))
        sheen_seen_ = around.shares->sheen(n_o_, std::max(layers_.sheen_roughness, 0.07));
    if (material.layers && material.layers->clearcoat > 0) set_coat(*material.layers, textures, attributes);
    if (material.layers && material.layers->ior == 0) layers_.transmission = 0;
    if (material.layers && material.layers->volumetric()) {
        body_ior_ = dispersed_ior(*material.layers);
        layers_.thickness *= place.scale;
        absorbed_ = absorption(*material.layers, layers_.thickness);
    }
}

void RasterSurface::set_coat(const MaterialLayers& layers, const TextureSet& textures, const Attributes& attributes)
{
    const auto texel = [&](const TextureUse& use) { return textures.sample(use, Coding::linear, attributes.at); };
    Material mapped;
    mapped.normal_texture = layers.clearcoat_normal_texture;
    mapped.normal_scale = layers.clearcoat_normal_scale;
    coat_normal_ = (place_.front ? 1.0 : -1.0) * shading_normal(mapped, textures, attributes, place_.ng_file);
    coat_roughness_ = layers.clearcoat_roughness * texel(layers.clearcoat_roughness_texture).y;
    coat_o_ = std::max(dot(coat_normal_, place_.wo), kSmallestCosine);
    coat_weight_ = coat_weight(layers.clearcoat * texel(layers.clearcoat_texture).x, coat_o_);
}

double RasterSurface::microfacets(const dvec3& h, const dvec3& wi) const
{
    const dvec3& n = place_.n;
    const double n_i = dot(n, wi);
    if (alpha_.x == alpha_.y) return ggx_about(n, h, alpha_.x) * ggx_v(n_o_, n_i, alpha_.x);
    const auto local = [&](const dvec3& w, double z) { return dvec3(dot(t_, w), dot(b_, w), z); };
    return ggx_d(local(h, dot(n, h)), alpha_) * ggx_v(local(place_.wo, n_o_), local(wi, n_i), alpha_);
}

double RasterSurface::sheen_given(double n_i) const
{
    if (layers_.sheen_color == dvec3(0)) return 0;
    return std::max(sheen_seen_, around_->shares->sheen(n_i, std::max(layers_.sheen_roughness, 0.07)));
}

double RasterSurface::below_sheen(double given) const  // (SH-61) S
{
    return std::max(0.0, 1 - max_channel(layers_.sheen_color) * std::min(given, 1.0));
}

dvec3 RasterSurface::reflected(const dvec3& wi, double n_i) const
{
    const dvec3 sum = place_.wo + wi;
    if (!(dot(sum, sum) > 1e-28)) return dvec3(0);  // opposite directions have no half vector (S4)
    const dvec3 h = normalize(sum);
    const BaseReflectance::Value f = reflectance_.at(dot(place_.wo, h));
    const dvec3 diffuse = reflectance_.color * ((1 - reflectance_.metallic) * (1 - layers_.transmission) *
                                                (1 - layers_.diffuse_transmission) / kPi);
    const dvec3 base = (dvec3(1) - f.hat) * diffuse + f.f * compensation_ * microfacets(h, wi);  // (SH-54), (SH-55)
    if (layers_.sheen_color == dvec3(0)) return base * n_i;
    const double given = sheen_given(n_i), r = std::max(layers_.sheen_roughness, 0.07);
    const dvec3 sine = cross(place_.n, h);
    const dvec3 about_n(length(sine), 0, dot(place_.n, h));
    const double lobe = sheen_d(about_n, r * r) * sheen_v(n_o_, n_i, r * r) / std::max(given, 1.0);
    return (below_sheen(given) * base + lobe * layers_.sheen_color) * n_i;
}

dvec3 RasterSurface::transmitted(const dvec3& wi, double n_i) const  // (SH-56), (SH-57)
{
    const dvec3 mirrored = wi + 2 * n_i * place_.n;
    const dvec3 sum = place_.wo + mirrored;
    if (!(dot(sum, sum) > 1e-28)) return dvec3(0);
    const dvec3 h = normalize(sum);
    const double below = 1 - reflectance_.metallic, t = layers_.transmission;
    dvec3 f = layers_.diffuse_transmission * (1 - t) * below / kPi * layers_.diffuse_transmission_color;
    if (t > 0 && !body_ior_) f += t * below * microfacets(h, mirrored) * reflectance_.color;
    return below_sheen(sheen_given(n_i)) * n_i * (dvec3(1) - reflectance_.at(dot(place_.wo, h)).hat) * f;
}

dvec3 RasterSurface::scatter(const dvec3& wi) const
{
    const double n_i = dot(place_.n, wi), g_i = dot(place_.ng, wi);
    dvec3 sum(0);
    if (n_i > 0 && g_i > 0) sum = reflected(wi, n_i);
    if (n_i < 0 && g_i < 0) sum = transmitted(wi, -n_i);
    if (coat_weight_ == 0) return sum;
    sum *= 1 - coat_weight_;
    const double c_i = dot(coat_normal_, wi);
    if (!(c_i > 0) || !(g_i > 0)) return sum;
    const double alpha = squared_alpha(coat_roughness_);
    const dvec3 h = normalize(place_.wo + wi);
    return sum + coat_weight_ * ggx_about(coat_normal_, h, alpha) * ggx_v(coat_o_, c_i, alpha) * c_i;
}

// (SH-34); of anisotropic surfaces about a normal bent towards the direction in which the highlight is drawn out.
dvec3 RasterSurface::reflected_direction() const
{
    if (b_ == dvec3(0)) return normalize(dominant_reflection(place_.wo, place_.n, roughness_));
    const dvec3 along = cross(cross(b_, place_.wo), b_);
    const double size = length(along);
    if (!(size > 0)) return reflection(place_.wo, place_.n);
    const double keep = std::pow(1 - layers_.anisotropy * (1 - roughness_), 4);
    return reflection(place_.wo, normalize(keep * place_.n + (1 - keep) * along / size));
}

dvec3 RasterSurface::environment() const
{
    const dvec2 ab = around_->shares->specular(n_o_, roughness_);
    const double both = ab.x + ab.y, w = std::pow(1 - n_o_, 3) / 36;
    const BaseReflectance& r = reflectance_;
    const auto film = [&](const dvec3& without, const dvec3& f0, double by) {
        if (!(r.film.strength > 0) || !(r.film.thickness > 0)) return without;
        return without + r.film.strength * (by * thin_film(n_o_, f0, r.film.ior, r.film.thickness) - without);
    };
    const dvec3 dielectric = film(r.f0 * ab.x + r.f90 * ab.y, r.f0, both);
    const dvec3 metal = film(r.color * ab.x + ab.y, r.color, both);
    const double lost = max_channel(film(r.f0 + (r.f90 - r.f0) * w, r.f0, 1));
    const dvec3 lost_metal = film(r.color + (dvec3(1) - r.color) * w, r.color, 1);
    const dvec3 specular = (dielectric + r.metallic * (metal - dielectric)) * energy_compensation(head_on_, both);
    const dvec3 kept = dvec3(1) - (lost + r.metallic * (lost_metal - lost));
    const dvec3 diffuse = (1 - r.metallic) * (1 - layers_.transmission) * kept / kPi;

    const EnvironmentTables& e = *around_->environment;
    dvec3 sum = occlusion_ * e.prefiltered(reflected_direction(), roughness_) * specular;
    sum += occlusion_ * (1 - layers_.diffuse_transmission) * diffuse * r.color * e.irradiance(place_.n);
    if (layers_.diffuse_transmission > 0)
        sum += layers_.diffuse_transmission * diffuse * layers_.diffuse_transmission_color * e.irradiance(-place_.n);
    return sum;
}

dvec3 RasterSurface::seen_through(double ior) const
{
    double narrowing = 1;
    dvec3 direction = -place_.wo;
    dvec2 film = place_.film;
    if (body_ior_) {
        narrowing = std::min(std::abs(ior - 1) / std::sqrt(2.0), 1.0);
        const double c = dot(place_.n, place_.wo), square = 1 - (1 - c * c) / (ior * ior);
        if (square >= 0) direction = (c / ior - std::sqrt(square)) * place_.n - place_.wo / ior;
        film = around_->camera->film_of(place_.position + layers_.thickness * direction).value_or(film);
    }
    const double alpha = roughness_ * roughness_ * narrowing;
    const double width = alpha * around_->size.y / around_->film_height;
    const dvec4 near = around_->behind->at(film, std::log2(std::max(width, 1.0)));
    return dvec3(near) + (1 - near.w) * around_->environment->prefiltered(direction, std::sqrt(alpha));
}

dvec3 RasterSurface::behind() const
{
    if (layers_.transmission == 0) return dvec3(0);
    dvec3 sum;
    if (body_ior_ && body_ior_->x != body_ior_->z)
        sum = {seen_through(body_ior_->x).x, seen_through(body_ior_->y).y, seen_through(body_ior_->z).z};
    else
        sum = seen_through(body_ior_ ? body_ior_->y : 1);
    return (dvec3(1) - reflectance_.at(n_o_).hat) * layers_.transmission * (1 - reflectance_.metallic) *
           reflectance_.color * absorbed_ * sum;
}

dvec3 RasterSurface::surroundings() const
{
    const EnvironmentTables& e = *around_->environment;
    dvec3 sum = environment() + behind();
    if (layers_.sheen_color != dvec3(0)) {
        sum *= below_sheen(sheen_seen_);
        sum += occlusion_ * std::min(sheen_seen_, 1.0) * layers_.sheen_color * e.irradiance(place_.n) / kPi;
    }
    if (coat_weight_ == 0) return sum;
    return (1 - coat_weight_) * sum +
           occlusion_ * coat_weight_ * e.prefiltered(reflection(place_.wo, coat_normal_), coat_roughness_);
}

}  // namespace etalon::reference
