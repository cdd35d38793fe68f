#include "engine/reference/light.h"

#include <algorithm>
#include <cmath>

namespace etalon::reference {
namespace {

double mean(const dvec3& c)
{
    return (c.x + c.y + c.z) / 3;
}

double area(const Shape& s)
{
    if (s.is_sphere()) return 4 * kPi * s.p1.x * s.p1.x;
    return 0.5 * length(cross(s.p1 - s.p0, s.p2 - s.p0));
}

// Two unit vectors at right angles to unit `n` and each other (Duff et al., JCGT 6(1), 2017).
void complete_frame(const dvec3& n, dvec3& t, dvec3& b)
{
    const double sign = std::copysign(1.0, n.z);
    const double a = -1 / (sign + n.z);
    const double c = n.x * n.y * a;
    t = {1 + sign * n.x * n.x * a, sign * c, -sign * n.x};
    b = {c, sign + n.y * n.y * a, -n.y};
}

// 1 - cosθ of the cone in which a sphere is seen from distance d > r, without cancelling (S19).
double cone_height(double r, double d)
{
    const double sine2 = (r / d) * (r / d);
    return sine2 / (1 + std::sqrt(std::max(0.0, 1 - sine2)));
}

// Radiance that leaves `hit` against the ray, with what of it an observer gets where the emitter itself lets light
// through.
dvec3 emitted(const World& world, const Ray& ray, const Hit& hit)
{
    const double opaque = opacity(world, ray, hit);
    return opaque > 0 ? opaque * emission_at(world, ray, hit) : dvec3(0);
}

// Mean emission of a triangle over 16 points, one in each of its equal parts; that of a sphere, which has no texture.
double brightness(const World& world, std::uint32_t index)
{
    const Shape& shape = world.index.shapes()[index];
    const Material& m = world.material(shape);
    if (shape.is_sphere() || !m.emissive_texture.present()) return mean(m.emission);
    const Primitive& primitive = world.posed->primitive(world.posed->draws[shape.object]);
    const std::uint32_t* i = primitive.indices.data() + std::size_t{3} * shape.element;
    double sum = 0;
    for (int row = 0; row < 4; ++row)
        for (int k = 0; k < 2 * row + 1; ++k) {  // row of 2 row + 1 triangles, upright and upside down in turn
            const double third = k % 2 == 0 ? 1.0 / 3 : 2.0 / 3;
            const double b1 = (k / 2 + third) / 4, b12 = (row + (k % 2 == 0 ? 2.0 / 3 : 1.0 / 3)) / 4;
            const Attributes at = interpolate(primitive, world.frames[shape.object], {i[0], i[1], i[2]}, b1, b12 - b1);
            sum += mean(evaluate(m, world.textures, at).emission);
        }
    return sum / 16;
}

}  // namespace

double power_heuristic(double p, double q)  // (MC-3), by the ratio: squares of densities overflow (S25)
{
    if (p == 0) return 0;
    const double ratio = q / p;
    return 1 / (1 + ratio * ratio);
}

Incident incident(const PosedLight& posed, const dvec3& p)  // (SH-22)
{
    const Light& light = posed.light;
    Incident out;
    if (light.type == LightType::directional) {
        out.wi = -posed.direction;
        out.distance = std::numeric_limits<double>::infinity();
        out.irradiance = light.color * light.intensity;
        return out;
    }
    const dvec3 to_light = posed.position - p;
    out.distance = length(to_light);
    if (!(out.distance > 0)) return out;
    out.wi = to_light / out.distance;
    double attenuation = 1;
    if (light.type == LightType::spot) {
        const double scale = 1 / std::max(1e-6, std::cos(light.inner_cone) - std::cos(light.outer_cone));
        const double offset = -std::cos(light.outer_cone) * scale;
        const double inside = std::clamp(dot(posed.direction, -out.wi) * scale + offset, 0.0, 1.0);
        attenuation *= inside * inside;
    }
    if (light.range > 0) {
        const double x = out.distance / light.range;
        attenuation *= std::max(std::min(1 - x * x * x * x, 1.0), 0.0);
    }
    out.irradiance =
        light.color * (light.intensity * attenuation / out.distance / out.distance);  // no d²: it overflows (S5)
    return out;
}

AreaLights::AreaLights(const World& world) : world_(&world)
{
    const auto& shapes = world.index.shapes();
    chance_.assign(shapes.size(), 0);
    double total = 0;
    for (std::uint32_t i = 0; i < shapes.size(); ++i) {
        const Material& m = world.material(shapes[i]);
        if (m.emission == dvec3(0) || m.model == BsdfModel::unlit) continue;  // (SH-15)
        const double power = area(shapes[i]) * brightness(world, i);
        if (!(power > 0) || !std::isfinite(power)) continue;  // S20
        total += power;
        chance_[i] = power;
        shapes_.push_back(i);
        sums_.push_back(total);
    }
    for (double& c : chance_) c = total > 0 ? c / total : 0;
    for (double& s : sums_) s /= total;
}

std::optional<AreaSample> AreaLights::sample(const dvec3& p, double pick, const dvec2& u) const
{
    const auto found = std::upper_bound(sums_.begin(), sums_.end(), pick);
    const auto light = std::min(sums_.size() - 1, static_cast<std::size_t>(found - sums_.begin()));
    const std::uint32_t shape = shapes_[light];
    auto sample = world_->index.shapes()[shape].is_sphere() ? sample_sphere(shape, p, u) : sample_triangle(shape, p, u);
    if (!sample || !(sample->pdf > 0) || sample->radiance == dvec3(0)) return std::nullopt;
    sample->pdf *= chance_[shape];
    return sample;
}

std::optional<AreaSample> AreaLights::sample_triangle(std::uint32_t index, const dvec3& p, const dvec2& u) const
{
    const Shape& s = world_->index.shapes()[index];
    const double root = std::sqrt(u.x);
    Hit hit{.t = 1, .b1 = root * (1 - u.y), .b2 = root * u.y, .shape = index};
    AreaSample out{.point = s.p0 + hit.b1 * (s.p1 - s.p0) + hit.b2 * (s.p2 - s.p0), .shape = index};
    const dvec3 to_light = out.point - p;
    const double distance = length(to_light);
    if (!(distance > 0)) return std::nullopt;
    out.wi = to_light / distance;
    const double cosine = std::abs(dot(geometric_normal(s, out.point), out.wi));
    if (cosine == 0) return std::nullopt;
    out.pdf = distance / (area(s) * cosine) * distance;  // (MC-7)
    hit.t = distance;
    out.radiance = emitted(*world_, Ray{.origin = p, .direction = out.wi}, hit);
    return out;
}

std::optional<AreaSample> AreaLights::sample_sphere(std::uint32_t index, const dvec3& p, const dvec2& u) const
{
    const Shape& s = world_->index.shapes()[index];
    const double r = s.p1.x;
    const dvec3 to_center = s.p0 - p;
    const double d = length(to_center);
    AreaSample out{.shape = index};
    double distance;
    if (d > r) {  // uniform over the cone in which it is seen
        const double height = cone_height(r, d);
        const double down = u.x * height;  // 1 - cosθ
        const double cosine = 1 - down, sine2 = down * (2 - down);
        dvec3 t, b;
        const dvec3 axis = to_center / d;
        complete_frame(axis, t, b);
        const double phi = 2 * kPi * u.y, sine = std::sqrt(sine2);
        out.wi = normalize(sine * std::cos(phi) * t + sine * std::sin(phi) * b + cosine * axis);
        distance = d * cosine - std::sqrt(std::max(0.0, r * r - d * d * sine2));
        out.pdf = 1 / (2 * kPi * height);
    } else {  // from inside: uniform over the area
        const double z = 1 - 2 * u.x, phi = 2 * kPi * u.y, rim = std::sqrt(std::max(0.0, 1 - z * z));
        const dvec3 n(rim * std::cos(phi), rim * std::sin(phi), z);
        const dvec3 to_light = s.p0 + r * n - p;
        distance = length(to_light);
        if (!(distance > 0)) return std::nullopt;
        out.wi = to_light / distance;
        const double cosine = std::abs(dot(n, out.wi));
        if (cosine == 0) return std::nullopt;
        out.pdf = distance * distance / (area(s) * cosine);
    }
    out.point = p + distance * out.wi;
    out.radiance = emitted(*world_, Ray{.origin = p, .direction = out.wi}, Hit{.t = distance, .shape = index});
    return out;
}

double AreaLights::pdf(const dvec3& p, const Ray& ray, const Hit& hit) const
{
    const double chance = chance_[hit.shape];
    if (chance == 0) return 0;
    const Shape& s = world_->index.shapes()[hit.shape];
    if (s.is_sphere()) {
        const double d = length(s.p0 - p);
        if (d > s.p1.x) return chance / (2 * kPi * cone_height(s.p1.x, d));
    }
    const dvec3 point = ray.origin + hit.t * ray.direction;
    const double cosine = std::abs(dot(geometric_normal(s, point), ray.direction));
    return cosine > 0 ? chance * hit.t / (area(s) * cosine) * hit.t : 0;
}

}  // namespace etalon::reference
