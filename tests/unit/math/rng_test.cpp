#include "shaders/shared/rng.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <unordered_set>
#include <vector>

#include "engine/math/stats.h"

namespace etalon {
namespace {

using shared::pcg4d;
using shared::random_bits;
using shared::unit_float;

/// The chance of a false alarm of each statistical test here, over all its parts. Seeds are fixed: it passes or fails
/// for good.
constexpr double kFalseAlarm = 1e-6;

TEST(UnitFloat, M5_is_below_one_for_every_word)
{
    // The low 8 bits are dropped, so these are all words there are.
    for (std::uint32_t high = 0; high < (1u << 24); ++high) {
        const float u = unit_float(high << 8 | 0xff);
        ASSERT_EQ(double(u), double(high) / 16777216);
        ASSERT_LT(u, 1.0f);
    }
    int ones = 0;
    for (std::uint32_t below = 1; below < 1000; ++below) ones += float(0u - below) * 0x1p-32f == 1.0f ? 1 : 0;
    EXPECT_EQ(ones, 128) << "the exhibit: float(u) / 2^32";
}

/// pcg4d written again from the paper, in 64-bit arithmetic cut to 32 bits.
std::array<std::uint32_t, 4> again(std::array<std::uint64_t, 4> v)
{
    const auto cut = [](std::uint64_t x) { return x & 0xffffffffu; };
    const auto mix = [&] {
        v[0] = cut(v[0] + v[1] * v[3]);
        v[1] = cut(v[1] + v[2] * v[0]);
        v[2] = cut(v[2] + v[0] * v[1]);
        v[3] = cut(v[3] + v[1] * v[2]);
    };
    for (std::uint64_t& x : v) x = cut(x * 1664525 + 1013904223);
    mix();
    for (std::uint64_t& x : v) x ^= x >> 16;
    mix();
    return {std::uint32_t(v[0]), std::uint32_t(v[1]), std::uint32_t(v[2]), std::uint32_t(v[3])};
}

TEST(Pcg4d, equals_its_definition)
{
    for (std::uint32_t i = 0; i < 1000; ++i) {
        const std::uint32_t a = i * 2654435761u, b = ~i, c = i << 22, d = i;
        const uvec4 value = pcg4d(uvec4(a, b, c, d));
        const auto expected = again({a, b, c, d});
        for (int k = 0; k < 4; ++k) ASSERT_EQ(value[k], expected[std::size_t(k)]);
    }
}

/// The ways in which a renderer counts: neighbouring pixels, samples, decisions, seeds.
std::map<std::string, std::function<uvec4(std::uint32_t)>> counters()
{
    return {{"pixels", [](std::uint32_t i) { return random_bits(i, 0, 0, 0); }},
            {"samples", [](std::uint32_t i) { return random_bits(123456, i, 3, 7); }},
            {"dimensions", [](std::uint32_t i) { return random_bits(77, 5, i, 0); }},
            {"seeds", [](std::uint32_t i) { return random_bits(77, 5, 2, i); }},
            {"all at once", [](std::uint32_t i) { return random_bits(i & 63, i >> 6 & 63, i >> 12, 0); }}};
}

double chi_square_of_counts(const std::vector<int>& counts, double expected)
{
    double sum = 0;
    for (const int count : counts) sum += (count - expected) * (count - expected) / expected;
    return sum;
}

TEST(RandomBits, every_component_is_uniform_whatever_counts)
{
    const double level = sidak_level(kFalseAlarm, 5 * 4);
    for (const auto& [what, bits] : counters())
        for (int k = 0; k < 4; ++k) {
            std::vector<int> counts(1024);
            for (std::uint32_t i = 0; i < 200000; ++i) ++counts[bits(i)[k] >> 22];
            EXPECT_GT(chi_square_p(chi_square_of_counts(counts, 200000.0 / 1024), 1023), level)
                << what << ", component " << k;
        }
}

TEST(RandomBits, pairs_of_components_and_of_neighbours_fill_the_square)
{
    const double level = sidak_level(kFalseAlarm, 5 * 5);
    const auto check = [&](const std::string& what,
                           const std::function<std::pair<std::uint32_t, std::uint32_t>(std::uint32_t)>& pair) {
        std::vector<int> counts(64 * 64);
        for (std::uint32_t i = 0; i < 200000; ++i) {
            const auto [a, b] = pair(i);
            ++counts[(a >> 26) * 64 + (b >> 26)];
        }
        EXPECT_GT(chi_square_p(chi_square_of_counts(counts, 200000.0 / 4096), 4095), level) << what;
    };
    for (const auto& counter : counters()) {
        const auto& bits = counter.second;
        check(counter.first + " x, y", [&](std::uint32_t i) { return std::pair{bits(i).x, bits(i).y}; });
        check(counter.first + " z, w", [&](std::uint32_t i) { return std::pair{bits(i).z, bits(i).w}; });
        for (int k = 0; k < 3; ++k)
            check(counter.first + " with its neighbour", [&](std::uint32_t i) {
                return std::pair{bits(i)[k], bits(i + 1)[k]};
            });
    }
}

TEST(RandomBits, M7_no_two_decisions_share_their_numbers)
{
    std::unordered_set<std::uint64_t> seen;
    std::size_t count = 0;
    for (std::uint32_t pixel = 0; pixel < 64; ++pixel)
        for (std::uint32_t sample = 0; sample < 64; ++sample)
            for (std::uint32_t dimension = 0; dimension < 64; ++dimension, ++count) {
                const uvec4 bits = random_bits(pixel, sample, dimension, 1);
                seen.insert(std::uint64_t{bits.x} << 32 | bits.y);
            }
    EXPECT_EQ(seen.size(), count) << "by chance alone once in 10^8";
}

}  // namespace
}  // namespace etalon
