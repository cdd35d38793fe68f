#pragma once
#include <cmath>
#include <functional>

#include "engine/math/types.h"

namespace etalon::test {

/// ∫ f(direction) dω over the sphere by midpoints, closest together around the direction in which wo is mirrored and
/// the opposite one.
inline double integrate(const dvec3& wo, const std::function<double(const dvec3&)>& f)
{
    constexpr int kRings = 400, kSectors = 300;
    const dvec3 axis(-wo.x, -wo.y, wo.z);
    const dvec3 t = normalize(cross(std::abs(axis.x) > 0.5 ? dvec3(0, 1, 0) : dvec3(1, 0, 0), axis)),
                b = cross(axis, t);
    double sum = 0;
    for (int i = 0; i < kRings; ++i) {
        const double q = (i + 0.5) / kRings, theta = kPi * q * q * (3 - 2 * q);
        const double weight = std::sin(theta) * kPi * 6 * q * (1 - q) / kRings * 2 * kPi / kSectors;
        for (int j = 0; j < kSectors; ++j) {
            const double phi = 2 * kPi * (j + 0.5) / kSectors;
            sum += weight * f(std::sin(theta) * (std::cos(phi) * t + std::sin(phi) * b) + std::cos(theta) * axis);
        }
    }
    return sum;
}

}  // namespace etalon::test
