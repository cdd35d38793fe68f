#pragma once
#include "engine/image/image.h"

namespace etalon {

/// Pixels per degree of visual angle of a 0.7 m wide display of 3840 pixels seen from 0.7 m: FLIP's standard viewer.
inline constexpr double kFlipPixelsPerDegree = 0.7 * (3840 / 0.7) * 3.14159265358979323846 / 180;

/// LDR-FLIP of two display-referred pictures (3 or 4 channels of sRGB-coded values in [0, 1]; alpha is not read): how
/// visible their difference is when they are flipped in place, per pixel from 0 to 1, one channel. Andersson, Nilsson,
/// Akenine-Möller, Oskarsson, Åström, Fairchild: FLIP: A Difference Evaluator for Alternating Images (2020), with the
/// constants of the authors' program. Symmetric. Values that are not finite count as 0. Throws Error(input) when the
/// sizes differ or there is no pixel.
Image flip(const Image& reference, const Image& test, double pixels_per_degree = kFlipPixelsPerDegree);
/// Its mean: 0 for equal pictures, 1 at most.
double mean_flip(const Image& reference, const Image& test, double pixels_per_degree = kFlipPixelsPerDegree);

}  // namespace etalon
