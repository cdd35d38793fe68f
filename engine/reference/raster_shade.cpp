#include "engine/reference/raster_shade.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace etalon::reference {
namespace {

constexpr double kSmallestCosine = 1e-4;   // (SH-32)
constexpr std::size_t kMostEmitters = 16;  // (SH-39)

}  // namespace

RasterMaterial raster_material(const Material& material, const MaterialPoint& point)  // (SH-37)
{
    const auto squared_alpha = [](double roughness) { return std::max(roughness * roughness, 1e-3); };
    RasterMaterial m;
    switch (material.model) {
        case BsdfModel::unlit:
            break;
        case BsdfModel::lambert:
            m.diffuse = point.color;
            m.has_specular = false;
            break;
        case BsdfModel::mirror:
            m.f0 = point.color;
            m.roughness = 0;
            m.is_mirror = true;
            break;
        case BsdfModel::rough_conductor:
            for (int c = 0; c < 3; ++c) m.f0[c] = fresnel_conductor(1, material.eta[c], material.k[c]);
            m.roughness = std::sqrt(material.ggx_alpha);
            break;
        case BsdfModel::dielectric:
        case BsdfModel::rough_dielectric: {
            const double r = (material.eta.x - 1) / (material.eta.x + 1);
            m.f0 = dvec3(r * r);
            m.roughness = material.model == BsdfModel::dielectric ? 0 : std::sqrt(material.ggx_alpha);
            break;
        }
        case BsdfModel::metallic_roughness:
            m.diffuse = point.color * (1 - point.metallic);
            m.f0 = dvec3(0.04) + point.metallic * (point.color - dvec3(0.04));
            m.roughness = point.roughness;
            break;
        case BsdfModel::specular_glossiness: {
            const BaseReflectance r = base_reflectance(material, point, {});
            m.diffuse = r.color;
            m.f0 = r.f0;
            m.roughness = point.roughness;
            break;
        }
    }
    m.alpha = squared_alpha(m.roughness);
    return m;
}

double roughness_with_spread(double roughness, double size, double scale, double minified)
{
    // 10⁻⁴: what 16 bits leave of unit normals.
    const double spread = size > 0 ? 2 * minified * scale * scale * std::max(0.0, 1 / size - 1.0001) : 0;
    if (spread == 0) return roughness;
    const double alpha = std::max(roughness * roughness, 1e-3);
    return std::sqrt(std::min(1.0, std::sqrt(alpha * alpha + spread)));
}

dvec3 reflect_pbr(const RasterMaterial& m, const dvec3& n, const dvec3& wo, const dvec3& wi, double n_o)
{
    const double n_i = dot(n, wi);
    if (!(n_i > 0) || m.is_mirror) return dvec3(0);
    if (!m.has_specular) return m.diffuse * (n_i / kPi);
    const dvec3 sum = wo + wi;
    if (!(dot(sum, sum) > 1e-28)) return dvec3(0);  // opposite directions have no half vector (S4)
    const dvec3 h = normalize(sum);
    const dvec3 sine = cross(n, h);
    const double n_h = dot(n, h);
    const double k = m.alpha / (dot(sine, sine) + n_h * n_h * m.alpha * m.alpha);
    const double d = k * k / kPi;  // (SH-11)
    const dvec3 f = fresnel_schlick(m.f0, dot(wo, h));
    return ((dvec3(1) - f) * m.diffuse / kPi + f * (d * ggx_v(n_o, n_i, m.alpha))) * n_i;  // (SH-14)
}

double blinn_phong_exponent(double alpha)
{
    return std::clamp(2 / (alpha * alpha) - 2, 0.0, 1e6);
}

// n·h = 1 − d²/2, whose logarithm is exact near 1 where n·h itself has no digits left (S1).
double blinn_phong_lobe(double exponent, double distance)
{
    const double p = exponent;
    const double scale = (p + 2) * (p + 4) / (8 * kPi * (std::exp2(-p / 2) + p));
    if (p == 0) return scale;
    const double half_square = distance * distance / 2;
    return half_square >= 1 ? 0 : scale * std::exp(p * std::log1p(-half_square));
}

dvec3 reflect_blinn_phong(const RasterMaterial& m, const dvec3& n, const dvec3& wo, const dvec3& wi)  // (SH-38)
{
    const double n_i = dot(n, wi);
    if (!(n_i > 0)) return dvec3(0);
    dvec3 f = m.diffuse / kPi;
    const dvec3 sum = wo + wi;
    if (m.has_specular && dot(sum, sum) > 1e-28)
        f += m.f0 * blinn_phong_lobe(blinn_phong_exponent(m.alpha), length(n - normalize(sum)));
    return f * n_i;
}

