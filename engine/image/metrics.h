#pragma once
#include <cstdint>
#include <optional>

#include "engine/image/image.h"

namespace etalon {

/// How much a picture differs from a reference, in whatever values both hold (linear radiance, or coded values in [0,
/// 1]). All sums in double, compensated (K3). Where either picture has NaN or Inf, that value is left out of every sum
/// and counted.
struct Metrics {
    bool identical = false;  ///< every value has the same bits, -0 and 0 told apart
    double mse = 0;          ///< mean of (a - b)² over all values
    double rmse = 0;         ///< its root
    double relmse = 0;  ///< mean of (a - b)² / (b² + kRelativeEpsilon · s²), s = mean |b|, or mean |a| of a black b: K4
    double max_abs = 0;  ///< largest |a - b|
    double mean_a = 0;   ///< of all values
    double mean_b = 0;
    std::optional<double> psnr;     ///< dB, for a peak of `peak`; nothing where mse is 0: no number is infinite (K2)
    double ssim = 1;                ///< mean structural similarity of luminance, 1 for equal pictures, <= 1 (K1)
    std::uint64_t nonfinite_a = 0;  ///< values that are NaN or Inf
    std::uint64_t nonfinite_b = 0;
};

/// ε of relMSE, relative to the squared mean of the reference, so that scaling both pictures by 2^k changes no bit of
/// it.
inline constexpr double kRelativeEpsilon = 1e-2;

/// `a` against the reference `b`. `peak`: the signal's range for PSNR and SSIM (1 for coded values); 0: the range of
/// b's values, or 1 if none. Throws Error(input) when width, height or channel count differ, or when there is no pixel.
Metrics measure_difference(const Image& a, const Image& b, double peak = 1);

/// Mean SSIM of two pictures of one channel (Wang et al. 2004: 11x11 Gaussian window of σ 1.5, K1 0.01, K2 0.03),
/// centred two-pass moments in double. Windows are cut off and renormalized at the border. Values that are not finite
/// count as 0.
double structural_similarity(const Image& a, const Image& b, double peak);

/// False colours of Σ over channels of |a - b|, `full_scale` and above at the bright end (black, blue, magenta, orange,
/// yellow, white: luminance rises all the way, so it reads in grey too). Not finite on either side: green. 3 channels,
/// display-referred.
Image difference_picture(const Image& a, const Image& b, double full_scale);

/// Signed differences of the means over channels: red where a is brighter, blue where b is, white where equal;
/// saturates at ±full_scale.
Image signed_difference_picture(const Image& a, const Image& b, double full_scale);

}  // namespace etalon
