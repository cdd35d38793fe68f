#pragma once
// Errors counted in units in the last place, and matchers that say them.
#include <gmock/gmock.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <type_traits>

namespace etalon::test {

/// How many representable values lie from `a` to `b`: 0 for equal ones (-0 and 0 included), the largest count where
/// either is NaN.
template <typename T>
std::uint64_t ulp_distance(T a, T b)
{
    if (std::isnan(a) || std::isnan(b)) return std::numeric_limits<std::uint64_t>::max();
    using Bits = std::conditional_t<sizeof(T) == 4, std::int32_t, std::int64_t>;
    // Sign and magnitude to a line of integers on which neighbours differ by one.
    const auto position = [](T x) {
        const auto bits = std::bit_cast<Bits>(x);
        return bits >= 0 ? std::int64_t{bits} : std::int64_t{std::numeric_limits<Bits>::min()} - std::int64_t{bits};
    };
    const std::int64_t pa = position(a), pb = position(b);
    return pa > pb ? std::uint64_t(pa) - std::uint64_t(pb) : std::uint64_t(pb) - std::uint64_t(pa);
}

/// EXPECT_THAT(value, WithinUlp(expected, 4)).
MATCHER_P2(WithinUlp, expected, ulps,
           "is within " + ::testing::PrintToString(ulps) + " ulp of " + ::testing::PrintToString(expected))
{
    const std::uint64_t distance = ulp_distance(arg, static_cast<std::remove_cvref_t<decltype(arg)>>(expected));
    *result_listener << "which is " << distance << " ulp away";
    return distance <= static_cast<std::uint64_t>(ulps);
}

/// The same bits: NaN equals the same NaN, and -0 is not 0.
template <typename T>
bool same_bits(T a, T b)
{
    using Bits = std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>;
    return std::bit_cast<Bits>(a) == std::bit_cast<Bits>(b);
}

}  // namespace etalon::test