std::vector<RasterEmitter> raster_emitters(const World& world)  // (SH-39)
{
    std::map<std::uint32_t, RasterEmitter> by_object;
    for (const Shape& shape : world.index.shapes()) {
        const Material& m = world.material(shape);
        if (m.emission == dvec3(0) || m.emissive_texture.present() || m.model == BsdfModel::unlit) continue;
        RasterEmitter& emitter = by_object[shape.object];
        emitter.radiance = m.emission;
        emitter.object = shape.object;
        emitter.two_sided = m.double_sided && !m.emits_front_only;
        if (shape.is_sphere()) {
            emitter.area = 4 * kPi * shape.p1.x * shape.p1.x;
            emitter.center = shape.p0 * emitter.area;
        } else {
            const double area = 0.5 * length(cross(shape.p1 - shape.p0, shape.p2 - shape.p0));
            emitter.area += area;
            emitter.area_normal += area * geometric_normal(shape, shape.p0);
            emitter.center += area * (shape.p0 + shape.p1 + shape.p2) / 3.0;
        }
    }
    std::vector<RasterEmitter> emitters;
    for (auto& [object, emitter] : by_object) {
        emitter.center /= emitter.area;
        emitters.push_back(emitter);
    }
    const auto power = [](const RasterEmitter& e) { return dot(e.radiance, dvec3(0.2126, 0.7152, 0.0722)) * e.area; };
    std::stable_sort(emitters.begin(), emitters.end(),
                     [&](const auto& a, const auto& b) { return power(a) > power(b); });
    if (emitters.size() > kMostEmitters) emitters.resize(kMostEmitters);
    return emitters;
}

Incident incident(const RasterEmitter& emitter, const dvec3& p)  // (SH-39)
{
    Incident out;
    const dvec3 to_center = emitter.center - p;
    out.distance = length(to_center);
    if (!(out.distance > 0)) return out;
    out.wi = to_center / out.distance;
    double seen = emitter.area / 4;  // a closed shape shows a quarter of its surface on average (Cauchy)
    if (length(emitter.area_normal) > emitter.area / 2) {
        const double facing = dot(emitter.area_normal, -out.wi);
        seen = emitter.two_sided ? std::abs(facing) : std::max(facing, 0.0);
    }
    out.irradiance = emitter.radiance * (seen / std::max(out.distance * out.distance, emitter.area / kPi));
    return out;
}

namespace {

bool is_gltf_model(const Material& material)
{
    return material.model == BsdfModel::metallic_roughness || material.model == BsdfModel::specular_glossiness;
}

RasterShares shares_for(const std::vector<Material>& materials, bool blinn_phong, unsigned threads)
{
    bool ggx = false, sheen = false;
    for (const Material& material : materials) {
        const bool exact = material.model == BsdfModel::rough_conductor || is_dielectric(material.model);
        if (blinn_phong || !(is_gltf_model(material) || exact)) continue;
        ggx = true;
        sheen |= material.layers && material.layers->sheen_color != dvec3(0);
    }
    return {ggx, sheen, threads};
}

}  // namespace

RasterShader::RasterShader(const World& world, const RenderSettings& settings)
    : world_(&world),
      camera_(world.posed->view),
      environment_(world.posed->environment, settings.threads),
      shares_(shares_for(world.posed->materials(), settings.shading == Shading::blinn_phong, settings.threads)),
      emitters_(raster_emitters(world)),
      blinn_phong_(settings.shading == Shading::blinn_phong),
      shadows_(settings.shadows != Shadows::none),
      background_(settings.background),
      background_color_(settings.background_color)
{}

dvec3 RasterShader::towards_viewer(const dvec3& position) const
{
    const View& view = world_->posed->view;
    if (view.camera.orthographic) return normalize(dvec3(view.world_from_camera[2]));
    return normalize(dvec3(view.world_from_camera[3]) - position);
}

bool RasterShader::has_layers(const Material& material) const
{
    return !blinn_phong_ && is_gltf_model(material);
}

bool RasterShader::transmits(const Material& material) const
{
    return has_layers(material) && material.layers && material.layers->transmission > 0;
}

std::optional<Shaded> RasterShader::shade(const Fragment& fragment, const PictureBehind* behind) const
{
    const Material& material = *fragment.material;
    MaterialPoint point = evaluate(material, world_->textures, fragment.attributes);
    if (is_gltf_model(material) && material.normal_texture.present() && fragment.attributes.tangent != dvec4(0)) {
        const dvec4 texel = world_->textures.sample(material.normal_texture, Coding::normal, fragment.attributes.at);
        const double size = length(2.0 * dvec3(texel) - 1.0);
        const double level = world_->textures.level(material.normal_texture, Coding::normal, fragment.attributes.at);
        point.roughness =
            roughness_with_spread(point.roughness, size, material.normal_scale, std::clamp(level, 0.0, 1.0));
    }
    if (material.alpha_mode == AlphaMode::mask && point.alpha < material.alpha_cutoff) return std::nullopt;
    Shaded out;
    if (material.alpha_mode == AlphaMode::blend) out.alpha = std::clamp(point.alpha, 0.0, 1.0);
    const bool emits = fragment.front || (material.double_sided && !material.emits_front_only);  // (SH-21)
    if (emits || material.model == BsdfModel::unlit) out.radiance = point.emission;
    if (material.model == BsdfModel::unlit) return out;
    if (!fragment.is_lit) {  // glTF 2.0 §3.9.7: points and lines without normals
        out.radiance += point.color;
        return out;
    }

    RasterSurface::Place place{.position = fragment.position,
                               .wo = towards_viewer(fragment.position),
                               .film = fragment.film,
                               .scale = fragment.scale,
                               .front = fragment.front};
    const dvec3 normal = fragment.attributes.normal;
    const dvec3 without_face = normal == dvec3(0) ? place.wo : normalize(normal);  // points, lines, faces without area
    place.ng_file = fragment.ng == dvec3(0) ? without_face : fragment.ng;
    place.n_front = shading_normal(material, world_->textures, fragment.attributes, place.ng_file);
    const double side = fragment.front ? 1 : -1;  // (SH-3)
    place.n = side * place.n_front;
    place.ng = side * place.ng_file;
    if (has_layers(material)) {
        const RasterSurroundings around = surroundings(behind);
        const RasterSurface surface(material, point, fragment.attributes, world_->textures, place, around);
        out.radiance = surface.emission_share() * out.radiance + surface.surroundings() +
                       lights(fragment, [&](const dvec3& wi) { return surface.scatter(wi); });
    } else {
        out.radiance += shade_plain(fragment, point, place);
    }
    return out;
}

