#pragma once
#include <vector>

#include "engine/geometry/bvh.h"
#include "engine/render/path_features.h"

namespace etalon {

/// Something that emits, as next-event estimation may choose it.
struct PathEmitter {
    std::uint32_t primitive = 0;  ///< position in PathGeometry::primitives
    double area = 0;              ///< m²
    double weight = 0;            ///< of being chosen: area × mean radiance × sides
};

/// A posed scene as one set of primitives, triangles and spheres, in the order of the BVH's leaves, relative to
/// `origin`. Layouts: shaders/shared/path.h.
struct PathGeometry {
    dvec3 origin{0};  ///< world, metres
    Bvh bvh;
    std::vector<uvec4> primitives;  ///< 3 a primitive
    std::vector<uvec4> attributes;  ///< PathFeatures::attribute_stride() a primitive
    std::vector<PathEmitter> emitters;
    std::size_t count = 0;       ///< primitives
    std::size_t degenerate = 0;  ///< triangles without area or with coordinates out of range: in no picture
};

/// Throws Error(machine) for more primitives than the BVH can hold (2^27).
PathGeometry make_path_geometry(const PosedScene& posed, const PathFeatures& features, const dvec3& origin,
                                unsigned threads);

/// Writes the chance of each emitter into its primitive: per area for triangles, as it is for spheres.
void set_light_density(PathGeometry& geometry, const PathEmitter& emitter, double probability);

}  // namespace etalon
