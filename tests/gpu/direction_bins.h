// Draws of a sampler of directions, binned and held against its density: Pearson's chi-square.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "engine/math/stats.h"
#include "engine/math/types.h"

namespace etalon::test {

/// Bins of equal solid angle: (cosine to z, azimuth).
class DirectionBins {
 public:
    /// `wi`: unit, z up.
    template <typename Vec3>
    void add_draw(const Vec3& wi)
    {
        const double turns = std::atan2(double(wi.y), double(wi.x)) / (2 * kPi);
        ++counts_[std::size_t(bin_of((wi.z + 1) / 2) * kBins + bin_of(turns - std::floor(turns)))];
    }

    /// `expected`: draws in the cell (x, y) of a grid of `cells` x `cells`, azimuth by cosine; `cells` a multiple
    /// of 10.
    void add_expected(int x, int y, int cells, double expected)
    {
        expected_[std::size_t(y * kBins / cells * kBins + x * kBins / cells)] += expected;
    }

    /// The probability of draws at least as far from what is expected; bins that expect under ten count as one.
    double p_value() const
    {
        double statistic = 0, pooled = 0, pooled_expected = 0;
        int dof = 0;
        const auto compare = [&](double count, double expected) {
            statistic += (count - expected) * (count - expected) / expected;
            ++dof;
        };
        for (std::size_t i = 0; i < counts_.size(); ++i) {
            if (expected_[i] >= kLeastExpected) {
                compare(counts_[i], expected_[i]);
            } else {
                pooled += counts_[i];
                pooled_expected += expected_[i];
            }
        }
        if (pooled_expected >= kLeastExpected) compare(pooled, pooled_expected);
        return chi_square_p(statistic, dof);
    }

 private:
    static constexpr int kBins = 10;              // in each direction
    static constexpr double kLeastExpected = 10;  // the usual bound for the approximation to hold

    static int bin_of(double x) { return std::clamp(static_cast<int>(x * kBins), 0, kBins - 1); }

    std::vector<double> counts_ = std::vector<double>(kBins * kBins), expected_ = std::vector<double>(kBins * kBins);
};

}  // namespace etalon::test
