#pragma once
#include <vector>

#include "engine/geometry/bvh.h"
#include "engine/render/path_features.h"
#include "engine/scene/settings.h"

namespace etalon {

/// Something that emits, as next-event estimation may choose it.
struct PathEmitter {
    std::uint32_t primitive = 0;  ///< position in PathGeometry::primitives
    double area = 0;              ///< m²
    double weight = 0;            ///< of being chosen: area × mean radiance × sides
    Box box;                      ///< relative to the origin
    dvec3 normal{0, 0, 1};        ///< unit, of a triangle's front
    bool everywhere = false;      ///< it emits to both sides, or is a sphere
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

/// Emitters as next-event estimation reads them.
struct EmitterTable {
    std::vector<uvec4> texels;  ///< an alias table by weight; of a tree a texel a leaf (its primitive), then the nodes
    std::uint32_t count = 0;    ///< entries or leaves
    bool tree = false;          ///< few emitters never make one
};
/// Also writes into every emitting primitive its place there (PrimitiveData::light_density,
/// shaders/path/scene_data.glsl).
EmitterTable emitter_table(PathGeometry& geometry, LightSelection selection);

}  // namespace etalon
