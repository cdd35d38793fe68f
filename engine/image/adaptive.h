#pragma once
#include <cstdint>
#include <vector>

#include "engine/image/film.h"

namespace etalon {

/// Which error of a picture its samples are dealt out to make small.
enum class AdaptiveGoal {
    error,   ///< the film's own: root of the mean variance over the mean radiance
    relmse,  ///< mean of variance over (radiance² + 0.01 mean²): dark parts count as much as bright ones
};

/// Pixels that get the same number of samples each.
struct SampleGroup {
    std::uint64_t samples = 0;
    std::vector<std::uint32_t> pixels;  ///< y * width + x, tile by tile
};

/// Deals out `spp` samples a pixel on average by what a pilot of the picture says (MC-11): Neyman's allocation, by
/// tiles of 8 x 8 pixels and those around them, in steps of √2, never under a quarter of `spp` (of what a pilot has not
/// met yet, such as fireflies) nor over 16 times. Even numbers; groups with more samples come first. The pilot must
/// have variance. Where it says nothing (a black picture) all pixels are alike.
std::vector<SampleGroup> plan_samples(const Film& pilot, std::uint64_t spp, AdaptiveGoal goal);

}  // namespace etalon
