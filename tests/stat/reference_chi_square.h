#pragma once
#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <vector>

#include "engine/math/stats.h"
#include "engine/math/types.h"

namespace etalon::test {

/// Bins of the sphere: rings about the direction in which wo is mirrored, narrow there and at the opposite, times
/// sectors.
class Bins {
 public:
    explicit Bins(const dvec3& wo) : axis_(-wo.x, -wo.y, wo.z)
    {
        t_ = normalize(cross(std::abs(axis_.x) > 0.5 ? dvec3(0, 1, 0) : dvec3(1, 0, 0), axis_));
        b_ = cross(axis_, t_);
    }
    static constexpr int kRings = 24, kSectors = 12;

    std::size_t of(const dvec3& w) const
    {
        const double theta = std::acos(std::clamp(dot(w, axis_), -1.0, 1.0));
        int ring = 0;
        while (ring + 1 < kRings && angle(ring + 1.0) <= theta) ++ring;
        const double turn = std::atan2(dot(w, b_), dot(w, t_)) / (2 * kPi);
        const int sector = std::min(kSectors - 1, static_cast<int>((turn - std::floor(turn)) * kSectors));
        return static_cast<std::size_t>(ring * kSectors + sector);
    }

    /// ∫ pdf over each bin.
    std::vector<double> integrate(const std::function<double(const dvec3&)>& pdf) const
    {
        constexpr int kSteps = 20;
        std::vector<double> out(kRings * kSectors, 0);
        for (int ring = 0; ring < kRings; ++ring)
            for (int sector = 0; sector < kSectors; ++sector)
                for (int i = 0; i < kSteps; ++i)
                    for (int j = 0; j < kSteps; ++j) {
                        const double low = angle(ring + static_cast<double>(i) / kSteps),
                                     high = angle(ring + (i + 1.0) / kSteps);
                        const double theta = 0.5 * (low + high),
                                     phi = 2 * kPi * (sector + (j + 0.5) / kSteps) / kSectors;
                        const dvec3 w =
                            std::sin(theta) * (std::cos(phi) * t_ + std::sin(phi) * b_) + std::cos(theta) * axis_;
                        out[static_cast<std::size_t>(ring * kSectors + sector)] +=
                            pdf(w) * (std::cos(low) - std::cos(high)) * 2 * kPi / kSectors / kSteps;
                    }
        return out;
    }

 private:
    static double angle(double ring)
    {
        const double q = ring / kRings;
        return kPi * q * q * (3 - 2 * q);
    }
    dvec3 axis_, t_, b_;
};

/// p-value of the draws of a sampler (nothing: dropped) against its own density.
inline double chi_square(const Bins& bins, const std::function<std::optional<dvec3>()>& draw,
                         const std::function<double(const dvec3&)>& pdf)
{
    constexpr int kDraws = 60000;
    std::vector<double> expected = bins.integrate(pdf), counts(expected.size(), 0);
    double inside = 0, dropped = 0;
    for (double& e : expected) inside += e, e *= kDraws;
    for (int i = 0; i < kDraws; ++i) {
        if (const auto w = draw())
            counts[bins.of(*w)] += 1;
        else
            dropped += 1;
    }
    expected.push_back(std::max(0.0, 1 - inside) * kDraws);
    counts.push_back(dropped);
    double statistic = 0, rest_expected = 0, rest_count = 0;
    int cells = 0;
    const auto add = [&](double count, double e) { statistic += (count - e) * (count - e) / e, ++cells; };
    for (std::size_t i = 0; i < expected.size(); ++i) {
        if (expected[i] >= 10)
            add(counts[i], expected[i]);
        else
            rest_expected += expected[i], rest_count += counts[i];
    }
    if (rest_expected >= 10)
        add(rest_count, rest_expected);
    else if (rest_count > 40)
        return 0;  // draws where there should be none
    return chi_square_p(statistic, cells - 1);
}

}  // namespace etalon::test
