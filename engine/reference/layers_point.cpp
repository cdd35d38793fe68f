#include "engine/reference/layers_point.h"

#include <algorithm>
#include <cmath>

namespace etalon::reference {

namespace {

// (SH-62) Strength and roughness of the coat.
dvec2 coat_numbers(const MaterialLayers& m, const TextureSet& textures, const Attributes& attributes)
{
    return {m.clearcoat * textures.sample(m.clearcoat_texture, Coding::linear, attributes.at).x,
            m.clearcoat_roughness * textures.sample(m.clearcoat_roughness_texture, Coding::linear, attributes.at).y};
}

}  // namespace

LayerPoint evaluate(const MaterialLayers& m, const TextureSet& textures, const Attributes& attributes)
{
    const auto linear = [&](const TextureUse& use) { return textures.sample(use, Coding::linear, attributes.at); };
    const auto colour = [&](const TextureUse& use) { return textures.sample(use, Coding::srgb, attributes.at); };
    LayerPoint out;
    out.specular = m.specular * linear(m.specular_texture).w;
    out.specular_color = m.specular_color * dvec3(colour(m.specular_color_texture));
    const dvec2 coat = coat_numbers(m, textures, attributes);
    out.clearcoat = coat.x;
    out.clearcoat_roughness = coat.y;
    out.sheen_color = m.sheen_color * dvec3(colour(m.sheen_color_texture));
    out.sheen_roughness = m.sheen_roughness * linear(m.sheen_roughness_texture).w;
    out.transmission = m.transmission * linear(m.transmission_texture).x;
    out.thickness = m.thickness * linear(m.thickness_texture).y;
    out.iridescence = m.iridescence * linear(m.iridescence_texture).x;
    const double thickest = m.iridescence_thickness_max, thinnest = m.iridescence_thickness_min;
    out.iridescence_thickness = thickest;
    if (m.iridescence_thickness_texture.present())
        out.iridescence_thickness = thinnest + linear(m.iridescence_thickness_texture).y * (thickest - thinnest);
    out.anisotropy = m.anisotropy;
    dvec2 direction(1, 0);
    if (m.anisotropy_texture.present()) {
        const dvec4 texel = linear(m.anisotropy_texture);
        out.anisotropy *= texel.z;
        const dvec2 coded = 2.0 * dvec2(texel) - 1.0;
        const double size = length(coded);
        if (size > 0) direction = coded / size;
    }
    const double c = std::cos(m.anisotropy_rotation), s = std::sin(m.anisotropy_rotation);
    out.anisotropy_direction = {c * direction.x - s * direction.y, s * direction.x + c * direction.y};
    out.diffuse_transmission = m.diffuse_transmission * linear(m.diffuse_transmission_texture).w;
    out.diffuse_transmission_color = m.diffuse_transmission_color * dvec3(colour(m.diffuse_transmission_color_texture));
    return out;
}

BaseReflectance base_reflectance(const Material& material, const MaterialPoint& point, const LayerPoint& at)
{
    BaseReflectance out{.color = point.color, .metallic = point.metallic, .film = {}};
    if (material.model == BsdfModel::specular_glossiness) {
        out.metallic = 0;
        out.f0 = point.specular;
        out.f90 = 1;
        out.color *= std::max(0.0, 1 - std::max({out.f0.x, out.f0.y, out.f0.z}));
    } else {
        out.f0 = dielectric_f0(material.layers ? material.layers->ior : 1.5, at.specular, at.specular_color);
        out.f90 = at.specular;
    }
    if (material.layers)
        out.film = {
            .strength = at.iridescence, .ior = material.layers->iridescence_ior, .thickness = at.iridescence_thickness};
    return out;
}

dvec2 anisotropic_alpha(double roughness, double anisotropy)
{
    const double alpha = std::max(roughness * roughness, kSmallestMicrofacetAlpha);
    return {alpha + anisotropy * anisotropy * (1 - alpha), alpha};
}

dvec3 anisotropy_tangent(const Attributes& attributes, const dvec2& direction, const dvec3& n)
{
    const dvec3 given(attributes.tangent);
    const dvec3 across = given - n * dot(n, given);
    const double size = length(across);
    const ShadingFrame arbitrary(n);
    if (attributes.tangent.w == 0 || !(size > 1e-12 * length(given)) || !std::isfinite(size))
        return direction.x * arbitrary.t + direction.y * arbitrary.b;
    const dvec3 t = across / size;
    return direction.x * t + direction.y * attributes.tangent.w * cross(n, t);
}

double sheen_alpha(double roughness)
{
    const double r = std::max(roughness, 0.07);
    return r * r;
}

dvec3 coat_normal(const MaterialLayers& layers, const TextureSet& textures, const Attributes& attributes,
                  const dvec3& ng)
{
    return mapped_normal(layers.clearcoat_normal_texture, layers.clearcoat_normal_scale, textures, attributes, ng);
}

Coat coat_at(const Material& material, const TextureSet& textures, const Attributes& attributes, const dvec3& ng,
             const dvec3& wo)
{
    const MaterialLayers& m = *material.layers;
    const dvec2 numbers = coat_numbers(m, textures, attributes);
    const double side = dot(ng, wo) > 0 ? 1 : -1;  // (SH-3)
    dvec3 n = side * coat_normal(m, textures, attributes, ng);
    if (dot(n, wo) <= 0) n = side * ng;  // (SH-4)
    return {.weight = coat_weight(numbers.x, dot(n, wo)),
            .alpha = std::max(numbers.y * numbers.y, kSmallestMicrofacetAlpha),
            .normal = n};
}

void set_layered_bsdf(Surface& surface, const World& world, const Material& material, const dvec3& wo)
{
    LayerPoint at;
    if (material.layers) at = evaluate(*material.layers, world.textures, surface.attributes);
    const double side = surface.front ? 1 : -1;
    if (at.anisotropy > 0)
        surface.frame =
            ShadingFrame(anisotropy_tangent(surface.attributes, at.anisotropy_direction, side * surface.n), surface.n);
    const ShadingFrame& frame = surface.frame;
    LayeredBsdf& bsdf = surface.layered.emplace();
    bsdf.reflectance = base_reflectance(material, surface.point, at);
    bsdf.alpha = anisotropic_alpha(surface.point.roughness, at.anisotropy);
    bsdf.ng = frame.local(surface.ng);
    bsdf.ggx_share = &world.ggx_share;
    if (!material.layers) return;
    bsdf.transmission = at.transmission;
    bsdf.diffuse_transmission = at.diffuse_transmission;
    bsdf.diffuse_transmission_color = at.diffuse_transmission_color;
    if (is_body(material)) bsdf.body = {.ior = dispersed_ior(*material.layers), .inside = !surface.front};
    bsdf.sheen_color = at.sheen_color;
    bsdf.sheen_alpha = sheen_alpha(at.sheen_roughness);
    bsdf.sheen_share = &world.sheen_share;
    if (!(material.layers->clearcoat > 0)) return;
    const Coat coat = coat_at(material, world.textures, surface.attributes, side * surface.ng, wo);
    bsdf.coat_weight = coat.weight;
    bsdf.coat_alpha = coat.alpha;
    bsdf.coat_normal = frame.local(coat.normal);
    surface.emission *= 1 - coat.weight;  // (SH-62)
}

dvec3 dispersed_ior(const MaterialLayers& layers)
{
    if (layers.ior == 0) return dvec3(0);
    const double half = (layers.ior - 1) * 0.025 * layers.dispersion;
    return {std::max(layers.ior - half, 1.0), layers.ior, layers.ior + half};
}

// By powers of the colour: neither of its logarithm's infinities is met.
dvec3 absorption(const MaterialLayers& layers, double distance)
{
    if (!(distance > 0) || std::isinf(layers.attenuation_distance)) return dvec3(1);
    const double lengths = distance / layers.attenuation_distance;
    const auto left = [&](double color) { return color >= 1 ? 1 : std::pow(std::max(color, 0.0), lengths); };
    return {left(layers.attenuation_color.x), left(layers.attenuation_color.y), left(layers.attenuation_color.z)};
}

}  // namespace etalon::reference
