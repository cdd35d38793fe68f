#include "shaders/shared/sobol.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

#include "engine/math/stats.h"

namespace etalon {
namespace {

using shared::pcg4d;
using shared::sobol_bits;
using shared::sobol_pair;

/// Of a test that fails for no reason; each has a fixed seed, so that it never changes its mind.
constexpr double kFalseAlarm = 1e-6;

TEST(Sobol, MC_8_the_unscrambled_sequence_is_sobols)
{
    // Direction numbers of the second dimension: 1/2, 3/4, 5/8, 15/16 … (Sobol 1967; Joe & Kuo 2008).
    for (std::uint32_t i = 0; i < 4096; ++i) {
        std::uint32_t expected = 0, direction = 0x80000000u;
        for (std::uint32_t rest = i; rest != 0; rest >>= 1) {
            if ((rest & 1) != 0) expected ^= direction;
            direction ^= direction >> 1;
        }
        EXPECT_EQ(shared::reversed_bits(shared::pascal_bits(i)), expected) << i;
    }
}

/// Which sample of a pixel is number `i` of one of its replicates.
std::uint32_t of_replicate(std::uint32_t i, std::uint32_t replicate)
{
    return i * shared::kSobolReplicates + replicate % shared::kSobolReplicates;
}

TEST(Sobol, MC_8_every_run_of_a_power_of_two_has_a_point_in_every_elementary_interval)
{
    for (std::uint32_t pixel = 0; pixel < 10 * shared::kSobolReplicates; ++pixel)
        for (const int m : {1, 4, 8})
            for (const std::uint32_t run : {0u, 1u, 5u}) {
                const std::uint32_t count = 1u << m;
                for (int across = 0; across <= m; ++across) {  // 2^across columns, 2^(m - across) rows
                    std::vector<int> hits_a(count), hits_b(count);
                    for (std::uint32_t i = run * count; i < (run + 1) * count; ++i) {
                        // Of one replicate: its samples are those of a pixel that are dealt to it.
                        const uvec4 bits = sobol_bits(pixel, of_replicate(i, pixel), 3, 9);
                        const auto cell = [&](std::uint32_t x, std::uint32_t y) {
                            return (std::uint64_t{x} >> (32 - across)) << (m - across) |
                                   std::uint64_t{y} >> (32 - m + across);
                        };
                        ++hits_a[cell(bits.x, bits.y)];
                        ++hits_b[cell(bits.z, bits.w)];
                    }
                    EXPECT_EQ(hits_a, std::vector<int>(count, 1)) << pixel << " " << m << " " << across;
                    EXPECT_EQ(hits_b, std::vector<int>(count, 1)) << pixel << " " << m << " " << across;
                }
            }
}

double chi_square_of(const std::vector<int>& counts)
{
    double total = 0, sum = 0;
    for (const int count : counts) total += count;
    const double expected = total / double(counts.size());
    for (const int count : counts) sum += (count - expected) * (count - expected) / expected;
    return chi_square_p(sum, double(counts.size() - 1));
}

// What one sample a pixel shows: neighbours must know nothing of each other, nor a pair of another.
TEST(Sobol, MC_8_first_samples_of_pixels_and_pairs_of_decisions_are_independent)
{
    using Pair = std::function<std::pair<std::uint32_t, std::uint32_t>(std::uint32_t)>;
    const std::pair<const char*, Pair> rows[] = {
        {"x, y of the first sample over pixels",
         [](std::uint32_t i) {
             const uvec4 b = sobol_bits(i, 0, 0, 0);
             return std::pair{b.x, b.y};
         }},
        {"neighbouring pixels",
         [](std::uint32_t i) {
             return std::pair{sobol_bits(i, 0, 0, 0).x, sobol_bits(i + 1, 0, 0, 0).x};
         }},
        {"the same sample of neighbours, later",
         [](std::uint32_t i) {
             return std::pair{sobol_bits(i, 100000, 0, 0).y, sobol_bits(i + 1, 100000, 0, 0).y};
         }},
        {"two pairs of a decision",
         [](std::uint32_t i) {
             const uvec4 b = sobol_bits(i / 64, i % 64, 2, 0);
             return std::pair{b.x, b.z};
         }},
        {"two decisions",
         [](std::uint32_t i) {
             return std::pair{sobol_bits(i / 64, i % 64, 2, 0).y, sobol_bits(i / 64, i % 64, 3, 0).y};
         }},
        {"two replicates",
         [](std::uint32_t i) {
             return std::pair{sobol_bits(i / 64, of_replicate(i % 64, 0), 2, 0).x,
                              sobol_bits(i / 64, of_replicate(i % 64, 1), 2, 0).x};
         }},
        {"their even numbers",
         [](std::uint32_t i) {
             return std::pair{sobol_bits(i, of_replicate(7, 0), 2, 0).y, sobol_bits(i, of_replicate(7, 1), 2, 0).y};
         }},
        {"two seeds", [](std::uint32_t i) {
             return std::pair{sobol_bits(i / 64, i % 64, 2, 0).x, sobol_bits(i / 64, i % 64, 2, 1).x};
         }}};
    for (const auto& [what, pair] : rows) {
        std::vector<int> counts(32 * 32);
        for (std::uint32_t i = 0; i < 100000; ++i) {
            const auto [a, b] = pair(i);
            ++counts[(a >> 27) * 32 + (b >> 27)];
        }
        EXPECT_GT(chi_square_of(counts), sidak_level(kFalseAlarm, 8)) << what;
    }
}

/// Mean squared error of the mean of `count` samples over many pixels.
double squared_error(bool sobol, std::uint32_t count, const std::function<double(double, double)>& f, double truth)
{
    constexpr std::uint32_t kPixels = 400;
    double sum = 0;
    for (std::uint32_t pixel = 0; pixel < kPixels; ++pixel) {
        double mean = 0;
        for (std::uint32_t i = 0; i < count; ++i) {
            const uvec4 bits = sobol ? sobol_bits(pixel, i, 1, 5) : shared::random_bits(pixel, i, 1, 5);
            mean += f(bits.x * 0x1p-32, bits.y * 0x1p-32) / count;
        }
        sum += (mean - truth) * (mean - truth) / kPixels;
    }
    return sum;
}

TEST(Sobol, MC_8_converges_as_the_theory_says)
{
    // Squared error over 400 scramblings is known to a relative 0.07 (one standard deviation), a slope of log2 over
    // four octaves to 0.04; six of them allow for its tail. Owen 1997: N^-3 for smooth integrands, N^-1.5 for edges at
    // an angle.
    struct Row {
        const char* what;
        std::function<double(double, double)> f;
        double truth;
        double independent, even;
    };
    const Row rows[] = {
        {"smooth", [](double x, double y) { return x * x * y; }, 1.0 / 6, -1, -3},
        {"edge", [](double x, double y) { return x + 0.618 * y < 0.7 ? 1.0 : 0.0; }, 0.7 - 0.618 / 2, -1, -1.5}};
    const auto slope = [](const Row& row, bool sobol) {
        return (std::log2(squared_error(sobol, 256, row.f, row.truth)) -
                std::log2(squared_error(sobol, 16, row.f, row.truth))) /
               4;
    };
    for (const Row& row : rows) {
        EXPECT_NEAR(slope(row, false), row.independent, 0.25) << row.what;
        EXPECT_NEAR(slope(row, true), row.even, 0.3) << row.what;
    }
}

}  // namespace
}  // namespace etalon
