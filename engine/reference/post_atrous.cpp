#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/reference/post_parts.h"

namespace etalon::reference {
namespace {

constexpr double kSpline[] = {3.0 / 8, 1.0 / 4, 1.0 / 16};  // B3, by distance

/// A difference in widths; of width 0 only equals are alike.
double in_widths(double difference, double width)
{
    return difference / std::max(width, 1e-18);
}

double squared(double x)
{
    return x * x;
}

struct Level {
    int step = 1;
    double sigma_c = 0, sigma_n = 0, sigma_z = 0, sigma_a = 0;
};

/// One level's view of the picture: how unlike two pixels are (IP-10).
class Likeness {
 public:
    Likeness(const PostPicture& picture, const std::vector<double>& variance, const Level& level)
        : picture_(picture), variance_(variance), level_(level)
    {}

    /// Of pixels p and q, places in the picture, `distance` pixels apart: the exponent of the weight.
    double exponent(std::size_t p, std::size_t q, double distance, double deviation) const
    {
        const Aovs& aovs = *picture_.aovs;
        return colour(p, q, deviation) +
               squared(in_widths(length(dvec3(aovs.normal[q]) - dvec3(aovs.normal[p])), level_.sigma_n)) +
               squared(in_widths(length(dvec3(aovs.albedo[q]) - dvec3(aovs.albedo[p])), level_.sigma_a)) +
               depth(aovs.depth[p], aovs.depth[q], distance);
    }

    /// The standard deviation of luminance about a pixel.
    double deviation(int x, int y) const
    {
        if (variance_.empty()) return 1;
        double sum = 0;
        for (int dy = -1; dy <= 1; ++dy)
            for (int dx = -1; dx <= 1; ++dx)
                sum += variance_[picture_.nearest(x + dx, y + dy)] / ((1 << std::abs(dx)) * (1 << std::abs(dy)) * 4);
        return std::sqrt(sum);
    }

 private:
    double colour(std::size_t p, std::size_t q, double deviation) const
    {
        const dvec4 a = picture_.pixels[p], b = picture_.pixels[q];
        if (variance_.empty()) return squared(in_widths(length(dvec3(b) - dvec3(a)), level_.sigma_c));
        const double d = in_widths(std::abs(luminance(b) - luminance(a)), level_.sigma_c);
        return d == 0 ? 0 : d / deviation;
    }

    double depth(double a, double b, double distance) const
    {
        if (a == b) return 0;
        if (!std::isfinite(a) || !std::isfinite(b))
            return std::isinf(level_.sigma_z) ? 0 : std::numeric_limits<double>::infinity();
        return squared(in_widths((b - a) / (a * distance), level_.sigma_z));
    }

    const PostPicture& picture_;
    const std::vector<double>& variance_;  // of luminance; empty: not guided
    Level level_;
};

/// Of luminance, as if the channels varied together.
std::vector<double> variance_of_luminance(const PostPicture& picture)
{
    std::vector<double> variance;
    for (const dvec3& channels : picture.variance) {
        const dvec3 deviation = glm::sqrt(glm::max(channels, dvec3(0)));
        variance.push_back(etalon::is_finite(channels) ? squared(luminance(dvec4(deviation, 0))) : 0);
    }
    return variance;
}

void filter(PostPicture& picture, std::vector<double>& variance, const Level& level)
{
    const std::vector<double> before = variance;
    replace_each(picture, [&](const PostPicture& from, int x, int y) {
        const Likeness likeness(from, before, level);
        const std::size_t own = from.index(x, y);
        const double deviation = likeness.deviation(x, y);
        dvec4 sum(0);
        double weights = 0, variances = 0;
        for (int dy = -2; dy <= 2; ++dy)
            for (int dx = -2; dx <= 2; ++dx) {
                const std::size_t there = from.nearest(x + level.step * dx, y + level.step * dy);
                if (!is_finite(from.pixels[there])) continue;
                const double distance = level.step * std::hypot(double(dx), double(dy));
                const double unlike = distance == 0 ? 0 : likeness.exponent(own, there, distance, deviation);
                const double w = kSpline[std::abs(dx)] * kSpline[std::abs(dy)] * std::exp(-unlike);
                if (!(w > 0)) continue;
                sum += w * from.pixels[there];
                weights += w;
                if (!before.empty()) variances += w * w * before[there];
            }
        if (!before.empty()) variance[own] = variances / (weights * weights);
        return sum / weights;
    });
}

}  // namespace

void atrous(PostPicture& picture, const PostStage& stage)
{
    std::vector<double> variance = variance_of_luminance(picture);
    for (int i = 0; i < int(stage["levels"]); ++i) {
        const double sigma_c = stage["sigma_c"] * (variance.empty() ? std::exp2(-i) : 1);
        filter(picture, variance,
               {.step = 1 << i,
                .sigma_c = sigma_c,
                .sigma_n = stage["sigma_n"],
                .sigma_z = stage["sigma_z"],
                .sigma_a = stage["sigma_a"]});
    }
}

}  // namespace etalon::reference
