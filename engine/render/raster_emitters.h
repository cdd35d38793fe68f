#pragma once
#include <vector>

#include "engine/scene/pose.h"
#include "shaders/shared/raster.h"

namespace etalon {

/// An emissive draw or sphere as a rasterizer lights others with it (SH-39).
struct RasterEmitter {
    dvec3 radiance{0};     ///< nit
    double area = 0;       ///< square metres, world
    dvec3 center{0};       ///< area-weighted centroid, world
    dvec3 area_vector{0};  ///< Σ area · ng; 0 for a sphere
    bool two_sided = false;
    std::uint32_t object_id = 0;  ///< draw index + 1, spheres after draws

    /// Luminance times area: which emitters count most.
    double power() const { return (0.2126 * radiance.x + 0.7152 * radiance.y + 0.0722 * radiance.z) * area; }
};

/// The 16 most powerful emitters of a scene, or fewer; ties in object order.
std::vector<RasterEmitter> find_emitters(const PosedScene& posed);

shared::EmitterRecord pack(const RasterEmitter& emitter, const dvec3& eye);

}  // namespace etalon
