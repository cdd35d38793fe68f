#include "engine/math/robust.h"

#include <algorithm>
#include <optional>

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

double angle_between(const dvec3& a, const dvec3& b)
{
    return 2 * std::atan2(robust_length(a - b), robust_length(a + b));
}

}  // namespace etalon
