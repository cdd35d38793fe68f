#include "engine/reference/raster_filter.h"

#include <cmath>
#include <vector>

#include "engine/base/error.h"

namespace etalon::reference {
namespace {

// (AA-2) at x pixels from a pixel's centre; 0 beyond the filter's radius.
double weight(PixelFilter filter, double x)
{
    const double d = std::abs(x);
    switch (filter) {
        case PixelFilter::box:
            return d < 0.5 ? 1 : 0;
        case PixelFilter::tent:
            return std::max(0.0, 1 - d);
        case PixelFilter::gaussian: {
            constexpr double kSigma = 0.5;
            return d < 2 ? std::exp(-d * d / (2 * kSigma * kSigma)) : 0;
        }
        case PixelFilter::blackman_harris: {
            if (d >= 1.5) return 0;
            // As a window over [0, 1], 0 at both ends.
            const double phase = 2 * kPi * (d + 1.5) / 3;
            return 0.35875 - 0.48829 * std::cos(phase) + 0.14128 * std::cos(2 * phase) - 0.01168 * std::cos(3 * phase);
        }
    }
    assume(false);
    return 0;
}

struct Tap {
    int index;
    double weight;
};

// The drawn pixels along one axis that each pixel is made of; weights add up to 1.
std::vector<std::vector<Tap>> taps(int count, int per_side, PixelFilter filter)
{
    std::vector<std::vector<Tap>> all(static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i) {
        std::vector<Tap>& own = all[static_cast<std::size_t>(i)];
        double sum = 0;
        for (int j = std::max(0, (i - 2) * per_side); j < std::min(count, i + 3) * per_side; ++j) {
            const double w = weight(filter, (j + 0.5) / per_side - (i + 0.5));
            if (w == 0) continue;
            own.push_back({j, w});
            sum += w;
        }
        for (Tap& tap : own) tap.weight /= sum;
    }
    return all;
}

}  // namespace

Film reconstruct(const Film& drawn, ivec2 size, int per_side, PixelFilter filter)
{
    assume(drawn.width == size.x * per_side && drawn.height == size.y * per_side);
    Film film;
    film.width = size.x;
    film.height = size.y;
    film.samples = drawn.samples * static_cast<std::uint64_t>(per_side) * static_cast<std::uint64_t>(per_side);
    const auto columns = taps(size.x, per_side, filter), rows = taps(size.y, per_side, filter);
    for (const auto& row : rows)
        for (const auto& column : columns) {
            dvec4 sum(0);
            for (const Tap& y : row)
                for (const Tap& x : column) {
                    const auto at = static_cast<std::size_t>(y.index) * static_cast<std::size_t>(drawn.width) +
                                    static_cast<std::size_t>(x.index);
                    sum += y.weight * x.weight * dvec4(dvec3(drawn.mean[at]), static_cast<double>(drawn.alpha[at]));
                }
            film.mean.emplace_back(dvec3(sum));
            film.alpha.push_back(static_cast<float>(sum.w));
            if (!is_finite(dvec3(sum))) ++film.nonfinite;
        }
    return film;
}

}  // namespace etalon::reference
