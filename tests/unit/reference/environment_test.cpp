#include "engine/reference/environment.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>

#include "tests/unit/reference/random.h"

namespace etalon::reference {
namespace {

using test::Random;

Environment map_environment(int width, int height, const std::function<double(int, int)>& value, double rotation = 0,
                            double scale = 1)
{
    auto map = std::make_shared<Image>(width, height, 3);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (int c = 0; c < 3; ++c) map->at(x, y, c) = static_cast<float>(value(x, y) * (c + 1));
    return {.radiance = dvec3(0), .map = map, .rotation = rotation, .scale = scale};
}

TEST(Environment, SH_40_directions_lie_where_the_page_says)
{
    EXPECT_NEAR(map_from_direction({1, 0, 0}).x, 0.25, 1e-15);
    EXPECT_NEAR(map_from_direction({0, 0, 1}).x, 0.5, 1e-15);
    EXPECT_NEAR(map_from_direction({-1, 0, 0}).x, 0.75, 1e-15);
    EXPECT_NEAR(map_from_direction({0, 0, -1}).x, 0, 1e-15);
    EXPECT_NEAR(map_from_direction({0, 1, 0}).y, 0, 1e-15);
    EXPECT_NEAR(map_from_direction({0, -1, 0}).y, 1, 1e-15);
    Random random(51);
    for (int i = 0; i < 1000; ++i) {
        const dvec3 d = random.direction();
        EXPECT_NEAR(length(direction_from_map(map_from_direction(d)) - d), 0, 1e-8);
    }
}

TEST(Environment, S22_the_seam_never_reads_past_the_map)
{
    EXPECT_LT(map_from_direction({-1e-300, 0, -1}).x, 1);
    EXPECT_LT(map_from_direction({-1e-17, 0, -1}).x, 1);
    EXPECT_GE(map_from_direction({-1e-17, 0, -1}).x, 0);
}

TEST(Environment, SH_40_rotation_turns_the_light_about_up)
{
    // One bright column, at u = 0.5: rotation 0 shows it at +Z; turned by 90 degrees about +Y, +Z goes to +X.
    const auto bright = [](int x, int) { return x == 31 || x == 32 ? 1.0 : 0.0; };
    EXPECT_NEAR(environment_radiance(map_environment(64, 32, bright), {0, 0, 1}).x, 1, 1e-6);
    EXPECT_NEAR(environment_radiance(map_environment(64, 32, bright, kPi / 2), {1, 0, 0}).x, 1, 1e-6);
    EXPECT_NEAR(environment_radiance(map_environment(64, 32, bright, kPi / 2, 3), {1, 0, 0}).y, 6, 1e-5);
    EXPECT_NEAR(environment_radiance(map_environment(64, 32, bright, kPi / 2), {0, 0, 1}).x, 0, 1e-6);
}

double bumpy(int x, int y)
{
    return 0.2 + (x * 7 + y * 13) % 11 + (x == 5 && y == 3 ? 500 : 0);
}

TEST(Environment, S23_sampling_is_normalized_and_says_its_own_density)
{
    const EnvironmentSampler sampler(map_environment(16, 8, bumpy, 0.7));
    double total = 0;
    constexpr int kRings = 400, kSectors = 800;
    for (int i = 0; i < kRings; ++i)
        for (int j = 0; j < kSectors; ++j) {
            const double z = -1 + 2 * (i + 0.5) / kRings, phi = 2 * kPi * (j + 0.5) / kSectors,
                         r = std::sqrt(1 - z * z);
            total += sampler.pdf({r * std::cos(phi), z, r * std::sin(phi)});
        }
    EXPECT_NEAR(total * 4 * kPi / kRings / kSectors, 1, 0.01);
    Random random(52);
    for (int i = 0; i < 2000; ++i) {
        const auto drawn = sampler.sample(random.square());
        EXPECT_NEAR(length(drawn.direction), 1, 1e-14);
        // A draw on a texel's very edge may be read as its neighbour.
        EXPECT_NEAR(sampler.pdf(drawn.direction) / drawn.pdf, 1, 1e-6);
    }
}

TEST(Environment, S23_estimates_of_the_whole_meet_the_sum_over_texels)
{
    const Environment environment = map_environment(16, 8, bumpy, 0.3);
    const EnvironmentSampler sampler(environment);
    double by_quadrature = 0;
    constexpr int kRings = 600, kSectors = 1200;
    for (int i = 0; i < kRings; ++i)
        for (int j = 0; j < kSectors; ++j) {
            const double z = -1 + 2 * (i + 0.5) / kRings, phi = 2 * kPi * (j + 0.5) / kSectors,
                         r = std::sqrt(1 - z * z);
            by_quadrature += environment_radiance(environment, {r * std::cos(phi), z, r * std::sin(phi)}).x * 4 * kPi /
                             kRings / kSectors;
        }
    Random random(53);
    double sum = 0, squares = 0;
    constexpr int kDraws = 40000;
    for (int i = 0; i < kDraws; ++i) {
        const auto drawn = sampler.sample(random.square());
        const double x = environment_radiance(environment, drawn.direction).x / drawn.pdf;
        sum += x;
        squares += x * x;
    }
    const double mean = sum / kDraws, error = std::sqrt((squares / kDraws - mean * mean) / kDraws);
    EXPECT_NEAR(mean, by_quadrature, 5 * error + 1e-3 * by_quadrature);  // 5 standard errors: one false alarm in 10⁶
    EXPECT_LT(error / mean, 0.02);  // and the sampler follows the light: a uniform one would err by 0.06
}

TEST(Environment, S23_a_black_map_and_a_constant_one_are_not_sampled)
{
    EXPECT_TRUE(EnvironmentSampler(map_environment(8, 4, [](int, int) { return 0.0; })).empty());
    EXPECT_TRUE(EnvironmentSampler(Environment{.radiance = dvec3(1)}).empty());
    EXPECT_EQ(EnvironmentSampler(Environment{}).pdf({0, 1, 0}), 0);
}

TEST(Environment, SH_35_a_constant_environment_gives_its_radiance_and_pi_times_it)
{
    for (const bool as_map : {false, true}) {
        const Environment environment = as_map ? map_environment(
                                                     32, 16, [](int, int) { return 0.5; }, 0.4, 2)
                                               : Environment{.radiance = {0.5, 1, 1.5}, .scale = 2};
        const EnvironmentTables tables(environment, 1);
        Random random(54);
        for (int i = 0; i < 50; ++i) {
            const dvec3 d = random.direction();
            EXPECT_NEAR(tables.irradiance(d).x, kPi, 2e-3 * kPi);
            EXPECT_NEAR(tables.prefiltered(d, random.uniform()).y, 2, 1e-12);
        }
    }
}

TEST(Environment, SH_33_irradiance_of_a_smooth_sky_is_the_integral)
{
    // L = 1 + d.y: E = π + 2π/3 n.y, between nodes of the table by chords.
    const auto sky = [](int, int y) { return 1 + std::cos(kPi * (y + 0.5) / 64); };
    const EnvironmentTables tables(map_environment(128, 64, sky), 1);
    Random random(55);
    for (int i = 0; i < 50; ++i) {
        const dvec3 n = random.direction();
        EXPECT_NEAR(tables.irradiance(n).x, kPi + 2 * kPi / 3 * n.y, 5e-3);
    }
}

TEST(Environment, SH_35_prefiltered_tables_go_from_the_map_to_its_blur)
{
    const auto half = [](int x, int) { return x < 64 ? 1.0 : 0.0; };  // the +X half shines
    const EnvironmentTables tables(map_environment(128, 64, half), 1);
    EXPECT_NEAR(tables.prefiltered({1, 0, 0}, 0).x, 1, 1e-6);
    EXPECT_NEAR(tables.prefiltered({-1, 0, 0}, 0).x, 0, 1e-6);
    EXPECT_NEAR(tables.prefiltered({0, 1, 0}, 1).x, 0.5, 0.02);
    double before = 1.1;
    for (const double roughness : {0.0, 0.2, 0.5, 0.8, 1.0}) {  // facing the lit half it only gets darker
        const double at = tables.prefiltered({1, 0, 0}, roughness).x;
        EXPECT_LT(at, before + 1e-9);
        EXPECT_GT(at, 0.5);
        before = at;
    }
}

TEST(Environment, SH_41_area_averages_keep_the_mean_of_every_row)
{
    const Environment environment = map_environment(30, 14, bumpy);
    const RadianceMap small = area_average(environment, 7, 4);
    double all = 0, kept = 0;
    for (int y = 0; y < 14; ++y)
        for (int x = 0; x < 30; ++x) all += bumpy(x, y) / (30 * 14);
    for (const dvec3& t : small.texels) kept += t.x / (7 * 4);
    EXPECT_NEAR(kept, all, 1e-5 * all);                           // float texels
    const RadianceMap large = area_average(environment, 60, 28);  // texels are constant squares
    for (const auto& [x, y] : {std::pair{0, 0}, {17, 5}, {59, 27}})
        EXPECT_NEAR(large.texels[std::size_t(y * 60 + x)].x, bumpy(x / 2, y / 2), 1e-5 * bumpy(x / 2, y / 2));
}

}  // namespace
}  // namespace etalon::reference
