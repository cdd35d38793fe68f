#include "engine/math/stats.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "engine/base/error.h"
#include "engine/math/types.h"

namespace etalon {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
/// Stands in for a zero denominator of a continued fraction (Lentz 1976).
constexpr double kTiny = 1e-300;

/// ln Γ(x), x > 0. Not std::lgamma, which writes the global signgam.
double log_gamma(double x)
{
    int sign = 0;
    return ::lgamma_r(x, &sign);
}

/// ln B(a, b). Where one argument is large the three log-gammas cancel, so their difference comes from Stirling's
/// series.
double log_beta(double a, double b)
{
    const double small = std::min(a, b);
    const double large = std::max(a, b);
    if (large < 50) return log_gamma(a) + log_gamma(b) - log_gamma(a + b);
    const auto stirling = [](double x) { return (1 - (1 / 30.0 - 1 / (105 * x * x)) / (x * x)) / (12 * x); };
    // ln Γ(large) - ln Γ(large + small), x ln x - x + ½ ln(2π/x) + series, subtracted term by term.
    const double sum = large + small;
    const double difference =
        -(large - 0.5) * std::log1p(small / large) - small * std::log(sum) + small + stirling(large) - stirling(sum);
    return log_gamma(small) + difference;
}

double lentz_step(double& c, double& d, double coefficient)
{
    d = 1 + coefficient * d;
    d = 1 / (std::abs(d) < kTiny ? kTiny : d);
    c = 1 + coefficient / c;
    if (std::abs(c) < kTiny) c = kTiny;
    return c * d;
}

/// ln I_x(a, b) where x is left of the mode, by the continued fraction of DiDonato & Morris (Abramowitz &
/// Stegun 26.5.8).
double log_beta_fraction(double a, double b, double log_x, double log_y, double x)
{
    double c = 1;
    double d = 1 / std::max(std::abs(1 - (a + b) * x / (a + 1)), kTiny);
    double fraction = d;
    for (int m = 1; m < 100000; ++m) {
        fraction *= lentz_step(c, d, m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m)));
        const double step = lentz_step(c, d, -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1)));
        fraction *= step;
        if (std::abs(step - 1) < 2 * kEpsilon) break;
    }
    return a * log_x + b * log_y - log_beta(a, b) - std::log(a) + std::log(fraction);
}

/// ln of the regularized incomplete beta function I_x(a, b), given x and y = 1 - x with their logarithms, since either
/// may be too near 1 to tell the other.
double log_incomplete_beta(double a, double b, double x, double y, double log_x, double log_y)
{
    if (std::isinf(log_x)) return -kInfinity;
    if (y <= 0) return 0;
    if (x < (a + 1) / (a + b + 2)) return std::min(0.0, log_beta_fraction(a, b, log_x, log_y, x));
    const double log_rest = std::min(0.0, log_beta_fraction(b, a, log_y, log_x, y));
    return std::log1p(-std::exp(log_rest));
}

double incomplete_beta(double a, double b, double x)
{
    return std::exp(log_incomplete_beta(a, b, x, 1 - x, std::log(x), std::log1p(-x)));
}

/// Q(a, x) = Γ(a, x)/Γ(a): series below the mode, continued fraction above (Abramowitz & Stegun 6.5.29, 6.5.31).
double upper_gamma(double a, double x)
{
    const double log_front = a * std::log(x) - x - log_gamma(a);
    if (x < a + 1) {
        double term = 1 / a;
        double sum = term;
        for (int n = 1; n < 100000 && term > sum * kEpsilon; ++n) {
            term *= x / (a + n);
            sum += term;
        }
        return 1 - sum * std::exp(log_front);
    }
    double b = x + 1 - a;
    double c = 1 / kTiny;
    double d = 1 / b;
    double fraction = d;
    for (int n = 1; n < 100000; ++n) {
        const double coefficient = -n * (n - a);
        b += 2;
        d = coefficient * d + b;
        d = 1 / (std::abs(d) < kTiny ? kTiny : d);
        c = b + coefficient / c;
        if (std::abs(c) < kTiny) c = kTiny;
        fraction *= c * d;
        if (std::abs(c * d - 1) < 2 * kEpsilon) break;
    }
    return std::exp(log_front) * fraction;
}

/// The x in [low, high] at which the rising `f` crosses 0, to the last bit or so.
template <typename F>
double bisect(double low, double high, const F& f)
{
    for (int i = 0; i < 200; ++i) {
        const double middle = low + (high - low) / 2;
        if (middle <= low || middle >= high) break;
        (f(middle) < 0 ? low : high) = middle;
    }
    return low + (high - low) / 2;
}

}  // namespace

double normal_tail(double z)
{
    // The tail magnifies what rounding does to z/√2 by z²: the rest of the product is put back to first order (4 ulp).
    constexpr double kHigh = 0.70710678118654757, kLow = -4.8336466567264567e-17;  // 1/√2
    const double x = z * kHigh;
    if (!std::isfinite(x)) return std::erfc(x) / 2;
    const double rest = std::fma(z, kHigh, -x) + z * kLow;
    return (std::erfc(x) - 2 / std::sqrt(kPi) * std::exp(-x * x) * rest) / 2;
}

double log_normal_tail(double z)
{
    if (!(z > 30)) return std::log(normal_tail(z));
    if (std::isinf(z)) return -kInfinity;
    // Mills' ratio by its asymptotic series, whose sixth term is below 1e-12 from here on.
    const double w = 1 / (z * z);
    const double series = 1 - w * (1 - 3 * w * (1 - 5 * w * (1 - 7 * w * (1 - 9 * w))));
    return -z * z / 2 - std::log(z) - std::log(2 * kPi) / 2 + std::log(series);
}

