#include "engine/reference/path.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/reference/layers_point.h"
#include "engine/scene/glass.h"
#include "shaders/shared/sobol.h"

namespace etalon::reference {
namespace {

// Dimensions of a path: two for the camera, then kPerVertex for each vertex.
constexpr std::uint32_t kFilm = 0, kLens = 1, kFirstVertex = 2, kPerVertex = 8;
constexpr std::uint32_t kDirection = 0, kLobeAndRoulette = 1, kAreaPoint = 2, kPicks = 3, kEnvironment = 4;
constexpr std::uint32_t kPassing = 0x80000000u;
constexpr int kFirstRoulette = 3;  // vertices that always go on: short paths carry most of the light

double max_channel(const dvec3& c)
{
    return std::max({c.x, c.y, c.z});
}
double mean(const dvec3& c)
{
    return (c.x + c.y + c.z) / 3;
}

double unit_double(std::uint32_t high, std::uint32_t low)
{
    const std::uint64_t bits = (std::uint64_t{high} << 32) | low;
    return static_cast<double>(bits >> 11) * 0x1p-53;
}

// To 32 bits, and away from the numbers that the path tracer draws with the same seed: their films must be independent.
// (splitmix64's finalizer: Steele, Lea & Flood 2014.)
std::uint32_t fold_seed(std::uint64_t seed)
{
    std::uint64_t z = seed + 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return static_cast<std::uint32_t>(z ^ (z >> 31));
}

// Light from wi that the shading normal would let in must come from the same side of the surface itself.
bool sides_agree(const Surface& s, const dvec3& wi)
{
    return (dot(s.n, wi) > 0) == (dot(s.ng, wi) > 0);
}

bool is_delta(const Surface& s)
{
    return !s.layered && s.bsdf.is_delta();
}

struct Response {
    dvec3 value{0};  // f |cosθ|
    double pdf = 0;
};

Response respond(const Surface& s, const dvec3& wo, const dvec3& wi)
{
    const dvec3 o = s.frame.local(wo), i = s.frame.local(wi);
    if (s.layered) return {evaluate(*s.layered, o, i), pdf(*s.layered, o, i)};
    if (!sides_agree(s, wi)) return {};
    return {evaluate(s.bsdf, o, i), pdf(s.bsdf, o, i)};
}

// A draw in the world's frame.
std::optional<BsdfSample> scatter(const Surface& s, const dvec3& wo, const dvec3& u)
{
    const dvec3 o = s.frame.local(wo);
    auto drawn = s.layered ? sample(*s.layered, o, u) : sample(s.bsdf, o, u);
    if (!drawn) return std::nullopt;
    drawn->wi = s.frame.world(drawn->wi);
    if (!s.layered && !sides_agree(s, drawn->wi)) return std::nullopt;
    return drawn;
}

// (SH-59) The body whose medium light from `wi` comes through, where wo's comes through `medium`; null: none.
const MaterialLayers* medium_towards(const World& world, const Surface& s, const dvec3& wi,
                                     const MaterialLayers* medium)
{
    if (!s.layered || !s.layered->body || dot(wi, s.ng) > 0) return medium;
    return s.front ? &*world.posed->materials()[s.material].layers : nullptr;
}

dvec3 through(const MaterialLayers* medium, double distance)
{
    return medium == nullptr ? dvec3(1) : absorption(*medium, distance);
}

// (SH-70) What smooth thin glass does to light on its way straight through, at a point of it.
struct Pane {
    dvec3 passed{0};     ///< T
    dvec3 reflected{0};  ///< F at the same cosine
};

Pane pane_at(const Surface& s, const dvec3& direction)
{
    const BaseReflectance::Value fresnel = s.layered->reflectance.at(std::abs(dot(s.ng, direction)));
    return {(1.0 - fresnel.hat) * s.layered->reflectance.color, fresnel.f};
}

// What a pane reflects: a microfacet that is seen, and its mirror image of wo. Nothing where that is below the surface.
std::optional<BsdfSample> mirrored(const Surface& s, const dvec3& wo, const dvec2& u)
{
    const dvec3 o = s.frame.local(wo);
    const double alpha = kSmallestMicrofacetAlpha;
    const dvec3 h = sample_visible_normal(o, alpha, u);
    const dvec3 i = 2 * dot(o, h) * h - o;
    if (!(i.z > 0)) return std::nullopt;
    const double density = ggx_d(h, alpha) * ggx_g1(o.z, alpha) / (4 * o.z);
    return BsdfSample{.wi = s.frame.world(i), .weight = evaluate(*s.layered, o, i) / density, .delta = true};
}

}  // namespace

PathRandom::PathRandom(std::uint32_t pixel, std::uint32_t sample, std::uint64_t seed, Sequence sampler)
    : pixel_(pixel), sample_(sample), seed_(fold_seed(seed)), sampler_(sampler)
{}

std::size_t PathRandom::replicates(Sequence sampler)
{
    return sampler == Sequence::sobol ? shared::kSobolReplicates : 1;
}

dvec2 PathRandom::pair(std::uint32_t dimension) const
{
    const uvec4 bits = shared::random_bits(pixel_, sample_, dimension, seed_);
    if (sampler_ == Sequence::sobol) {
        // The bits beyond the 32 of the sequence are independent: uniform within the last of its cells.
        const uvec4 even = shared::sobol_bits(pixel_, sample_, dimension, seed_);
        return {unit_double(even.x, bits.x), unit_double(even.y, bits.y)};
    }
    return {unit_double(bits.x, bits.y), unit_double(bits.z, bits.w)};
}

dvec2 PathRandom::in_pixel() const
{
    return pair(kFilm);
}

double PathRandom::of_shape(std::uint32_t segment, const Shape& shape, bool leaving) const
{
    const uvec4 mixed = shared::random_bits(shape.object, shape.element, 2 * segment + (leaving ? 1 : 0), seed_);
    const uvec4 bits = shared::random_bits(pixel_ ^ mixed.x, sample_ ^ mixed.y, kPassing + segment, mixed.z);
    return unit_double(bits.x, bits.y);
}

PathTracer::PathTracer(const PosedScene& posed, const World& world, const RenderSettings& settings, PathChoices choices)
    : posed_(&posed),
      world_(&world),
      camera_(posed.view),
      area_(world),
      environment_(posed.environment),
      choices_(choices),
      background_(settings.background),
      background_color_(settings.background_color),
      max_depth_(settings.max_depth),
      russian_roulette_(settings.russian_roulette),
      glass_shadows_(settings.glass_shadows)
{}

// (SH-23) A ray that meets nothing.
void PathTracer::leave(const Ray& ray, int depth, const dvec3& throughput, double weight, PathResult& result) const
{
    if (depth == 1) {
        result.alpha = background_ == Background::transparent ? 0 : 1;
        if (background_ == Background::colour) result.radiance = background_color_;
        if (background_ != Background::environment) return;
    }
    if (posed_->environment.is_black()) return;
    result.radiance += throughput * weight * environment_radiance(posed_->environment, ray.direction);
}

PathResult PathTracer::trace(const dvec2& film, const PathRandom& random) const
{
    PathResult result;
    if (max_depth_ < 1) return result;
    Ray ray = camera_.has_lens() ? camera_.through_lens(film, camera_.sample_aperture(random.pair(kLens)))
                                 : camera_.pinhole(film);
    dvec3 throughput(1);
    double spread = 1;  // (η_t/η_i)² so far: what refraction took from the radiance, not from the chance to matter
    bool by_delta = true;  // no light sampling competes with the ray that is traced
    double ray_pdf = 0;
    dvec3 from(0);  // where the direction was chosen: behind glass, not where the ray begins
    const MaterialLayers* medium = nullptr;
    for (int depth = 1;; ++depth) {
        const auto hit = world_->index.closest(ray, [&](const Hit& h) {
            const double opaque = opacity(*world_, ray, h);
            if (opaque == 0 || opaque == 1) return opaque == 1;
            const Shape& shape = world_->index.shapes()[h.shape];
            const bool leaving =
                shape.is_sphere() && dot(ray.origin + h.t * ray.direction - shape.p0, ray.direction) > 0;
            return random.of_shape(static_cast<std::uint32_t>(depth), shape, leaving) < opaque;
        });
        const bool alone = by_delta || !choices_.sample_lights;
        throughput *= through(medium, hit ? hit->t : std::numeric_limits<double>::infinity());
        if (throughput == dvec3(0)) return result;
        if (!hit) {
            leave(ray, depth, throughput, alone ? 1 : power_heuristic(ray_pdf, environment_.pdf(ray.direction)),
                  result);
            return result;
        }
        if (depth == 1) result.alpha = 1;
        const Surface surface = surface_at(*world_, ray, *hit);
        if (surface.emission != dvec3(0))
            result.radiance +=
                throughput * surface.emission *
                (alone ? 1
                       : power_heuristic(ray_pdf, area_.pdf(from, Ray{.origin = from, .direction = ray.direction},
                                                            Hit{.t = length(surface.position - from),
                                                                .b1 = hit->b1,
                                                                .b2 = hit->b2,
                                                                .shape = hit->shape})));
        if (surface.is_black) return result;
        if (depth == max_depth_) {
            result.truncated = true;
            return result;
        }

        const std::uint32_t dimension = kFirstVertex + kPerVertex * static_cast<std::uint32_t>(depth - 1);
        const dvec3 wo = -ray.direction;
        const dvec2 lobe = random.pair(dimension + kLobeAndRoulette);
        if (is_glass(surface.material)) {
            const Pane pane = pane_at(surface, wo);
            const double chance = max_channel(pane.passed) / (max_channel(pane.passed) + max_channel(pane.reflected));
            if (lobe.x < chance) {
                throughput *= pane.passed / chance;
                ray = Ray{.origin = offset_origin(surface.position, surface.error, surface.ng, ray.direction),
                          .direction = ray.direction};
            } else {
                const auto reflection = mirrored(surface, wo, random.pair(dimension + kDirection));
                if (!reflection || dot(reflection->wi, surface.ng) <= 0) return result;
                throughput *= reflection->weight / (1 - chance);
                by_delta = true;
                from = surface.position;
                ray = Ray{.origin = offset_origin(surface.position, surface.error, surface.ng, reflection->wi),
                          .direction = reflection->wi};
            }
            if (throughput == dvec3(0)) return result;
            continue;
        }
        if (choices_.sample_lights)
            result.radiance += throughput * direct(surface, wo, medium, random, dimension);
        else
            result.radiance += throughput * from_punctual(surface, wo, medium, random.pair(dimension + kPicks).y);

        const auto scattered = scatter(surface, wo, dvec3(random.pair(dimension + kDirection), lobe.x));
        if (!scattered) return result;
        const dvec3 wi = scattered->wi;
        throughput *= scattered->weight;
        if (throughput == dvec3(0)) return result;
        if (dot(wi, surface.ng) < 0) {
            const double ior = surface.layered ? surface.layered->relative_ior() : surface.bsdf.ior;
            spread *= ior * ior;
        }
        medium = medium_towards(*world_, surface, wi, medium);
        by_delta = scattered->delta;
        ray_pdf = scattered->pdf;
        if (russian_roulette_ && depth >= kFirstRoulette) {  // (MC-4)
            const double survive = std::clamp(3 * max_channel(throughput) * spread, 0.05, 1.0);
            if (lobe.y >= survive) return result;
            throughput /= survive;
        }
        from = surface.position;
        ray = Ray{.origin = offset_origin(surface.position, surface.error, surface.ng, wi), .direction = wi};
    }
}

// Part of the light along a ray that arrives; `light` does not shadow itself.
dvec3 PathTracer::visibility(const Ray& ray, std::uint32_t light) const
{
    dvec3 through_glass(1);
    const double passed = world_->index.transmittance(ray, [&](const Hit& hit) {
        if (hit.shape == light) return 1.0;
        const double opaque = opacity(*world_, ray, hit);
        if (opaque == 0 || !is_glass(world_->index.shapes()[hit.shape].material)) return 1 - opaque;
        const Ray unit{.origin = ray.origin, .direction = normalize(ray.direction)};
        Hit at = hit;
        at.t *= length(ray.direction);
        const Surface surface = surface_at(*world_, unit, at);
        through_glass *= pane_at(surface, unit.direction).passed;
        return 1.0;
    });
    return passed * through_glass;
}

// (SH-70) Does light go straight through?
bool PathTracer::is_glass(Index material) const
{
    return glass_shadows_ && is_smooth_thin_glass(world_->posed->materials()[material]);
}

dvec3 PathTracer::visibility(const Surface& surface, const dvec3& target, std::uint32_t light) const
{
    const dvec3 origin = offset_origin(surface.position, surface.error, surface.ng, target - surface.position);
    return visibility(Ray{.origin = origin, .direction = target - origin, .t_max = 1}, light);
}

constexpr std::uint32_t kNoShape = 0xffffffffu;

// Next-event estimation: one point of an emitter, one punctual light, one direction of the environment.
dvec3 PathTracer::direct(const Surface& surface, const dvec3& wo, const MaterialLayers* medium,
                         const PathRandom& random, std::uint32_t dimension) const
{
    if (is_delta(surface)) return dvec3(0);
    dvec3 sum(0);
    if (!area_.empty()) sum += from_area(surface, wo, medium, random, dimension);
    if (!posed_->lights.empty()) sum += from_punctual(surface, wo, medium, random.pair(dimension + kPicks).y);
    if (!environment_.empty()) sum += from_environment(surface, wo, medium, random.pair(dimension + kEnvironment));
    return sum;
}

dvec3 PathTracer::from_area(const Surface& surface, const dvec3& wo, const MaterialLayers* medium,
                            const PathRandom& random, std::uint32_t dimension) const
{
    const auto light =
        area_.sample(surface.position, random.pair(dimension + kPicks).x, random.pair(dimension + kAreaPoint));
    if (!light) return dvec3(0);
    const Response response = respond(surface, wo, light->wi);
    if (response.value == dvec3(0)) return dvec3(0);
    const dvec3 visible = visibility(surface, light->point, light->shape);
    const MaterialLayers* beyond = medium_towards(*world_, surface, light->wi, medium);
    return through(beyond, length(light->point - surface.position)) * visible *
           power_heuristic(light->pdf, response.pdf) / light->pdf * response.value * light->radiance;
}

// All punctual lights are weighed, one is chosen by what it would bring unshadowed, and one shadow ray is traced.
dvec3 PathTracer::from_punctual(const Surface& surface, const dvec3& wo, const MaterialLayers* medium,
                                double pick) const
{
    if (is_delta(surface)) return dvec3(0);
    const auto contribution = [&](const PosedLight& light, const Incident& in) {
        if (in.irradiance == dvec3(0) || light.light.intensity == 0) return dvec3(0);
        return respond(surface, wo, in.wi).value * in.irradiance *
               through(medium_towards(*world_, surface, in.wi, medium), in.distance);
    };
    double total = 0;
    for (const PosedLight& light : posed_->lights)
        total += mean(contribution(light, incident(light, surface.position)));
    if (!(total > 0)) return dvec3(0);
    double sum = 0;
    for (const PosedLight& light : posed_->lights) {
        const Incident in = incident(light, surface.position);
        const dvec3 bring = contribution(light, in);
        const double share = mean(bring);
        sum += share;
        if (share == 0 || (pick * total >= sum && &light != &posed_->lights.back())) continue;
        const dvec3 visible =
            std::isfinite(in.distance)
                ? visibility(surface, light.position, kNoShape)
                : visibility(Ray{.origin = offset_origin(surface.position, surface.error, surface.ng, in.wi),
                                 .direction = in.wi},
                             kNoShape);
        return visible * total / share * bring;
    }
    return dvec3(0);
}

dvec3 PathTracer::from_environment(const Surface& surface, const dvec3& wo, const MaterialLayers* medium,
                                   const dvec2& u) const
{
    const EnvironmentSampler::Sample light = environment_.sample(u);
    if (!(light.pdf > 0)) return dvec3(0);
    const Response response = respond(surface, wo, light.direction);
    if (response.value == dvec3(0)) return dvec3(0);
    const Ray ray{.origin = offset_origin(surface.position, surface.error, surface.ng, light.direction),
                  .direction = light.direction};
    const dvec3 visible = visibility(ray, kNoShape);
    if (visible == dvec3(0)) return dvec3(0);
    const MaterialLayers* beyond = medium_towards(*world_, surface, light.direction, medium);
    return through(beyond, std::numeric_limits<double>::infinity()) * visible *
           power_heuristic(light.pdf, response.pdf) / light.pdf * response.value *
           environment_radiance(posed_->environment, light.direction);
}

}  // namespace etalon::reference
