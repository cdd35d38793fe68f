// What the path tracer draws lights from: alias tables, the environment's cells, emission seen from afar.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <random>

#include "engine/math/stats.h"
#include "engine/render/path_alias.h"
#include "engine/render/path_sky.h"

namespace etalon {
namespace {

/// The probability with which each entry is drawn, from the table itself.
std::vector<double> drawn(const std::vector<AliasEntry>& table)
{
    std::vector<double> p(table.size());
    for (std::size_t i = 0; i < table.size(); ++i) {
        p[i] += table[i].threshold / double(table.size());
        p[table[i].other] += (1.0 - double(table[i].threshold)) / double(table.size());
    }
    return p;
}

TEST(AliasTable, M10_draws_each_entry_by_its_weight)
{
    std::mt19937 random(1);
    std::lognormal_distribution<double> heavy(0, 3);
    std::vector<double> weights(10000);
    for (double& weight : weights) weight = heavy(random);
    const std::vector<AliasEntry> table = make_alias_table(weights);
    double sum = 0, total = 0;
    for (const double weight : weights) sum += weight;
    const std::vector<double> p = drawn(table);
    for (std::size_t i = 0; i < weights.size(); ++i) {
        EXPECT_NEAR(table[i].probability, weights[i] / sum, 1e-15);
        EXPECT_NEAR(p[i], weights[i] / sum, 1e-7 * (weights[i] / sum + 1e-4)) << i;  // thresholds are floats
        total += table[i].probability;
    }
    EXPECT_NEAR(total, 1, 1e-12);
}

TEST(AliasTable, M10_one_huge_weight_among_a_million_keeps_the_others_reachable)
{
    std::vector<double> weights(1 << 20, 1.0);
    weights[77] = 1e5;
    const std::vector<double> p = drawn(make_alias_table(weights));
    const double sum = double(weights.size() - 1) + 1e5;
    EXPECT_NEAR(p[77] * sum / 1e5, 1, 1e-6);
    EXPECT_NEAR(p[78] * sum, 1, 1e-4);
    EXPECT_NEAR(p[weights.size() - 1] * sum, 1, 1e-4);
}

TEST(AliasTable, M11_an_entry_of_weight_zero_is_never_drawn)
{
    const std::vector<double> weights{0, 1, 0, 1e-12, 1e12, 0};
    const std::vector<AliasEntry> table = make_alias_table(weights);
    const std::vector<double> p = drawn(table);
    for (const std::size_t i : {0u, 2u, 5u}) {
        EXPECT_EQ(p[i], 0.0) << i;
        EXPECT_EQ(table[i].threshold, 0.f) << i;
    }
    EXPECT_TRUE(make_alias_table(std::vector<double>{0, 0, 0}).empty()) << "no weight, no table";
    EXPECT_TRUE(make_alias_table({}).empty());
}

/// Chance of each cell of the sky's table.
std::vector<double> cell_chances(const PathSky& sky)
{
    std::vector<double> p;
    for (const uvec4& cell : sky.cells) p.push_back(std::bit_cast<float>(cell.z) / double(sky.cells.size()));
    return p;
}

TEST(PathSky, S23_every_lit_texel_is_reachable_beside_a_sun)
{
    Image map(512, 256, 3);
    for (float& value : map.values) value = 1;
    for (int c = 0; c < 3; ++c) map.at(100, 60, c) = 1e9f;
    const PathSky sky = make_path_sky(map);
    ASSERT_EQ(sky.cells.size(), map.pixel_count());
    double sum = 0;
    for (const double p : cell_chances(sky)) {
        EXPECT_GT(p, 0);
        sum += p;
    }
    EXPECT_NEAR(sum, 1, 1e-6);
    const std::size_t sun = 60 * 512 + 100;
    EXPECT_NEAR(cell_chances(sky)[sun], 36.0 / 64, 0.02) << "bilinear filtering spreads the texel over its neighbours";
}

TEST(PathSky, a_uniform_map_is_drawn_by_solid_angle)
{
    Image map(64, 32, 3);
    for (float& value : map.values) value = 2;
    const std::vector<double> p = cell_chances(make_path_sky(map));
    for (int y = 0; y < 32; ++y) {
        const double omega = (std::cos(kPi * y / 32) - std::cos(kPi * (y + 1) / 32)) / 2;
        double row = 0;
        for (int x = 0; x < 64; ++x) row += p[std::size_t(y * 64 + x)];
        EXPECT_NEAR(row / omega, 1, 2e-3) << y;
    }
}

TEST(PathSky, a_black_map_has_no_table_and_a_large_one_a_coarse_table)
{
    EXPECT_EQ(make_path_sky(Image(8, 4, 3)).cells_x, 0);
    Image large(4096, 2048, 3);
    large.at(4095, 2047, 1) = 5;
    const PathSky sky = make_path_sky(large);
    EXPECT_EQ(sky.cells_x, 1024);
    EXPECT_EQ(sky.cells_y, 512);
    EXPECT_GT(cell_chances(sky).back(), 0.2);
}

}  // namespace
}  // namespace etalon
