#pragma once
#include <array>

#include "engine/scene/scene.h"

namespace etalon {

/// About the mean radiance (of the three channels) that a triangle with texture coordinates `uv` emits: the emission,
/// times the emissive texture at points spread over the triangle. Decides only how often it is sampled: where it is 0
/// although some point emits, that light is found by the BSDF's samples alone.
double mean_emission(const Scene& scene, const Material& material, const std::array<vec2, 3>& uv);

}  // namespace etalon
