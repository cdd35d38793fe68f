#include "engine/math/robust.h"

namespace etalon {
namespace {

/// The exponent k for which 2^-k v has its largest component in [1/2, 1); nothing for 0 and what is not finite.
std::optional<int> exponent_of(const dvec3& v)
{
    const double largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
    if (!is_finite(v) || largest == 0) return std::nullopt;
    int exponent = 0;
    static_cast<void>(std::frexp(largest, &exponent));
    return exponent;
}

dvec3 scaled(const dvec3& v, int exponent)
{
    return dvec3(std::ldexp(v.x, exponent), std::ldexp(v.y, exponent), std::ldexp(v.z, exponent));
}

}  // namespace

double robust_length(const dvec3& v)
{
    const std::optional<int> exponent = exponent_of(v);
    if (!exponent) return std::abs(v.x) + std::abs(v.y) + std::abs(v.z);  // 0, Inf or NaN
    const dvec3 s = scaled(v, -*exponent);
    return std::ldexp(std::sqrt(dot(s, s)), *exponent);
}

std::optional<dvec3> unit(const dvec3& v)
{
    const std::optional<int> exponent = exponent_of(v);
    if (!exponent) return std::nullopt;
    const dvec3 s = scaled(v, -*exponent);
    return s / std::sqrt(dot(s, s));
}

double angle_between(const dvec3& a, const dvec3& b)
{
    return 2 * std::atan2(robust_length(a - b), robust_length(a + b));
}

std::optional<Roots> solve_quadratic(double a, double b, double c)
{
    if (a == 0) {
        if (b == 0) return std::nullopt;
        return Roots{-c / b, -c / b};
    }
    const double discriminant = difference_of_products(b, b, 4 * a, c);
    if (!(discriminant >= 0)) return std::nullopt;
    // The root that adds like signs; the other from their product c/a, since it would subtract nearly equal numbers.
    const double q = -0.5 * (b + std::copysign(std::sqrt(discriminant), b));
    const double t0 = q / a;
    const double t1 = q == 0 ? 0 : c / q;
    return Roots{std::min(t0, t1), std::max(t0, t1)};
}

Tangents tangents_of(const dvec3& normal)
{
    const double sign = std::copysign(1.0, normal.z);
    const double a = -1 / (sign + normal.z);
    const double b = normal.x * normal.y * a;
    return {dvec3(1 + sign * normal.x * normal.x * a, sign * b, -sign * normal.x),
            dvec3(b, sign + normal.y * normal.y * a, -normal.y)};
}

}  // namespace etalon