double RasterShader::lit_share(const Fragment& fragment, const PosedLight& light, const Incident& in) const
{
    if (!shadows_ || in.irradiance == dvec3(0)) return 1;
    const dvec3 ng = fragment.ng == dvec3(0) ? in.wi : fragment.ng;
    // Vertices are floats: a point extrapolated past an edge (SH-30) lies that much below a neighbour that is meant to
    // be in the same plane. A thousandth of a pixel hides it.
    const dvec3 error(1e-6 * std::abs(camera_.depth(fragment.position)));
    const dvec3 origin = offset_origin(fragment.position, error, ng, in.wi);
    const bool far = std::isinf(in.distance);
    const Ray ray{.origin = origin,
                  .direction = far ? in.wi : light.position - origin,
                  .t_max = far ? std::numeric_limits<double>::infinity() : 1};
    return world_->index.transmittance(ray, [&](const Hit& hit) {
        const Material& met = world_->posed->materials()[world_->index.shapes()[hit.shape].material];
        return met.alpha_mode == AlphaMode::blend ? 1 : 1 - opacity(*world_, ray, hit);
    });
}

template <class Scatter>
dvec3 RasterShader::lights(const Fragment& fragment, Scatter&& scatter) const  // (SH-31)
{
    dvec3 sum(0);
    const auto add = [&](const Incident& in) {
        const dvec3 f = scatter(in.wi);
        if (f != dvec3(0)) sum += f * in.irradiance;
    };
    for (const PosedLight& light : world_->posed->lights) {
        const Incident in = incident(light, fragment.position);
        const dvec3 f = scatter(in.wi);
        if (f != dvec3(0)) sum += f * in.irradiance * lit_share(fragment, light, in);
    }
    for (const RasterEmitter& emitter : emitters_)
        if (emitter.object != fragment.object) add(incident(emitter, fragment.position));
    return sum;
}

RasterSurroundings RasterShader::surroundings(const PictureBehind* behind) const
{
    const View& view = world_->posed->view;
    return {.environment = &environment_,
            .shares = &shares_,
            .camera = &camera_,
            .size = {view.width, view.height},
            .film_height = view.camera.orthographic ? 1 : std::tan(view.camera.yfov / 2),
            .behind = behind};
}

// extras.etalon's models, and all lit ones under Blinn-Phong shading.
dvec3 RasterShader::shade_plain(const Fragment& fragment, const MaterialPoint& point,
                                const RasterSurface::Place& place) const
{
    const dvec3 &n = place.n, &wo = place.wo;
    const double n_o = std::max(dot(n, wo), kSmallestCosine);
    const RasterMaterial m = raster_material(*fragment.material, point);
    dvec3 sum = lights(fragment, [&](const dvec3& wi) {
        if (!(dot(place.ng, wi) > 0)) return dvec3(0);
        return blinn_phong_ ? reflect_blinn_phong(m, n, wo, wi) : reflect_pbr(m, n, wo, wi, n_o);
    });
    if (blinn_phong_) return sum + point.occlusion * (m.diffuse + m.f0) * environment_.irradiance(n) / kPi;
    if (m.diffuse != dvec3(0)) sum += point.occlusion * m.diffuse / kPi * environment_.irradiance(n);  // (SH-33)
    if (!m.has_specular) return sum;
    const dvec3 r = normalize(dominant_reflection(wo, n, m.roughness));
    const dvec2 ab = shares_.specular(n_o, m.roughness);
    const dvec3 specular = m.is_mirror ? m.f0 : m.f0 * ab.x + ab.y;
    return sum + point.occlusion * environment_.prefiltered(r, m.roughness) * specular;  // (SH-34)
}

Shaded RasterShader::background(const dvec2& film) const
{
    if (background_ == Background::transparent) return {.radiance = dvec3(0), .alpha = 0};
    if (background_ == Background::colour) return {.radiance = background_color_, .alpha = 1};
    return {.radiance = environment_radiance(world_->posed->environment, camera_.pinhole(film).direction), .alpha = 1};
}

}  // namespace etalon::reference
