#include "engine/render/environment.h"

#include <gtest/gtest.h>

#include <cmath>

namespace etalon {
namespace {

dvec3 direction(double column, double row, int width, int height)
{
    const double azimuth = 2 * kPi * (column + 0.5) / width, polar = kPi * (row + 0.5) / height;
    return {std::sin(polar) * std::sin(azimuth), std::cos(polar), -std::sin(polar) * std::cos(azimuth)};
}

double solid_angle(int row, int width, int height)
{
    return 2 * kPi / width * (std::cos(kPi * row / height) - std::cos(kPi * (row + 1) / height));
}

template <class Radiance>
Image map_of(int width, int height, Radiance radiance)
{
    Image map(width, height, 3);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (int c = 0; c < 3; ++c)
                map.at(x, y, c) = static_cast<float>(radiance(direction(x, y, width, height), c));
    return map;
}

/// E/π of (SH-33) in the direction of a texel of its table.
double mean_by_cosine(const EnvironmentTables& tables, int column, int row)
{
    const int first = tables.mirror_height + EnvironmentTables::kRoughTables * EnvironmentTables::kTableHeight;
    return double(tables.atlas.at(column, first + row, 1));
}

TEST(EnvironmentTables, SH35_a_constant_map_gives_its_radiance_and_pi_times_it)
{
    const EnvironmentTables tables = tabulate(map_of(96, 31, [](const dvec3&, int c) { return 1.5 + c; }));
    EXPECT_EQ(tables.mirror_width, 96);
    EXPECT_EQ(tables.mirror_height, 31);
    for (int y = 0; y < tables.atlas.height; ++y)
        for (int x = 0; x < EnvironmentTables::kTableWidth; ++x)
            for (int c = 0; c < 3; ++c) ASSERT_NEAR(tables.atlas.at(x, y, c), 1.5 + c, 1e-6) << x << ", " << y;
}

TEST(EnvironmentTables, SH33_irradiance_of_a_quadratic_sky_is_the_integral)
{
    // For L = 2 + d·a + d.x d.y the cosine lobe gives E = 2π + (2π/3) n·a + (π/4) n.x n.y.
    const dvec3 a(0.5, -0.3, 0.7);
    const EnvironmentTables tables =
        tabulate(map_of(256, 128, [&](const dvec3& d, int) { return 2 + dot(d, a) + d.x * d.y; }));
    for (const auto& [column, row] : {std::pair(0, 0), std::pair(16, 9), std::pair(33, 17), std::pair(63, 31)}) {
        const dvec3 n = direction(column, row, EnvironmentTables::kTableWidth, EnvironmentTables::kTableHeight);
        EXPECT_NEAR(mean_by_cosine(tables, column, row), 2 + 2.0 / 3 * dot(n, a) + n.x * n.y / 4, 1e-3);
    }
}

TEST(EnvironmentTables, SH35_rough_tables_are_the_sums_as_written)
{
    // A bright patch, so that the lobe's shape matters.
    const Image map = map_of(128, 64, [](const dvec3& d, int c) { return d.x > 0.8 && d.y > 0.2 ? 50.0 + c : 1.0; });
    const EnvironmentTables tables = tabulate(map);
    for (const int table : {1, 3, 5})
        for (const auto& [column, row] : {std::pair(0, 0), std::pair(16, 9), std::pair(33, 17), std::pair(63, 31)}) {
            const double roughness = table / 5.0, alpha = roughness * roughness;
            const dvec3 n = direction(column, row, 64, 32);
            double light = 0, weights = 0;
            for (int y = 0; y < 64; ++y)
                for (int x = 0; x < 128; ++x) {
                    const dvec3 l = direction(x, y, 128, 64);
                    const double n_h = dot(n, normalize(n + l));
                    const double d = alpha * alpha / (kPi * std::pow(n_h * n_h * (alpha * alpha - 1) + 1, 2));
                    const double weight = d * std::max(dot(n, l), 0.0) * solid_angle(y, 128, 64);
                    light += weight * static_cast<double>(map.at(x, y, 1));
                    weights += weight;
                }
            const float found = tables.atlas.at(column, tables.mirror_height + 32 * (table - 1) + row, 1);
            EXPECT_NEAR(found, light / weights, 1e-6 * light / weights) << table << ": " << column << ", " << row;
        }
}

TEST(EnvironmentTables, large_maps_are_averaged_down_and_threads_change_no_bit)
{
    const Image map = map_of(1030, 515, [](const dvec3& d, int c) { return 1 + d.x * d.z + 0.1 * c; });
    const EnvironmentTables one = tabulate(map, 1);
    const EnvironmentTables many = tabulate(map, 3);
    EXPECT_EQ(one.mirror_width, 512);
    EXPECT_EQ(one.mirror_height, 256);
    EXPECT_EQ(one.atlas.values, many.atlas.values);
}

TEST(EnvironmentTables, a_single_texel_will_do)
{
    const EnvironmentTables tables = tabulate(map_of(1, 1, [](const dvec3&, int) { return 3.0; }));
    EXPECT_NEAR(tables.atlas.at(0, 0, 0), 3, 1e-6);
    EXPECT_NEAR(tables.atlas.at(63, tables.atlas.height - 1, 2), 3, 1e-6);
}

}  // namespace
}  // namespace etalon
