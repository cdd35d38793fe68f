#include "engine/reference/intersect.h"

#include <algorithm>
#include <utility>

namespace etalon::reference {
namespace {

constexpr double kUnit = std::numeric_limits<double>::epsilon() / 2;  // 2^-53

constexpr double gamma(int n)
{
    return n * kUnit / (1 - n * kUnit);
}

// a b - c d with the right sign always: Kahan's difference of products (Jeannerod, Louvet & Muller 2013).
double difference_of_products(double a, double b, double c, double d)
{
    const double cd = c * d;
    const double error = std::fma(-c, d, cd);
    return std::fma(a, b, -cd) + error;
}

// A vector whose components are picked at run time: twice as fast as asking glm for them, one of three by one.
struct Components {
    explicit Components(const dvec3& v) : of{v.x, v.y, v.z} {}
    double operator[](int axis) const { return of[static_cast<std::size_t>(axis)]; }
    std::array<double, 3> of;
};

}  // namespace

ShearedRay::ShearedRay(const Ray& ray) : origin(ray.origin)
{
    const dvec3 size = glm::abs(ray.direction);
    kz = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
    kx = (kz + 1) % 3;
    ky = (kx + 1) % 3;
    // A ray down a negative axis would see the triangle mirrored.
    if (ray.direction[kz] < 0) std::swap(kx, ky);
    sx = ray.direction[kx] / ray.direction[kz];
    sy = ray.direction[ky] / ray.direction[kz];
    sz = 1 / ray.direction[kz];
}

std::optional<TriangleHit> intersect_triangle(const ShearedRay& ray, const dvec3& p0, const dvec3& p1, const dvec3& p2)
{
    const Components a(p0 - ray.origin), b(p1 - ray.origin), c(p2 - ray.origin);
    const double ax = a[ray.kx] - ray.sx * a[ray.kz], ay = a[ray.ky] - ray.sy * a[ray.kz];
    const double bx = b[ray.kx] - ray.sx * b[ray.kz], by = b[ray.ky] - ray.sy * b[ray.kz];
    const double cx = c[ray.kx] - ray.sx * c[ray.kz], cy = c[ray.ky] - ray.sy * c[ray.kz];

    // Edge functions of the origin: exactly antisymmetric, so that neighbours never both miss.
    double u = cx * by - cy * bx;
    double v = ax * cy - ay * cx;
    double w = bx * ay - by * ax;
    if (u == 0 || v == 0 || w == 0) {  // rounding may have hidden a sign
        u = difference_of_products(cx, by, cy, bx);
        v = difference_of_products(ax, cy, ay, cx);
        w = difference_of_products(bx, ay, by, ax);
    }
    if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0)) return std::nullopt;
    const double det = u + v + w;
    if (det == 0) return std::nullopt;

    const double az = ray.sz * a[ray.kz], bz = ray.sz * b[ray.kz], cz = ray.sz * c[ray.kz];
    const double t = (u * az + v * bz + w * cz) / det;

    // t counts only above its own error: closer than that, the ray started on this plane.
    const double max_z = std::max({std::abs(az), std::abs(bz), std::abs(cz)});
    const double max_x = std::max({std::abs(ax), std::abs(bx), std::abs(cx)});
    const double max_y = std::max({std::abs(ay), std::abs(by), std::abs(cy)});
    const double delta_x = gamma(5) * (max_x + max_z), delta_y = gamma(5) * (max_y + max_z);
    const double delta_e = 2 * (gamma(2) * max_x * max_y + delta_y * max_x + delta_x * max_y);
    const double max_e = std::max({std::abs(u), std::abs(v), std::abs(w)});
    const double delta_t = 3 * (gamma(3) * max_e * max_z + delta_e * max_z + gamma(3) * max_z * max_e) / std::abs(det);
    if (!(t > delta_t)) return std::nullopt;
    return TriangleHit{.t = t, .b1 = v / det, .b2 = w / det};
}

SphereHits intersect_sphere(const Ray& ray, const dvec3& center, double radius)
{
    const dvec3 f = ray.origin - center;
    const double dd = dot(ray.direction, ray.direction);
    const double b = -dot(f, ray.direction);
    // From the ray's closest approach to the centre; b b - dd c would be all rounding far from a small sphere (G14).
    const dvec3 l = f + (b / dd) * ray.direction;
    const double discriminant = radius * radius - dot(l, l);
    if (discriminant < 0) return {};

    const double distance = length(f);
    const double c = (distance - radius) * (distance + radius);
    const double q = b + std::copysign(std::sqrt(dd * discriminant), b);
    const double t0 = q / dd;
    const double t1 = q == 0 ? 0.0 : c / q;
    SphereHits hits;
    for (const double t : {std::min(t0, t1), std::max(t0, t1)})
        if (t > 0) hits.t[static_cast<std::size_t>(hits.count++)] = t;
    return hits;
}

dvec3 offset_origin(const dvec3& p, const dvec3& error, const dvec3& normal, const dvec3& direction)
{
    const double distance = dot(glm::abs(normal), error);
    const dvec3 offset = dot(direction, normal) < 0 ? -distance * normal : distance * normal;
    dvec3 origin = p + offset;
    // The addition rounds to nearest: step once more, away from the surface.
    for (int i = 0; i < 3; ++i) {
        const double inf = std::numeric_limits<double>::infinity();
        if (offset[i] > 0) origin[i] = std::nextafter(origin[i], inf);
        if (offset[i] < 0) origin[i] = std::nextafter(origin[i], -inf);
    }
    return origin;
}

}  // namespace etalon::reference
