#include "engine/image/film.h"

#include <gmock/gmock.h>

#include <cmath>
#include <random>

#include "engine/math/stats.h"
#include "tests/support/ulp.h"

namespace etalon {
namespace {

/// One block of samples of one value a pixel, as a device makes it: float mean and M2 from sums in double.
struct Block {
    std::vector<float> mean;
    std::vector<float> m2;
    std::vector<float> alpha;
};

Block block_of(const std::vector<double>& samples)
{
    double mean = 0, m2 = 0, n = 0;
    for (const double x : samples) {
        const double delta = x - mean;
        mean += delta / ++n;
        m2 += delta * (x - mean);
    }
    return {std::vector(3, float(mean)), std::vector(3, float(m2)), {1.0f}};
}

TEST(FilmSum, M1_does_not_drift_over_a_hundred_million_samples)
{
    FilmSum sum(1, 1);
    const Block block = block_of(std::vector<double>(1024, 0.1));
    for (int i = 0; i < 100000; ++i) sum.add_block(block.mean, block.m2, block.alpha, 1024);
    EXPECT_EQ(sum.samples(), 102400000u);
    EXPECT_EQ(sum.film().mean[0].x, block.mean[0]);
    float naive = 0;
    for (int i = 0; i < 102400000; ++i) naive += 0.1f;
    EXPECT_GT(std::abs(double(naive) / 102400000 / 0.1 - 1), 0.5) << "the plain float sum should have stuck";
}

TEST(FilmSum, M2_a_constant_stays_exact)
{
    for (const float value : {0.1f, 3.0e-30f, 1e30f, -7.3f}) {
        FilmSum sum(1, 1);
        for (std::uint64_t count = 1; count < 500; ++count)
            sum.add_block(std::vector(3, value), std::vector(3, 0.0f), std::vector(1, 0.3f), count);
        const Film film = sum.film();
        EXPECT_EQ(film.mean[0], vec3(value));
        EXPECT_EQ(film.variance[0], vec3(0));
        EXPECT_EQ(film.alpha[0], 0.3f);
    }
}

TEST(FilmSum, M3_variance_does_not_cancel)
{
    // The same noise on a mean of 0 and of 10^4: the same variance, which E[x²] - E[x]² in float misses by 10^5.
    std::mt19937 random(11);
    std::normal_distribution<double> noise;
    std::vector<std::vector<double>> blocks(100, std::vector<double>(1000));
    for (auto& block : blocks)
        for (double& x : block) x = noise(random);
    const auto variance_at = [&](double shift) {
        FilmSum sum(1, 1);
        for (std::vector<double> block : blocks) {
            for (double& x : block) x += shift;
            const Block made = block_of(block);
            sum.add_block(made.mean, made.m2, made.alpha, 1000);
        }
        return double(sum.film().variance[0].x) * 100000;
    };
    EXPECT_NEAR(variance_at(0), 1, 5 * std::sqrt(2.0 / 100000)) << "5 sigma of a sample variance";
    EXPECT_NEAR(variance_at(1e4) / variance_at(0), 1, 1e-4);
}

TEST(FilmSum, agrees_with_one_pass_over_all_samples_whatever_the_blocks)
{
    std::mt19937 random(12);
    std::exponential_distribution<double> light(0.5);
    std::vector<double> all(10000);
    for (double& x : all) x = light(random);
    double mean = 0, m2 = 0;
    for (const double x : all) mean += x / double(all.size());
    for (const double x : all) m2 += (x - mean) * (x - mean);
    const double expected = m2 / double(all.size() - 1) / double(all.size());
    for (const std::size_t size : {1u, 7u, 1000u, 10000u}) {
        FilmSum sum(1, 1);
        for (std::size_t i = 0; i < all.size(); i += size) {
            const std::size_t end = std::min(i + size, all.size());
            const Block block =
                block_of(std::vector(all.begin() + std::ptrdiff_t(i), all.begin() + std::ptrdiff_t(end)));
            sum.add_block(block.mean, block.m2, block.alpha, end - i);
        }
        const Film film = sum.film();
        EXPECT_EQ(film.samples, 10000u);
        EXPECT_NEAR(film.mean[0].y / mean, 1, 1e-6) << size;
        EXPECT_NEAR(film.variance[0].z / expected, 1, 1e-5) << size;
    }
}

TEST(FilmSum, has_no_variance_below_two_samples)
{
    FilmSum sum(2, 1);
    EXPECT_TRUE(sum.film().variance.empty());
    const std::vector<float> mean(6, 1.0f), m2(6, 0.0f), alpha(2, 0.5f);
    sum.add_block(mean, m2, alpha, 0);
    EXPECT_EQ(sum.samples(), 0u);
    sum.add_block(mean, m2, alpha, 1);
    EXPECT_TRUE(sum.film().variance.empty());
    EXPECT_FALSE(estimate_error(sum.film()).has_value());
    sum.add_block(mean, m2, alpha, 1);
    EXPECT_EQ(sum.film().variance.size(), 2u);
}

Film film_of(int width, int height, const vec3& mean, const vec3& variance)
{
    Film film;
    film.width = width;
    film.height = height;
    film.mean.assign(film.pixel_count(), mean);
    film.variance.assign(film.pixel_count(), variance);
    film.alpha.assign(film.pixel_count(), 1.0f);
    return film;
}

TEST(EstimateError, is_the_relative_standard_error_of_the_picture)
{
    const auto estimate = estimate_error(film_of(64, 64, vec3(1, 2, 3), vec3(0.01f, 0.04f, 0.25f)));
    ASSERT_TRUE(estimate);
    EXPECT_NEAR(estimate->relative, std::sqrt(0.1) / 2, 1e-7);
    EXPECT_NEAR(estimate->low, estimate->relative, 1e-7) << "no scatter, no doubt";
    EXPECT_NEAR(estimate->high, estimate->relative, 1e-7);
}

TEST(EstimateError, its_interval_holds_the_truth_as_often_as_it_says)
{
    // Pixels with a variance estimate from 16 normal samples each; the truth is known. 400 pictures: the count of hits
    // must be one that a rate of 0.95 gives but once in 10^6.
    std::mt19937 random(13);
    std::normal_distribution<double> normal;
    const double truth = 0.3 / 2.0 / 4.0;  // σ 0.3 on a mean of 2, over √16
    std::uint64_t hits = 0;
    for (int picture = 0; picture < 400; ++picture) {
        Film film = film_of(24, 24, vec3(2), vec3(0));
        for (vec3& variance : film.variance) {
            double chi_square = 0;
            for (int k = 0; k < 15; ++k) {
                const double x = normal(random);
                chi_square += x * x;
            }
            variance = vec3(float(0.09 * chi_square / 15 / 16));
        }
        const auto estimate = estimate_error(film);
        hits += estimate->low <= truth && truth <= estimate->high ? 1 : 0;
    }
    const Interval rate = binomial_interval(hits, 400, 1 - 1e-6);
    EXPECT_LE(rate.low, 0.95) << hits;
    EXPECT_GE(rate.high, 0.95) << hits;
}

TEST(EstimateError, leaves_out_pixels_that_are_not_finite)
{
    Film film = film_of(40, 40, vec3(2), vec3(0.04f));
    film.mean[7] = vec3(NAN);
    film.variance[8] = vec3(INFINITY);
    const auto estimate = estimate_error(film);
    ASSERT_TRUE(estimate);
    EXPECT_NEAR(estimate->relative, 0.1, 1e-7);
}

TEST(EstimateError, knows_its_limits)
{
    EXPECT_FALSE(estimate_error(film_of(4, 4, vec3(0), vec3(1))).has_value()) << "nothing to be relative to";
    EXPECT_FALSE(estimate_error(film_of(4, 4, vec3(NAN), vec3(1))).has_value());
    const auto black = estimate_error(film_of(4, 4, vec3(0), vec3(0)));
    ASSERT_TRUE(black);
    EXPECT_EQ(black->high, 0) << "a black picture without variance is exact";
    const auto lone = estimate_error(film_of(1, 1, vec3(1), vec3(0.01f)));
    ASSERT_TRUE(lone);
    EXPECT_NEAR(lone->relative, 0.1, 1e-7);
    EXPECT_EQ(lone->low, 0) << "one pixel tells nothing about its own doubt";
    EXPECT_EQ(lone->high, INFINITY);
}

TEST(CheckFilm, counts_pixels_that_are_not_finite)
{
    Film film = film_of(3, 2, vec3(1), vec3(0));
    film.mean[0].x = NAN;
    film.mean[0].y = INFINITY;
    film.mean[1].z = -INFINITY;
    const FilmCheck found = check(film);
    EXPECT_EQ(found.nan_pixels, 1u);
    EXPECT_EQ(found.inf_pixels, 1u);
    EXPECT_FALSE(found.single_colour);
}

TEST(CheckFilm, knows_a_picture_of_one_colour)
{
    Film film = film_of(3, 2, vec3(1, 2, 3), vec3(0));
    EXPECT_TRUE(check(film).single_colour);
    film.alpha[5] = 0.5f;
    EXPECT_FALSE(check(film).single_colour);
    EXPECT_TRUE(check(film_of(3, 2, vec3(NAN), vec3(0))).single_colour);
    EXPECT_FALSE(check(film_of(1, 1, vec3(1), vec3(0))).single_colour) << "one pixel is of one colour by nature";
    EXPECT_FALSE(check(Film{}).single_colour);
}

}  // namespace
}  // namespace etalon
