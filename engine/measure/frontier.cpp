#include "engine/measure/frontier.h"

#include <algorithm>
#include <cmath>

#include "engine/base/error.h"
#include "engine/image/metrics.h"
#include "engine/math/stats.h"

namespace etalon {

double Timing::median() const
{
    if (seconds.empty()) return 0;
    std::vector<double> sorted = seconds;
    std::sort(sorted.begin(), sorted.end());
    const std::size_t half = sorted.size() / 2;
    return sorted.size() % 2 == 1 ? sorted[half] : 0.5 * (sorted[half - 1] + sorted[half]);
}

MedianInterval median_interval(std::span<const double> values, double confidence)
{
    assume(!values.empty());
    std::vector<double> sorted(values.begin(), values.end());
    std::sort(sorted.begin(), sorted.end());
    const std::size_t n = sorted.size();
    // The k-th smallest and the k-th largest hold the median between them with 1 - 2 P(X < k), X binomial (n, 1/2).
    const auto covered = [n](std::size_t k) { return 2 * binomial_upper_tail(k, n, 0.5) - 1; };
    std::size_t k = 1;
    while (k + 1 <= n / 2 && covered(k + 1) >= confidence) ++k;
    return {.low = sorted[k - 1], .high = sorted[n - k], .confidence = n == 1 ? 0 : covered(k)};
}

ErrorMeasurement measure_error(const Film& film, const Film& reference)
{
    if (film.width != reference.width || film.height != reference.height)
        throw Error(Blame::input, "picture and reference have different sizes");
    if (reference.variance.empty()) throw Error(Blame::input, "the reference does not say its own error");
    double mean = 0;
    for (const vec3& value : reference.mean) mean += (double(value.x) + value.y + value.z) / 3;
    mean /= static_cast<double>(reference.mean.size());
    const double floor = kRelativeEpsilon * mean * mean;

    double raw = 0, noise = 0, scatter = 0;
    std::size_t count = 0;
    for (std::size_t i = 0; i < reference.mean.size(); ++i) {
        for (int c = 0; c < 3; ++c) {
            const double b = reference.mean[i][c];
            const double v = reference.variance[i][c];
            const double d = double(film.mean[i][c]) - b;
            const double scale = b * b + floor;
            if (!std::isfinite(d) || !std::isfinite(v) || scale == 0) continue;
            ++count;
            // f(b) = (a - b)² / (b² + floor) and its derivatives: b is in the denominator as well.
            const double g = 1 / scale;
            const double g1 = -2 * b * g * g;
            const double g2 = -2 * g * g + 8 * b * b * g * g * g;
            const double f1 = -2 * d * g + d * d * g1;
            const double f2 = 2 * g - 4 * d * g1 + d * d * g2;
            raw += d * d * g;
            noise += 0.5 * f2 * v;
            scatter += std::max(f1 * f1 - f2 * f2 * v, 0.0) * v + 0.5 * f2 * f2 * v * v;
        }
    }
    if (count == 0) return {};
    const double n = static_cast<double>(count);
    return {
        .relmse = (raw - noise) / n, .deviation = std::sqrt(scatter) / n, .reference_share = noise / n, .pictures = 1};
}

ErrorMeasurement mean_error(std::span<const ErrorMeasurement> pictures)
{
    assume(!pictures.empty());
    const double n = static_cast<double>(pictures.size());
    ErrorMeasurement out{.pictures = pictures.size()};
    for (const ErrorMeasurement& one : pictures) {
        out.relmse += one.relmse / n;
        out.deviation += one.deviation / n;
        out.reference_share += one.reference_share / n;
    }
    if (pictures.size() < 2) return out;
    double squares = 0;
    for (const ErrorMeasurement& one : pictures) squares += (one.relmse - out.relmse) * (one.relmse - out.relmse);
    out.deviation = std::hypot(out.deviation, std::sqrt(squares / (n - 1) / n));
    return out;
}

std::vector<std::size_t> times_beaten(std::span<const CostAndError> points)
{
    std::vector<std::size_t> beaten(points.size(), 0);
    for (std::size_t i = 0; i < points.size(); ++i)
        for (const CostAndError& other : points)
            if (other.seconds <= points[i].seconds && other.error <= points[i].error &&
                (other.seconds < points[i].seconds || other.error < points[i].error))
                ++beaten[i];
    return beaten;
}

}  // namespace etalon
