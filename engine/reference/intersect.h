#pragma once
#include <array>
#include <limits>
#include <optional>

#include "engine/math/types.h"

namespace etalon::reference {

/// (RT-1) p = origin + t direction, 0 < t < t_max, t in units of |direction| (any finite length above 0).
struct Ray {
    dvec3 origin{0};
    dvec3 direction{0, 0, -1};
    double t_max = std::numeric_limits<double>::infinity();
};

/// A ray as the watertight test needs it: the axis it mostly follows, and the shear that turns it onto +Z.
struct ShearedRay {
    explicit ShearedRay(const Ray& ray);
    int kx, ky, kz;     ///< axes, kz the largest of |direction|; kx and ky keep the winding
    double sx, sy, sz;  ///< shear
    dvec3 origin;
};

/// Where a ray meets a triangle: p = p0 + b1 (p1 - p0) + b2 (p2 - p0).
struct TriangleHit {
    double t;
    double b1, b2;
};

/// (RT-2) Watertight: a ray through an edge or a vertex that triangles share meets at least one of them (promise G10).
/// Nothing where the ray is parallel to the plane, or where t is not surely positive (G13). Both sides are met.
/// Woop, Benthin & Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1), 2013; error bound of t: Pharr, Jakob &
/// Humphreys, Physically Based Rendering, 4th ed., §6.8.
std::optional<TriangleHit> intersect_triangle(const ShearedRay& ray, const dvec3& p0, const dvec3& p1, const dvec3& p2);

/// Where a ray meets a sphere, in order along the ray: none, one (the other lies behind), or two.
struct SphereHits {
    int count = 0;
    std::array<double, 2> t{};
};

/// (RT-4) in the form that does not cancel far away or on huge spheres (promises G14, G15). Only 0 < t.
SphereHits intersect_sphere(const Ray& ray, const dvec3& center, double radius);

/// (RT-6) The point from which a ray along `direction` leaves a surface: `p` moved along the geometric normal, to the
/// side that `direction` points to, until it is outside the box p ± error (PBRT 4th ed., §6.8; promise G23).
dvec3 offset_origin(const dvec3& p, const dvec3& error, const dvec3& normal, const dvec3& direction);

}  // namespace etalon::reference
