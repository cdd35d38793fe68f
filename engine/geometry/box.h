#pragma once
#include <limits>

#include "engine/math/types.h"

namespace etalon {

/// An axis-aligned box, faces included; empty until something is added.
struct Box {
    vec3 min{std::numeric_limits<float>::infinity()};
    vec3 max{-std::numeric_limits<float>::infinity()};

    void add(const vec3& point)
    {
        min = glm::min(min, point);
        max = glm::max(max, point);
    }
    void add(const Box& box)
    {
        min = glm::min(min, box.min);
        max = glm::max(max, box.max);
    }
    bool is_empty() const { return !(min.x <= max.x && min.y <= max.y && min.z <= max.z); }
    /// Halves first, so that no finite box overflows (G22).
    vec3 center() const { return min * 0.5f + max * 0.5f; }
};

/// Half the surface area in double, in which no finite box overflows; 0 for an empty one.
inline double half_area(const Box& box)
{
    if (box.is_empty()) return 0;
    const dvec3 d = dvec3(box.max) - dvec3(box.min);
    return d.x * d.y + d.y * d.z + d.z * d.x;
}

inline bool is_finite(const Box& box)
{
    return is_finite(dvec3(box.min)) && is_finite(dvec3(box.max));
}

}  // namespace etalon
