#include "engine/measure/compare.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "engine/base/error.h"
#include "engine/image/replicates.h"
#include "engine/math/stats.h"
#include "engine/measure/welch.h"
#include "films.h"
#include "shaders/shared/sobol.h"

namespace etalon {
namespace {

using test::constant_film;
using test::noisy_film;
using ::testing::HasSubstr;

/// How often `trials` pairs of equal renderers are called different.
std::uint64_t alarms(int trials, const CompareSettings& settings, std::uint64_t samples_a, std::uint64_t samples_b,
                     const test::Draw& draw)
{
    std::uint64_t count = 0;
    for (int i = 0; i < trials; ++i) {
        const Film a = noisy_film(32, 32, samples_a, 1000u + 2u * unsigned(i), draw);
        const Film b = noisy_film(32, 32, samples_b, 1001u + 2u * unsigned(i), draw);
        count += compare(a, b, settings).verdict == Verdict::different;
    }
    return count;
}

TEST(Compare, K6_equal_renderers_are_called_different_as_often_as_stated)
{
    constexpr int kTrials = 300;
    const CompareSettings settings{.false_alarm = 0.1, .tile = 8};
    const Interval rate = binomial_interval(alarms(kTrials, settings, 8, 8, test::exponential), kTrials, 1 - 1e-6);
    EXPECT_LE(rate.low, settings.false_alarm);
    EXPECT_GE(rate.high, settings.false_alarm);
}

TEST(Compare, MC_10_films_of_two_replicates_are_called_different_as_often_as_stated)
{
    // One degree of freedom a pixel: Satterthwaite's own formula would give a third of them to a tile.
    constexpr int kTrials = 200;
    const CompareSettings settings{.false_alarm = 0.1, .tile = 8};
    std::uint64_t count = 0, against_many = 0;
    double score = 0, tile_score = 0;
    for (unsigned i = 0; i < kTrials; ++i) {
        const Film a = test::replicated_film(24, 24, 8, 2, 1000 + 2 * i);
        const StatisticalTest found = welch_test(a, test::replicated_film(24, 24, 8, 2, 1001 + 2 * i), settings);
        count += found.failed > 0;
        score += found.pixel_z_std / kTrials;
        tile_score += found.tile_z_std / kTrials;
        against_many += welch_test(a, noisy_film(24, 24, 16, 5001 + i), settings).failed > 0;
    }
    for (const std::uint64_t alarms : {count, against_many}) {
        const Interval rate = binomial_interval(alarms, kTrials, 1 - 1e-6);
        EXPECT_LE(rate.low, settings.false_alarm) << alarms;
        EXPECT_GE(rate.high, settings.false_alarm / 2) << alarms;
    }
    std::printf("%d and %d of %d pairs called different; std of pixel scores %.3f, of tiles %.3f\n", int(count),
                int(against_many), kTrials, score, tile_score);
    EXPECT_NEAR(score, 1, 0.15);
    EXPECT_NEAR(tile_score, 1, 0.1);
}

/// A picture of one tile that is constant but for `edges` pixels, each cut by the same edge in all pictures of a trial.
Film picture_of_edges(std::uint64_t trial, std::uint32_t seed, int edges)
{
    constexpr std::uint32_t kSamples = 64;
    Film film = constant_film(16, 16, 0.5f);
    film.samples = kSamples;
    film.replicates = shared::kSobolReplicates;
    std::mt19937_64 random(trial);
    std::uniform_real_distribution<double> uniform(0, 1);
    for (std::size_t pixel = 0; pixel < std::size_t(edges); ++pixel) {
        const double x0 = uniform(random), y0 = uniform(random), angle = 2 * kPi * uniform(random);
        std::vector<PixelSums> replicates(shared::kSobolReplicates);
        for (std::uint32_t i = 0; i < kSamples; ++i) {
            const uvec4 bits = shared::sobol_bits(std::uint32_t(16 * trial + pixel), i, 0, seed);
            const double side = (bits.x * 0x1p-32 - x0) * std::cos(angle) + (bits.y * 0x1p-32 - y0) * std::sin(angle);
            PixelSums& sums = replicates[i % replicates.size()];
            sums.mean += (dvec3(side < 0 ? 1 : 0) - sums.mean) / double(++sums.count);
        }
        const Pooled pooled = pool(replicates);
        film.mean[pixel] = vec3(pooled.mean);
        film.variance[pixel] = vec3(pooled.variance);
    }
    return film;
}

/// The same, eight times as well known: eight pictures, whose scatter is the variance.
Film well_known_edges(std::uint64_t trial, int edges)
{
    constexpr int kPictures = 8;
    Film out = picture_of_edges(trial, 3, edges);
    out.replicates = 0;
    out.samples = kPictures;
    std::vector<Film> films;
    for (std::uint32_t seed = 10; seed < 10 + kPictures; ++seed) films.push_back(picture_of_edges(trial, seed, edges));
    for (std::size_t i = 0; i < std::size_t(edges); ++i) {
        double mean = 0, m2 = 0;
        for (const Film& film : films) mean += double(film.mean[i].x) / kPictures;
        for (const Film& film : films) m2 += std::pow(double(film.mean[i].x) - mean, 2);
        out.mean[i] = vec3(float(mean));
        out.variance[i] = vec3(float(m2 / (kPictures - 1) / kPictures));
    }
    return out;
}

TEST(Compare, MC_10_few_pixels_of_edges_raise_no_false_alarms)
{
    // Replicates often hit an edge as many times, or nearly so but for rounding: the fewer the pixels, the less their
    // variances tell.
    constexpr int kTrials = 600;
    for (const int edges : {1, 2, 5, 16}) {
        std::uint64_t often = 0, rarely = 0, against_known = 0;
        for (std::uint64_t i = 0; i < kTrials; ++i) {
            const Film a = picture_of_edges(i, 1, edges), b = picture_of_edges(i, 2, edges);
            often += welch_test(a, b, {.false_alarm = 0.1}).failed > 0;
            rarely += welch_test(a, b, {.false_alarm = 0.01}).failed > 0;
            against_known += welch_test(a, well_known_edges(i, edges), {.false_alarm = 0.01}).failed > 0;
        }
        EXPECT_LE(binomial_interval(against_known, kTrials, 1 - 1e-6).low, 0.01) << edges << " edges";
        EXPECT_LE(binomial_interval(often, kTrials, 1 - 1e-6).low, 0.1) << edges << " edges: " << often;
        EXPECT_LE(binomial_interval(rarely, kTrials, 1 - 1e-6).low, 0.01) << edges << " edges: " << rarely;
    }
}

TEST(Compare, MC_10_replicates_that_agree_by_chance_prove_no_constant_but_a_fault_of_many_pixels_is_found)
{
    // An edge through few pixels of which both replicates hit the same number of times.
    Film a = constant_film(32, 32, 1.0f), b = a;
    a.replicates = b.replicates = 2;
    b.mean[5] = vec3(0.9f);
    b.mean[37] = vec3(1.1f);
    b.mean[70] = vec3(0.8f);
    EXPECT_EQ(compare(a, b).verdict, Verdict::indistinguishable);
    for (vec3& pixel : b.mean) pixel = vec3(1.01f);
    EXPECT_EQ(compare(a, b).verdict, Verdict::different);
}

TEST(Compare, K6_heavy_tails_and_unlike_sample_counts_do_not_raise_the_false_alarm_rate)
{
    constexpr int kTrials = 150;
    const CompareSettings settings{.false_alarm = 0.1, .tile = 16};
    const Interval rate = binomial_interval(alarms(kTrials, settings, 16, 48, test::rare), kTrials, 1 - 1e-6);
    EXPECT_LE(rate.low, settings.false_alarm);
}

TEST(Compare, ST4_a_difference_of_the_stated_size_is_found_with_the_stated_probability)
{
    constexpr int kTrials = 300;
    const CompareSettings settings{.tile = 16};
    std::uint64_t found = 0;
    const auto flat = [](int, int, int) { return 1.0; };
    for (int i = 0; i < kTrials; ++i) {
        Film a = noisy_film(32, 32, 16, 5000u + 2u * unsigned(i), test::exponential, flat);
        const Film b = noisy_film(32, 32, 16, 5001u + 2u * unsigned(i), test::exponential, flat);
        const double size = compare(a, b, settings).test->detectable_tile;
        for (int y = 0; y < 16; ++y)
            for (int x = 0; x < 16; ++x) a.mean[std::size_t(32 * y + x)].x += float(size);
        const StatisticalTest test = *compare(a, b, settings).test;
        for (const TileFinding& tile : test.failures) found += tile.x == 0 && tile.y == 0 && tile.channel == 0;
    }
    const Interval power = binomial_interval(found, kTrials, 1 - 1e-6);
    EXPECT_LE(power.low, settings.power);
    EXPECT_GE(power.high, settings.power);
}

TEST(Compare, K5_a_difference_of_one_percent_under_noise_of_ten_is_found)
{
    const Film a = noisy_film(96, 96, 100, 1);
    Film b = noisy_film(96, 96, 100, 2);
    EXPECT_EQ(compare(a, b).verdict, Verdict::indistinguishable);
    for (vec3& pixel : b.mean) pixel *= 1.01f;
    const Comparison found = compare(a, b);
    EXPECT_EQ(found.verdict, Verdict::different);
    EXPECT_FALSE(passed(found.verdict));
    EXPECT_LT(found.test->detectable_whole, 0.01);
    ASSERT_FALSE(found.reasons.empty());
    EXPECT_THAT(found.reasons.front(), HasSubstr("the whole picture's"));
}

TEST(Compare, K5_one_ulp_without_variance_is_found_when_no_rounding_is_allowed_and_is_rounding_otherwise)
{
    const Film a = constant_film(20, 20, 1.0f);
    Film b = a;
    b.mean[7].y = std::nextafter(1.0f, 2.0f);
    const Comparison exact = compare(a, b, {.rounding = 0});
    EXPECT_EQ(exact.verdict, Verdict::different);
    EXPECT_EQ(exact.test->constant, 3u * 400u);
    EXPECT_EQ(exact.test->constant_unequal, 1u);
    EXPECT_EQ(compare(a, b).verdict, Verdict::indistinguishable);
}

TEST(Compare, K5_one_percent_in_one_pixel_without_variance_is_found)
{
    const Film a = constant_film(40, 40, 1.0f);
    Film b = a;
    b.mean[7].z = 1.01f;
    const Comparison found = compare(a, b);
    EXPECT_EQ(found.verdict, Verdict::different);
    EXPECT_EQ(found.test->constant_unequal, 1u);
}

TEST(Compare, K5_equal_pictures_without_variance_pass_and_are_counted)
{
    const Film a = constant_film(16, 16, 0.0f);
    const Comparison same = compare(a, a);
    EXPECT_EQ(same.verdict, Verdict::indistinguishable);
    EXPECT_TRUE(same.metrics.identical);
    EXPECT_FALSE(same.metrics.psnr.has_value());
    EXPECT_EQ(same.test->constant, 768u);
    EXPECT_EQ(same.test->constant_unequal, 0u);
}

TEST(Compare, a_common_bias_of_rounding_size_is_not_a_difference)
{
    const Film a = constant_film(128, 128, 0.7f);
    Film b = a;
    for (vec3& pixel : b.mean) pixel *= 1 + 5e-7f;
    EXPECT_EQ(compare(a, b).verdict, Verdict::indistinguishable);
}

TEST(Compare, constant_pixels_of_two_samples_prove_nothing)
{
    Film a = constant_film(16, 16, 0.0f);
    Film b = a;
    a.samples = b.samples = 2;
    b.mean[0] = vec3(1);
    EXPECT_EQ(compare(a, b).test->constant_unequal, 3u);
    EXPECT_EQ(compare(a, b, {.tile = 16, .rounding = 0.5}).verdict, Verdict::indistinguishable);
}

TEST(Compare, honest_variances_give_z_of_deviation_one_and_uniform_p_values)
{
    const Comparison same = compare(noisy_film(160, 160, 32, 5), noisy_film(160, 160, 32, 6));
    EXPECT_NEAR(same.test->pixel_z_std, 1, 0.05);
    EXPECT_NEAR(same.test->tile_z_std, 1, 0.15);
    EXPECT_GT(same.test->uniformity_p, 1e-4);

    Film shy = noisy_film(160, 160, 32, 7);
    Film too = noisy_film(160, 160, 32, 8);
    for (vec3& v : shy.variance) v *= 0.25f;
    for (vec3& v : too.variance) v *= 0.25f;
    const Comparison overconfident = compare(shy, too);
    EXPECT_NEAR(overconfident.test->pixel_z_std, 2, 0.1);
    EXPECT_NEAR(overconfident.test->tile_z_std, 2, 0.3);
    EXPECT_LT(overconfident.test->uniformity_p, 1e-4);
}

TEST(Compare, K2_what_is_not_a_number_is_a_finding_on_either_side)
{
    const Film good = noisy_film(16, 16, 8, 1);
    for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
        Film broken = noisy_film(16, 16, 8, 2);
        broken.mean[3].y = bad;
        for (const Comparison& found : {compare(good, broken), compare(broken, good), compare(broken, broken)}) {
            EXPECT_EQ(found.verdict, Verdict::not_finite);
            EXPECT_TRUE(std::isfinite(found.metrics.rmse));
            EXPECT_TRUE(std::isfinite(found.test->worst_tile.z));
        }
    }
    Film broken = good;
    broken.variance[0].x = std::numeric_limits<float>::quiet_NaN();
    EXPECT_EQ(compare(good, broken).verdict, Verdict::not_finite);
}

TEST(Compare, K2_unlike_shapes_are_refused)
{
    try {
        compare(constant_film(16, 16, 1), constant_film(16, 17, 1));
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.blame(), Blame::input);
        EXPECT_THAT(error.what(), HasSubstr("16x16 and 16x17"));
    }
    Film torn = constant_film(16, 16, 1);
    torn.variance.pop_back();
    EXPECT_THROW(compare(torn, constant_film(16, 16, 1)), Error);
    EXPECT_THROW(compare(Film{}, Film{}), Error);
}

