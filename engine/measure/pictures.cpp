#include <algorithm>
#include <cmath>

#include "engine/base/error.h"
#include "engine/image/metrics.h"
#include "engine/math/stats.h"
#include "engine/measure/compare.h"

namespace etalon {
namespace {

double sum(const vec3& v)
{
    return double(v.x) + double(v.y) + double(v.z);
}
double magnitude(const vec3& v)
{
    return std::abs(double(v.x)) + std::abs(double(v.y)) + std::abs(double(v.z));
}
double distance(const vec3& a, const vec3& b)
{
    return std::abs(double(a.x) - double(b.x)) + std::abs(double(a.y) - double(b.y)) +
           std::abs(double(a.z) - double(b.z));
}

double mean_magnitude(const Film& a, const Film& b)
{
    double total = 0;
    for (std::size_t i = 0; i < a.mean.size(); ++i) {
        const double both = 0.5 * (magnitude(a.mean[i]) + magnitude(b.mean[i]));
        if (std::isfinite(both)) total += both;
    }
    return total / static_cast<double>(std::max<std::size_t>(a.mean.size(), 1));
}

}  // namespace

Image relative_difference_picture(const Film& a, const Film& b)
{
    assume(a.width == b.width && a.height == b.height);
    constexpr double kDecades = 4;
    const double floor = 0.01 * mean_magnitude(a, b);
    Image level(a.width, a.height, 1);
    for (std::size_t i = 0; i < a.mean.size(); ++i) {
        const double difference = distance(a.mean[i], b.mean[i]);
        const double relative =
            difference == 0 ? 0 : difference / (0.5 * (magnitude(a.mean[i]) + magnitude(b.mean[i])) + floor);
        level.values[i] =
            static_cast<float>(relative > 0 ? std::max(0.0, 1 + std::log10(relative) / kDecades) : relative);
    }
    return difference_picture(level, Image(a.width, a.height, 1), 1);
}

Image z_picture(const Film& a, const Film& b, double rounding)
{
    assume(a.width == b.width && a.height == b.height && !a.variance.empty() && !b.variance.empty());
    Image z(a.width, a.height, 1);
    for (std::size_t i = 0; i < a.mean.size(); ++i) {
        double error = 0;
        for (int c = 0; c < 3; ++c) error += std::sqrt(double(a.variance[i][c]) + double(b.variance[i][c]));
        const double dof =
            welch_dof(sum(a.variance[i]), a.degrees_of_freedom(i), sum(b.variance[i]), b.degrees_of_freedom(i));
        error += rounding * std::max(magnitude(a.mean[i]), magnitude(b.mean[i]));
        const double difference = sum(a.mean[i]) - sum(b.mean[i]);
        z.values[i] = static_cast<float>(difference == 0 ? 0 : standard_score(difference / error, dof));
    }
    return signed_difference_picture(z, Image(a.width, a.height, 1), 4);
}

}  // namespace etalon
