#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <string>

#include "engine/image/film.h"
#include "engine/scene/scene.h"

namespace etalon {

// What holds of a path tracer on any scene, beside the relations of engine/measure/relations.h.

struct Invariant {
    bool holds = false;
    std::string why;  ///< the figure, with its interval
};

/// A picture of so many samples a pixel, each time with other random numbers.
using DrawCall = std::function<Film(std::uint64_t samples)>;

inline constexpr std::array<std::uint64_t, 3> kSlopeSamples = {4, 16, 64};

/// R21: the root mean square of half the difference of two independent pictures falls as the square root of the
/// samples. A line through the logarithms at kSlopeSamples, weighted by the scatter over tiles; it holds when -1/2 is
/// within the interval that is missed with probability `false_alarm`. Rare bright paths widen it.
Invariant error_slope(const DrawCall& draw, double false_alarm);

inline constexpr int kFurnaceDepth = 64;
inline constexpr std::uint64_t kFurnaceSamples = 64;

/// Spheres that lose no light (diffuse, mirror, glass, metals of roughness 0 to 1) in light of 1 nit from everywhere:
/// nothing can be seen of them. The glTF model of dielectrics is not among them, as it does not keep energy at grazing
/// angles (docs/numerics.md).
Scene furnace_scene();
/// R22: the film of furnace_scene() against 1 nit everywhere, by Welch's test on tiles; 0.2% is left to the tables of
/// directional albedo.
Invariant judge_furnace(const Film& film, double false_alarm);

}  // namespace etalon
