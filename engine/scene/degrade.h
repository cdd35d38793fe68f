#pragma once
#include <cstdint>
#include <string>

#include "engine/math/types.h"
#include "engine/scene/footprint.h"
#include "engine/scene/scene.h"

namespace etalon {

/// What a run gives up so that it fits into the memory it may have: how often both sides are halved.
struct Degradation {
    int textures = 0;  ///< of every texture
    int picture = 0;
    bool any() const { return textures > 0 || picture > 0; }
};

/// The least of it under which `need`, for a picture of `size`, is at most `memory` bytes: what takes more, textures
/// or picture, is halved first. Throws Error(machine) where program and geometry alone are too much.
Degradation plan_degradation(const Footprint& need, ivec2 size, std::uint64_t memory);

/// `size` halved so often, at least 1 a side.
ivec2 halved(ivec2 size, int times);

/// Halves every image `times` times: each texel is the area average of those it covers, colours in linear light.
/// Returns how far that changed the texels: the RMS difference of linear RGB over all of them, relative to their mean;
/// 0 where nothing changed. In place, a row at a time.
double halve_images(Scene& scene, int times);

}  // namespace etalon