double normal_two_sided_p(double z)
{
    return 2 * normal_tail(std::abs(z));
}

double log_normal_two_sided_p(double z)
{
    return std::log(2.0) + log_normal_tail(std::abs(z));
}

double normal_quantile(double p)
{
    if (!(p >= 0 && p <= 1)) return kNaN;
    if (p > 0.5) return -normal_quantile(1 - p);
    if (p == 0) return -kInfinity;
    // Newton on ln P(Z > z), which is concave: after its first step it can only come down to the root.
    const double target = std::log(p);
    double z = 0;
    for (int i = 0; i < 60; ++i) {
        const double log_tail = log_normal_tail(z);
        const double log_density = -z * z / 2 - std::log(2 * kPi) / 2;
        const double step = (log_tail - target) / std::exp(log_density - log_tail);
        z += step;
        if (std::abs(step) <= 2 * kEpsilon * std::abs(z)) break;
    }
    return -z;
}

double student_two_sided_p(double t, double dof)
{
    return std::exp(log_student_two_sided_p(t, dof));
}

double log_student_two_sided_p(double t, double dof)
{
    if (std::isnan(t) || !(dof > 0)) return kNaN;
    if (std::isinf(dof)) return log_normal_two_sided_p(t);
    if (std::isinf(t)) return -kInfinity;
    if (t == 0) return 0;
    // Past this the fraction takes thousands of steps, and the normal tail of a corrected t errs by less (Hill 1970:
    // O(1/dof²)).
    if (dof > 1e7) return log_normal_two_sided_p(t * (1 - 1 / (4 * dof)) / std::sqrt(1 + t / dof * t / 2));
    const double q = t / dof * t;  // Inf beyond t = 1e154: then x is 0, but its logarithm still tells
    const double log_y = -std::log1p(1 / q);
    const double log_x = q < 1e300 ? -std::log1p(q) : std::log(dof) - 2 * std::log(std::abs(t));
    return log_incomplete_beta(dof / 2, 0.5, 1 / (1 + q), 1 / (1 + 1 / q), log_x, log_y);
}

double student_quantile(double p, double dof)
{
    if (!(p >= 0 && p <= 1) || !(dof > 0)) return kNaN;
    if (std::isinf(dof)) return normal_quantile(p);
    if (p > 0.5) return -student_quantile(1 - p, dof);
    if (p == 0) return -kInfinity;
    if (p == 0.5) return 0;
    const double target = std::log(2 * p);
    double high = 1;
    while (high < 1e300 && log_student_two_sided_p(high, dof) > target) high *= 2;
    return -bisect(0, high, [&](double t) { return target - log_student_two_sided_p(t, dof); });
}

double welch_dof(double variance_a, double dof_a, double variance_b, double dof_b)
{
    const double largest = std::max(variance_a, variance_b);
    if (largest == 0) return kInfinity;
    const double a = variance_a / largest;
    const double b = variance_b / largest;
    return (a + b) * (a + b) / (a * a / dof_a + b * b / dof_b);
}

double standard_score(double t, double dof)
{
    if (dof >= 30) return t;
    const double p = student_two_sided_p(t, dof);
    return p > 0 && p < 1 ? std::copysign(-normal_quantile(0.5 * p), t) : t;
}

double sidak_level(double family, double tests)
{
    assume(family >= 0 && family < 1 && tests >= 1);
    return -std::expm1(std::log1p(-family) / tests);
}

double chi_square_p(double statistic, double dof)
{
    if (std::isnan(statistic) || !(dof > 0)) return kNaN;
    if (statistic <= 0) return 1;
    if (std::isinf(statistic)) return 0;
    return std::clamp(upper_gamma(dof / 2, statistic / 2), 0.0, 1.0);
}

double ks_uniform_p(std::span<const double> values)
{
    if (values.empty()) return 1;
    std::vector<double> sorted(values.begin(), values.end());
    std::ranges::sort(sorted);
    const auto n = static_cast<double>(sorted.size());
    double distance = 0;
    for (std::size_t i = 0; i < sorted.size(); ++i) {
        const auto rank = static_cast<double>(i);
        distance = std::max({distance, sorted[i] - rank / n, (rank + 1) / n - sorted[i]});
    }
    const double lambda = (std::sqrt(n) + 0.12 + 0.11 / std::sqrt(n)) * distance;
    if (lambda < 0.2) return 1;  // the series below needs ever more terms, and the value is 1 - 5e-13
    double p = 0;
    for (int k = 1; k <= 20; ++k) p += (k % 2 == 1 ? 2 : -2) * std::exp(-2.0 * k * k * lambda * lambda);
    return std::clamp(p, 0.0, 1.0);
}

double binomial_upper_tail(std::uint64_t successes, std::uint64_t trials, double p)
{
    if (successes == 0) return 1;
    if (successes > trials || p <= 0) return 0;
    if (p >= 1) return 1;
    return incomplete_beta(static_cast<double>(successes), static_cast<double>(trials - successes) + 1, p);
}

Interval binomial_interval(std::uint64_t successes, std::uint64_t trials, double confidence)
{
    assume(successes <= trials && confidence > 0 && confidence < 1);
    const double tail = (1 - confidence) / 2;
    Interval interval{0, 1};
    if (successes > 0)
        interval.low = bisect(0, 1, [&](double p) { return binomial_upper_tail(successes, trials, p) - tail; });
    if (successes < trials)
        interval.high =
            bisect(0, 1, [&](double p) { return binomial_upper_tail(successes + 1, trials, p) - (1 - tail); });
    return interval;
}

}  // namespace etalon
