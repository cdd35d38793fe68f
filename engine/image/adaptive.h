#pragma once
#include <cstdint>
#include <span>
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
    std::uint64_t samples = 0;          ///< besides the pilot's
    std::vector<std::uint32_t> pixels;  ///< y * width + x, tile by tile
};

/// Deals out `spp` samples a pixel on average, those of a pilot of the picture among them, by what that says (MC-11):
/// Neyman's allocation, by tiles of 8 x 8 pixels and those around them, in steps of √2, never under a quarter of `spp`
/// (of what a pilot has not met yet, such as fireflies) nor over 16 times. What a pixel gets is decided by the pixels
/// of the other colour of a chessboard alone, so that its own pilot knows nothing of it and may be part of its mean.
/// Even numbers; groups with more samples come first. The pilot must have variance and at most `spp` samples. Where it
/// says nothing (a black picture) all pixels are alike.
std::vector<SampleGroup> plan_samples(const Film& pilot, std::uint64_t spp, AdaptiveGoal goal);

/// Puts `part`, a film of one row of just these pixels with other random numbers, together with what `film` has of
/// them, each weighed by its number of samples. Film::counts must be there.
void add_samples(Film& film, const Film& part, std::span<const std::uint32_t> pixels);

}  // namespace etalon
