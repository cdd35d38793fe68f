#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "engine/scene/requirements.h"

namespace etalon {

/// True where no pixel of `view` can show anything of the box low … high in object space: it lies behind the eye, or
/// beyond one side of the picture by more than a pixel. False where that cannot be told.
bool is_outside(const View& view, const dmat4& world_from_object, const vec3& low, const vec3& high);

/// The first mip level of an image that a picture can read, where that is not the whole image.
struct UnreadLevels {
    Index image = 0;
    std::string pointer;  ///< of the first place that reads it: "/materials/3/normalTexture"
    int first = 0;
    std::uint64_t bytes = 0;  ///< of the levels before it, RGBA of 16 bits a channel
};

/// What a rasterized picture from this one view does not read of its scene. What is unseen may still cast shadows and
/// light.
struct Unseen {
    std::size_t draws = 0;  ///< outside the view
    std::uint64_t triangles = 0;
    std::vector<UnreadLevels> levels;
};

/// Levels by a bound from below: over a triangle at least as far as z, a pixel covers at least (z · its angle)² cos θ
/// of the surface, and so many texels as that has; the coarser direction of a footprint, which decides the level
/// (TX-2), is at least the root of them. Anisotropic look-ups read up to log2(probes) levels finer.
Unseen find_unseen(const PosedScene& posed, const Requirements& required, const RenderSettings& settings);

}  // namespace etalon
