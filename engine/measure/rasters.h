#pragma once
#include <cstddef>

#include "engine/image/film.h"
#include "engine/measure/compare.h"
#include "engine/scene/pose.h"
#include "engine/scene/settings.h"

namespace etalon {

/// Bits of the fractions in which a device weighs texels and mip levels (Vulkan's subTexelPrecisionBits and
/// mipmapPrecisionBits).
struct RasterPrecision {
    unsigned subtexel_bits = 8;
    unsigned mip_bits = 8;
};

/// How far the Vulkan rasterizer may be from the reference in one pixel: relative · value + absolute · brightest value.
/// docs/testing.md (“Rasterizers”) derives it; in short:
/// - `relative`: float32 rounding of about a hundred operations, with the device's own exp2, log2, atan and inverse
/// square
///   root (5e-5), and the turn of directions by a few ulp (4e-7 rad), which a highlight of GGX width α turns into at
///   most 2/α of that (d ln D/dθ = 4θ/(θ² + α²) ≤ 2/α).
/// - `absolute`: of textured scenes; texel weights are fractions of subtexel_bits in u and v, level weights of
/// mip_bits,
///   each off by half a step, times a difference of neighbouring texels or levels of at most 1.
struct RasterBudget {
    double relative = 0;
    double absolute = 0;
};
RasterBudget raster_budget(const PosedScene& posed, const RenderSettings& settings, const RasterPrecision& precision);

/// What a comparison found.
struct RasterAgreement {
    std::size_t beyond = 0;       ///< pixels over the budget …
    std::size_t unexplained = 0;  ///< … that no snapping of vertices by 1/256 px explains
    double worst = 0;             ///< largest excess over the budget among the others: error / budget
    double mean_error = 0;        ///< |mean a − mean b| / mean b over the picture …
    double mean_budget = 0;       ///< … and how much it may be
    std::size_t pixels = 0;

    /// Nothing is unexplained, the means agree, and edge pixels are few: the perimeter of things is a few per cent of
    /// these pictures, and a few per cent of that lie within 1/256 px of a sample.
    bool holds() const { return unexplained == 0 && mean_error <= mean_budget && beyond <= pixels / 200 + 1; }
};

/// Both pictures of `posed` compared. A pixel over the budget is explained when the reference itself, with the camera
/// turned by the device's snapping distance to either side in x and y, shows in that pixel's neighbourhood a range of
/// values that holds the device's: a sample there is so near to an edge that either answer is right.
RasterAgreement compare_rasters(const PosedScene& posed, const RenderSettings& settings, const Film& device,
                                const Film& reference, const RasterBudget& budget);

/// The same as the comparison of a report: `device` drew settings with Vulkan, `reference` in double precision.
/// within_budget or over_budget, with the figures as reasons. Draws the reference up to four times more.
Comparison judge_rasters(const PosedScene& posed, const RenderSettings& settings, const RasterPrecision& precision,
                         const Film& device, const Film& reference);

}  // namespace etalon
