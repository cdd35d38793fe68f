#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/image/film.h"
#include "engine/image/image.h"

namespace etalon {

/// How far two pictures are apart, whatever the cause. Over all pixels and channels of linear radiance [nit] where both
/// sides are finite; SSIM and PSNR are of the developed pictures (exposure 0, clamp, sRGB), so 1 is their full range.
struct PictureMetrics {
    bool identical = false;      ///< every value bit for bit alike
    double rmse = 0;             ///< nit
    double relmse = 0;           ///< mean of (a - b)^2 / (b^2 + 0.01 mean(b)^2): the scale cancels (NUMERICS K4)
    std::optional<double> psnr;  ///< dB; nothing when the developed pictures are identical
    double ssim = 1;
    double flip = 0;           ///< mean FLIP of the developed pictures (engine/image/flip.h): 0 equal, 1 at most
    double max = 0;            ///< largest |a - b|, nit
    double mean_relative = 0;  ///< mean |a - b| / mean (|a| + |b|)/2
    double alpha_max = 0;      ///< largest difference of coverage
};

/// Limits for a verdict where no error was measured; each absent one is not asked.
struct Budgets {
    std::optional<double> rmse;
    std::optional<double> relmse;
    std::optional<double> psnr;  ///< at least
    std::optional<double> ssim;  ///< at least
    std::optional<double> flip;
    std::optional<double> max;
    std::optional<double> mean_relative;
    bool any() const { return rmse || relmse || psnr || ssim || flip || max || mean_relative; }
};

/// The rounding to allow between a float device and double precision: a device's exp2 and log2 (sRGB decoding),
/// division and square root are off by a few ulp each, and a path multiplies some ten of them. A hundredth of a 0.1%
/// fault.
inline constexpr double kDeviceRounding = 1e-5;

struct CompareSettings {
    double false_alarm = 1e-3;  ///< of the whole verdict: how often two equal renderers would be called different
    int tile = 16;              ///< pixels
    /// Relative difference of two sides that is rounding and not a fault; added to the standard error, fully correlated
    /// over a tile. 10^-6: float32 film values (ST-1).
    double rounding = 1e-6;
    double power = 0.9;  ///< with which probability a difference of `detectable` size is found (ST-4)
    Budgets budgets{};
};

enum class Verdict {
    not_tested,         ///< error not measured on one side and no budget asked for
    indistinguishable,  ///< no tile, and not the whole, differs at the stated false-alarm rate
    different,
    within_budget,
    over_budget,
    not_finite,  ///< NaN or Inf on either side: a finding, whatever else
};
std::string_view name(Verdict verdict);
/// False for different, over_budget and not_finite: exit code 1.
bool passed(Verdict verdict);

/// One Welch test that came out significant, or the nearest to it.
struct TileFinding {
    int x = 0, y = 0, width = 0, height = 0;  ///< pixels; the whole picture for `whole`
    int channel = 0;                          ///< 0 red, 1 green, 2 blue
    double z = 0;                             ///< (a - b) in standard errors
    double p = 1;                             ///< two-sided, of this test alone
    double relative = 0;                      ///< (a - b) / mean of both, of the tile's sums
};

/// ST-1 … ST-4. Only where both films carry variance.
struct StatisticalTest {
    double false_alarm = 0;    ///< asked for, of all tests together
    double level = 0;          ///< of each test, by Šidák (ST-3)
    std::uint64_t tests = 0;   ///< tiles × channels with something to test, + 3 whole-picture tests
    std::uint64_t failed = 0;  ///< tests with p < level
    TileFinding worst_tile{};
    std::array<TileFinding, 3> whole{};   ///< per channel
    std::vector<TileFinding> failures{};  ///< the failed tiles, smallest p first, at most 16
    double detectable_tile = 0;   ///< relative difference of the median lit tile found with probability `power` (ST-4)
    double detectable_whole = 0;  ///< the same of the whole picture, best channel
    double power = 0;

    double tile_z_std = 0;   ///< of the z of all tiles with variance; 1 when both variances are honest
    double pixel_z_std = 0;  ///< of per-pixel z where there is variance; above 1 where few samples see rare events (K6)
    double pixel_z_max = 0;  ///< largest |z|
    std::uint64_t pixel_over_bound = 0;  ///< channels with per-pixel p under the Šidák level of all of them
    std::uint64_t constant = 0;          ///< pixel channels without variance on both sides
    std::uint64_t constant_unequal = 0;  ///< … of these, those that differ by more than `rounding`
    std::array<std::uint64_t, 20> tile_p_histogram{};   ///< p of every tile test, 20 equal bins of [0, 1]
    std::array<std::uint64_t, 20> pixel_p_histogram{};  ///< p of every pixel channel with variance
    double uniformity_p = 1;  ///< Kolmogorov-Smirnov of the tile p-values against uniform, worst channel × 3
};

struct Comparison {
    PictureMetrics metrics;
    FilmCheck check_a, check_b;
    std::optional<StatisticalTest> test;
    Verdict verdict = Verdict::not_tested;
    std::vector<std::string> reasons;  ///< why the verdict: one line each, with values
};

/// Compares `a` with `b` (the one trusted more: relative metrics divide by it). Where both have variance and at least
/// two samples, by Welch's test on tiles and the whole, family-wise corrected; budgets, if any, must hold as well.
/// Throws Error(input) when the shapes differ, a film's arrays do not fit its size, or a setting is out of range.
Comparison compare(const Film& a, const Film& b, const CompareSettings& settings = {});

/// False colours of r = Σ|a - b| / (½ Σ(|a| + |b|) + 1% of the picture's mean) per pixel on a logarithmic scale from
/// 10^-4 (black) to 1 (white), in the colours of engine/image/metrics.h. 3 channels, display-referred, for write_png.
Image relative_difference_picture(const Film& a, const Film& b);
/// Per-pixel z of the channels' sum: blue where a < b, red where a > b, white where equal, saturated at ±4. Channels
/// are taken as fully correlated, so |z| is not overstated. Both films need variance.
Image z_picture(const Film& a, const Film& b, double rounding = 1e-6);

}  // namespace etalon
