#pragma once
#include <cstdint>
#include <string>

#include "engine/gpu/device.h"
#include "engine/image/film.h"
#include "engine/measure/compare.h"
#include "engine/scene/scene.h"

namespace etalon::agree {

/// A picture to be made of a scene by both path tracers.
struct Shot {
    ivec2 size{64, 64};
    std::uint64_t spp = 128;
    int max_depth = 6;
    std::uint64_t seed = 11;
};

/// The reference adds 1000 to the seed: with one seed the two would share random numbers, and the test would have no
/// meaning.
Film by_vulkan(gpu::Device& device, const Scene& scene, const Shot& shot);
Film by_reference(const Scene& scene, const Shot& shot);

/// How often all of tests/agree/path together would raise a false alarm, and each of its comparisons.
inline constexpr double kFalseAlarm = 1e-3;
inline constexpr int kComparisons = 50;
CompareSettings settings();

/// Prints what was found, the power, and records both; fails unless indistinguishable and able to find `must_find` of
/// the whole.
void expect_agreement(const std::string& what, const Film& vulkan, const Film& reference, double must_find,
                      const CompareSettings& how = settings());

}  // namespace etalon::agree