TEST(Compare, settings_out_of_range_are_refused)
{
    const Film a = constant_film(4, 4, 1);
    for (const CompareSettings& settings :
         {CompareSettings{.false_alarm = 0}, CompareSettings{.false_alarm = 1}, CompareSettings{.tile = 0},
          CompareSettings{.rounding = -1}, CompareSettings{.power = NAN}})
        EXPECT_THROW(compare(a, a, settings), Error);
}

TEST(Compare, without_variance_there_are_metrics_and_no_verdict_but_by_budget)
{
    Film raster = constant_film(16, 16, 1);
    raster.variance.clear();
    raster.samples = 0;
    const Film path = noisy_film(16, 16, 8, 3, test::exponential, [](int, int, int) { return 1.1; });
    const Comparison open = compare(raster, path);
    EXPECT_FALSE(open.test.has_value());
    EXPECT_EQ(open.verdict, Verdict::not_tested);
    EXPECT_GT(open.metrics.rmse, 0.1);
    EXPECT_EQ(compare(raster, path, {.budgets = {.rmse = 10.0}}).verdict, Verdict::within_budget);
    EXPECT_EQ(compare(raster, path, {.budgets = {.rmse = 0.01}}).verdict, Verdict::over_budget);
    EXPECT_EQ(compare(raster, raster, {.budgets = {.psnr = 100.0, .ssim = 1.0}}).verdict, Verdict::within_budget);
    EXPECT_EQ(compare(raster, path, {.budgets = {.ssim = 0.9999}}).verdict, Verdict::over_budget);
}

TEST(Compare, one_single_colour_is_said)
{
    EXPECT_THAT(compare(constant_film(8, 8, 1), noisy_film(8, 8, 4, 1)).reasons,
                testing::Contains(HasSubstr("A is one single colour")));
}

TEST(Compare, difference_pictures_show_where_and_which_way)
{
    const Film a = noisy_film(32, 32, 16, 1);
    Film b = a;
    const Image none = relative_difference_picture(a, b);
    for (const float value : none.values) EXPECT_EQ(value, none.values[0]);
    b.mean[33] *= 2.0f;
    const Image one = relative_difference_picture(a, b);
    for (std::size_t i = 0; i < one.pixel_count(); ++i)
        EXPECT_EQ(one.values[3 * i] != none.values[0] || one.values[3 * i + 1] != none.values[1], i == 33) << i;
    const Image z = z_picture(a, b);
    EXPECT_GT(z.at(1, 1, 2), z.at(1, 1, 0)) << "b is brighter: blue";
    EXPECT_EQ(z.at(5, 5, 0), z.at(5, 5, 2));
}

}  // namespace
}  // namespace etalon
