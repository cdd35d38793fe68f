#include "engine/image/replicates.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <functional>

#include "engine/math/stats.h"
#include "shaders/shared/sobol.h"

namespace etalon {
namespace {

constexpr std::uint32_t kReplicates = shared::kSobolReplicates;

/// Adds sample `i` of a pixel to what its replicate has.
void add(std::vector<PixelSums>& replicates, std::uint32_t i, double value)
{
    PixelSums& sums = replicates[i % replicates.size()];
    const dvec3 delta = dvec3(value) - sums.mean;
    sums.mean += delta / double(++sums.count);
    sums.m2 += delta * (dvec3(value) - sums.mean);
    sums.alpha += (1 - sums.alpha) / double(sums.count);
}

using Integrand = std::function<double(double, double)>;

Pooled estimate(std::uint32_t pixel, std::uint32_t samples, const Integrand& f)
{
    std::vector<PixelSums> replicates(kReplicates);
    for (std::uint32_t i = 0; i < samples; ++i) {
        const uvec4 bits = shared::sobol_bits(pixel, i, 2, 3);
        add(replicates, i, f(bits.x * 0x1p-32, bits.y * 0x1p-32));
    }
    return pool(replicates);
}

struct Row {
    const char* what;
    Integrand f;
    double truth;
};
const Row kRows[] = {
    {"smooth", [](double x, double y) { return x * x * y; }, 1.0 / 6},
    {"edge", [](double x, double y) { return x + 0.618 * y < 0.7 ? 1.0 : 0.0; }, 0.7 - 0.618 / 2},
    {"spike", [](double x, double y) { return x < 0.02 && y < 0.3 ? 100.0 * y : 1.0; }, 1 - 0.006 + 0.02 * 4.5}};

TEST(Replicates, MC_10_the_mean_and_its_variance_are_unbiased_for_any_number_of_samples)
{
    // 20,000 scramblings: what is asked of either is five standard errors of it, a false alarm in two million for each
    // of 18 numbers.
    constexpr std::uint32_t kPixels = 20000;
    for (const Row& row : kRows)
        for (const std::uint32_t samples : {6u, 17u, 64u}) {
            double mean = 0, squares = 0, difference = 0, difference_squares = 0;
            for (std::uint32_t pixel = 0; pixel < kPixels; ++pixel) {
                const Pooled found = estimate(pixel, samples, row.f);
                const double off = found.mean.x - row.truth;
                mean += off / kPixels;
                squares += off * off / kPixels;
                const double d = found.variance.x - off * off;
                difference += d / kPixels;
                difference_squares += d * d / kPixels;
            }
            const double of_mean = std::sqrt(squares / kPixels), of_variance = std::sqrt(difference_squares / kPixels);
            std::printf("%s, %u samples: bias of the mean %+.1f, of the variance %+.1f standard errors, %+.2f%%\n",
                        row.what, samples, mean / of_mean, difference / of_variance, 100 * difference / squares);
            EXPECT_NEAR(mean, 0, 5 * of_mean) << row.what << " " << samples;
            EXPECT_NEAR(difference, 0, 5 * of_variance) << row.what << " " << samples;
        }
}

TEST(Replicates, MC_10_the_interval_of_a_pictures_error_holds_the_true_one_as_often_as_it_says)
{
    // The true error is that of the expectation, and each picture's interval of 95% is held against it. A rate of it is
    // too low when 95% is outside its interval of confidence 1 - 10⁻⁶: 87% or less of 200 pictures.
    constexpr std::uint32_t kPictures = 200;
    for (const int size : {16, 32})
        for (const Row& row : kRows) {
            constexpr std::uint32_t kSamples = 16;
            const auto pixels = static_cast<std::uint32_t>(size * size);
            std::vector<Film> films(kPictures);
            double variance = 0;
            for (std::uint32_t k = 0; k < kPictures; ++k) {
                Film& film = films[k];
                film.width = film.height = size;
                film.samples = kSamples;
                film.replicates = kReplicates;
                for (std::uint32_t i = 0; i < pixels; ++i) {
                    const Pooled found = estimate(k * pixels + i, kSamples, row.f);
                    film.mean.emplace_back(found.mean);
                    film.variance.emplace_back(found.variance);
                    variance += std::pow(found.mean.x - row.truth, 2) / double(pixels) / kPictures;
                }
            }
            const double truth = std::sqrt(variance) / row.truth;
            std::uint64_t covered = 0;
            for (const Film& film : films) {
                const auto error = estimate_error(film);
                ASSERT_TRUE(error.has_value());
                covered += error->low <= truth && truth <= error->high;
            }
            const Interval rate = binomial_interval(covered, kPictures, 1 - 1e-6);
            std::printf("%s, %d x %d: %.1f%% of intervals hold the error\n", row.what, size, size,
                        100.0 * double(covered) / kPictures);
            EXPECT_GE(rate.high, 0.95) << row.what;
        }
}

TEST(Replicates, MC_10_a_constant_stays_exact)
{
    std::vector<PixelSums> constant(2);
    for (std::uint32_t i = 0; i < 9; ++i) add(constant, i, 0.1f);
    EXPECT_EQ(pool(constant).mean, dvec3(0.1f));
    EXPECT_EQ(pool(constant).variance, dvec3(0));
    EXPECT_EQ(pool(constant).alpha, 1);
}

TEST(Replicates, MC_10_replicates_without_samples_are_left_out)
{
    std::vector<PixelSums> one(2);
    add(one, 0, 3);
    EXPECT_EQ(pool(one).mean, dvec3(3));
    EXPECT_EQ(pool(one).variance, dvec3(0));
    EXPECT_EQ(pool(std::vector<PixelSums>(2)).mean, dvec3(0));
    // One replicate alone is a mean of samples as any other.
    for (const std::uint32_t i : {2u, 4u}) add(one, i, double(i));
    EXPECT_EQ(pool(one).mean, dvec3(3));
    EXPECT_NEAR(pool(one).variance.x, 1.0 / 3, 1e-15);
}

TEST(Replicates, MC_10_films_of_any_number_of_samples_say_what_their_variance_is_of)
{
    const std::vector<float> bright{1, 2, 3}, dark{0, 1, 2}, none{0, 0, 0}, alpha{1};
    std::vector<FilmSum> sums(2, FilmSum(1, 1));
    sums[0].add_block(bright, none, alpha, 1);
    EXPECT_TRUE(film_of(sums).variance.empty());
    EXPECT_EQ(film_of(sums).replicates, 0u);
    EXPECT_EQ(film_of(sums).mean[0], vec3(1, 2, 3));
    sums[1].add_block(dark, none, alpha, 1);
    const Film film = film_of(sums);
    EXPECT_EQ(film.samples, 2u);
    EXPECT_EQ(film.replicates, 2u);
    EXPECT_EQ(film.degrees_of_freedom(0), 1);
    EXPECT_EQ(film.mean[0], vec3(0.5f, 1.5f, 2.5f));
    EXPECT_EQ(film.variance[0], vec3(0.25f));
}

}  // namespace
}  // namespace etalon
