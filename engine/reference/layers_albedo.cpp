#include "engine/reference/layers_albedo.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/reference/bsdf.h"
#include "engine/reference/layers_lobes.h"

namespace etalon::reference {

const Tabulated kGgxShare{.function = ggx_share, .lowest_alpha = 1e-3, .knee = [](double alpha) { return alpha; }};
const Tabulated kSheenShare{
    .function = sheen_share, .lowest_alpha = 0.07 * 0.07, .knee = [](double alpha) { return std::sqrt(alpha); }};

namespace {
constexpr double kLeastSheenCosine = 1e-4;  // below it the fit of Λ lets E_s grow without bound
}

// The mean of G₂/G₁ over the visible normals (MC-6), which are a spherical cap's after a stretch (Dupuy & Benyoub
// 2023). Symmetric about the plane of wo: half the turns do.
double ggx_share(double cosine, double alpha)
{
    constexpr int kRings = 96, kTurns = 32;
    const double mu = std::clamp(cosine, 1e-12, 1.0);
    const dvec3 wo(std::sqrt(1 - mu * mu), 0, mu);
    const dvec3 v = normalize(dvec3(alpha * wo.x, 0, wo.z));
    const double g1 = ggx_g1(mu, alpha);
    double sum = 0;
    for (int i = 0; i < kRings; ++i) {
        const double q = (i + 0.5) / kRings;  // squared: the rim holds the tail of the distribution
        const double z = q * q * (1 + v.z) - v.z, rim = std::sqrt(std::max(0.0, 1 - z * z));
        for (int j = 0; j < kTurns; ++j) {
            const double phi = kPi * (j + 0.5) / kTurns;
            const dvec3 stretched = dvec3(rim * std::cos(phi), rim * std::sin(phi), z) + v;
            const dvec3 h = normalize(dvec3(alpha * stretched.x, alpha * stretched.y, stretched.z));
            const double mu_i = 2 * dot(wo, h) * h.z - mu;
            if (mu_i > 0) sum += 2 * q * 4 * mu * mu_i * ggx_v(mu, mu_i, alpha) / g1;
        }
    }
    return sum / (kRings * kTurns);
}

// Normals by their own distribution, unlike ggx_share: midpoint sums over its quantile and the azimuth.
double ggx_schlick_share(double cosine, double alpha)
{
    constexpr int kRings = 160, kTurns = 64;
    const double mu = std::clamp(cosine, 1e-9, 1.0);
    const dvec3 wo(std::sqrt(1 - mu * mu), 0, mu);
    double share = 0, weighed = 0;
    for (int i = 0; i < kRings; ++i) {
        // Normals by their own distribution: tan² θ = α² q/(1 - q), q uniform; here q = s² (3 - 2 s).
        const double s = (i + 0.5) / kRings, q = s * s * (3 - 2 * s);
        const double tan2 = alpha * alpha * q / (1 - q);
        const double h_z = 1 / std::sqrt(1 + tan2), h_r = std::sqrt(tan2) * h_z;
        for (int j = 0; j < kTurns; ++j) {
            const double phi = kPi * (j + 0.5) / kTurns;
            const double o_h = wo.x * h_r * std::cos(phi) + mu * h_z;
            const double mu_i = 2 * o_h * h_z - mu;
            if (!(o_h > 0) || !(mu_i > 0)) continue;
            // D n·h is the density; dwi = 4 wo·h dh.
            const double w = 6 * s * (1 - s) * ggx_v(mu, mu_i, alpha) * mu_i * 4 * o_h / h_z;
            share += w;
            weighed += w * std::pow(1 - o_h, 5);
        }
    }
    return weighed / share;
}

// ∫ D_s V_s n·wi dwi with both ends of n·wi stretched: Λ has roots of small order there.
double sheen_share(double cosine, double alpha)
{
    constexpr int kRings = 64, kTurns = 32;
    const double mu = std::clamp(cosine, kLeastSheenCosine, 1.0);
    const dvec3 wo(std::sqrt(1 - mu * mu), 0, mu);
    double sum = 0;
    for (int i = 0; i < kRings; ++i) {
        const double q = (i + 0.5) / kRings;
        const double z = q * q * (3 - 2 * q), rim = std::sqrt(1 - z * z);
        const double weight = 6 * q * (1 - q) / kRings * z * sheen_v(mu, z, alpha) * 2 * kPi / kTurns;
        for (int j = 0; j < kTurns; ++j) {
            const double phi = kPi * (j + 0.5) / kTurns;
            sum += weight * sheen_d(normalize(wo + dvec3(rim * std::cos(phi), rim * std::sin(phi), z)), alpha);
        }
    }
    return sum;
}

namespace {

// Catmull and Rom's cubic, a fraction f of the way from p[1] to p[2].
double cubic(const std::array<double, 4>& p, double f)
{
    return p[1] +
           0.5 * f *
               (p[2] - p[0] + f * (2 * p[0] - 5 * p[1] + 4 * p[2] - p[3] + f * (3 * (p[1] - p[2]) + p[3] - p[0])));
}

// `value(i)` at a fractional index between the first and the last; beyond them by the parabola through three.
template <class Value>
double interpolate(double index, int last, Value&& value)
{
    const int i = std::clamp(static_cast<int>(index), 0, last - 1);
    std::array<double, 4> p{0, value(i), value(i + 1), 0};
    p[0] = i > 0 ? value(i - 1) : 3 * p[1] - 3 * p[2] + value(i + 2);
    p[3] = i + 2 <= last ? value(i + 2) : 3 * p[2] - 3 * p[1] + value(i - 1);
    return cubic(p, index - i);
}

// 0 … 1 for a cosine. Squared, for the functions have a vertical slope at 0.
double position_of(double cosine, double knee)
{
    const double c = std::clamp(cosine, 0.0, 1.0);
    return std::sqrt(c * (1 + knee) / (c + knee));
}

double cosine_of(double position, double knee)
{
    const double x = position * position;
    return std::min(1.0, knee * x / (1 + knee - x));
}

}  // namespace

double ShareTable::row_of(double alpha) const
{
    return std::clamp(1 - std::log(alpha) / std::log(what_.lowest_alpha), 0.0, 1.0) * (kSide - 1);
}

double ShareTable::alpha_of(int row) const
{
    return std::pow(what_.lowest_alpha, 1 - static_cast<double>(row) / (kSide - 1));
}

ShareTable::ShareTable(const Tabulated& what, const dvec2& used) : what_(what)
{
    first_row_ = std::clamp(static_cast<int>(row_of(used.x)) - 1, 0, kSide - 3);
    const int last = std::clamp(static_cast<int>(row_of(used.y)) + 2, first_row_ + 2, kSide - 1);
    for (int row = first_row_; row <= last; ++row)
        for (int i = 0; i < kSide; ++i) {
            const double alpha = alpha_of(row);
            values_.push_back(what.function(cosine_of(i / (kSide - 1.0), what.knee(alpha)), alpha));
        }
}

double ShareTable::at(int row, double position) const
{
    const double* values = values_.data() + std::ptrdiff_t{kSide} * (row - first_row_);
    return interpolate(position * (kSide - 1), kSide - 1, [&](int i) { return values[i]; });
}

double ShareTable::operator()(double cosine, double alpha) const
{
    if (values_.empty()) return 1;
    const double position = position_of(cosine, what_.knee(alpha));
    return interpolate(row_of(alpha), kSide - 1, [&](int row) { return at(row, position); });
}

}  // namespace etalon::reference
