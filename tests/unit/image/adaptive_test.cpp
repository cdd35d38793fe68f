#include "engine/image/adaptive.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>

namespace etalon {
namespace {

/// A picture of radiance 1 whose pixels have the deviation that `deviation` says for one sample, known without error.
template <typename Deviation>
Film known(int width, int height, const Deviation& deviation)
{
    Film film;
    film.width = width;
    film.height = height;
    film.samples = 16;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            film.mean.emplace_back(1);
            film.variance.emplace_back(float(std::pow(deviation(x, y), 2) / 16));
            film.alpha.push_back(1);
        }
    return film;
}

/// Samples of each pixel; fails where a pixel is in no group or in two.
std::vector<std::uint64_t> samples_of(const Film& film, const std::vector<SampleGroup>& groups)
{
    std::vector<std::uint64_t> out(film.pixel_count(), 0);
    for (const SampleGroup& group : groups)
        for (const std::uint32_t pixel : group.pixels) {
            EXPECT_LT(pixel, out.size());
            EXPECT_EQ(out.at(pixel), 0u) << "twice: " << pixel;
            out.at(pixel) = group.samples;
        }
    EXPECT_EQ(std::count(out.begin(), out.end(), 0u), 0);
    return out;
}

double mean_of(const std::vector<std::uint64_t>& samples)
{
    double sum = 0;
    for (const std::uint64_t s : samples) sum += double(s);
    return sum / double(samples.size());
}

TEST(Adaptive, MC_11_samples_follow_the_deviation_and_are_no_more_than_asked)
{
    for (const ivec2 size : {ivec2(64, 64), ivec2(61, 43), ivec2(8, 8), ivec2(1, 1), ivec2(3, 200)})
        for (const std::uint64_t spp : {2u, 16u, 100u, 1024u}) {
            const Film film = known(size.x, size.y, [](int x, int) { return x < 32 ? 1.0 : 6.0; });
            const auto samples = samples_of(film, plan_samples(film, spp, AdaptiveGoal::error));
            // Tiles at the border are smaller, and may be those with more.
            EXPECT_LE(mean_of(samples), 1.1 * double(std::max<std::uint64_t>(spp, 8))) << size.x << " " << spp;
            for (const std::uint64_t s : samples) {
                EXPECT_EQ(s % 2, 0u);
                EXPECT_GE(double(s), std::max(2.0, std::floor(double(spp) / 8) * 2));
                EXPECT_LE(s, std::max<std::uint64_t>(16 * spp, 2));
            }
        }
    const Film film = known(64, 64, [](int x, int) { return x < 32 ? 1.0 : 6.0; });
    const auto samples = samples_of(film, plan_samples(film, 1024, AdaptiveGoal::error));
    EXPECT_GT(mean_of(samples), 0.75 * 1024) << "samples are left over";
    // 6 times as many, within a step of √2.
    EXPECT_GE(double(samples[60]) / double(samples[4]), 6 / std::sqrt(2.0));
    EXPECT_LE(double(samples[60]) / double(samples[4]), 6 * std::sqrt(2.0));
}

TEST(Adaptive, MC_11_where_a_pilot_says_nothing_all_pixels_are_alike)
{
    Film black = known(40, 24, [](int, int) { return 0.0; });
    for (const AdaptiveGoal goal : {AdaptiveGoal::error, AdaptiveGoal::relmse}) {
        const auto groups = plan_samples(black, 64, goal);
        ASSERT_EQ(groups.size(), 1u);
        EXPECT_EQ(groups[0].samples, 64u);
    }
    black.mean[7] = vec3(NAN);
    black.variance[9] = vec3(INFINITY);
    EXPECT_EQ(plan_samples(black, 64, AdaptiveGoal::relmse).size(), 1u);
}

TEST(Adaptive, MC_11_relmse_gives_dark_parts_what_their_contrast_needs)
{
    Film film = known(64, 32, [](int, int) { return 1.0; });
    for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 32; ++x) {
            film.mean[std::size_t(64 * y + x)] = vec3(10);
            film.variance[std::size_t(64 * y + x)] = vec3(4);
        }
    const auto by_error = samples_of(film, plan_samples(film, 256, AdaptiveGoal::error));
    const auto by_relmse = samples_of(film, plan_samples(film, 256, AdaptiveGoal::relmse));
    EXPECT_GT(by_error[0], by_error[63]) << "the bright half varies by 2, the dark one by 1/4";
    EXPECT_GE(by_relmse[63], by_relmse[0]) << "relative to their radiance it is the same, less what the floor takes";
}

/// What one run of two stages makes of a picture of which a quarter has rare bright samples: the mean, and the squared
/// error. With `reused` the samples that decided are those of the picture.
struct Outcome {
    double mean = 0, square = 0, variance = 0;
};
Outcome run(std::uint64_t seed, bool adaptive, bool reused)
{
    constexpr int kSide = 32;
    constexpr std::uint64_t kSpp = 32, kPilot = 8;
    std::mt19937_64 random(seed);
    const auto draw = [&](std::size_t pixel) {
        const double u = std::generate_canonical<double, 32>(random);
        return pixel % kSide < kSide / 2 && pixel / kSide < kSide / 2 ? (u < 0.02 ? 50.0 : 0.0) : 0.9 + 0.2 * u;
    };
    Film film;
    film.width = film.height = kSide;
    film.samples = kPilot;
    const auto measure = [&](std::size_t pixel, std::uint64_t count, double sum, double squares) {
        for (std::uint64_t s = 0; s < count; ++s) {
            const double x = draw(pixel);
            sum += x;
            squares += x * x;
        }
        const auto n = double(count + (reused ? kPilot : 0));
        return std::tuple{sum / n, std::max(squares / n - sum * sum / n / n, 0.0) / (n - 1), sum, squares};
    };
    std::vector<std::pair<double, double>> kept(film.pixel_count());
    for (std::size_t i = 0; i < film.pixel_count(); ++i) {
        double sum = 0, squares = 0;
        for (std::uint64_t s = 0; s < kPilot; ++s) {
            const double x = draw(i);
            sum += x;
            squares += x * x;
        }
        kept[i] = {sum, squares};
        const double m = sum / kPilot;
        film.mean.emplace_back(float(m));
        film.variance.emplace_back(float((squares / kPilot - m * m) / (kPilot - 1)));
    }
    std::vector<std::uint64_t> samples(film.pixel_count(), kSpp);
    if (adaptive) samples = samples_of(film, plan_samples(film, kSpp, AdaptiveGoal::error));
    Outcome out;
    for (std::size_t i = 0; i < film.pixel_count(); ++i) {
        const auto [m, v, sum, squares] =
            reused ? measure(i, samples[i] - std::min(samples[i], kPilot), kept[i].first, kept[i].second)
                   : measure(i, samples[i], 0, 0);
        out.mean += m / double(film.pixel_count());
        out.square += (m - 1) * (m - 1) / double(film.pixel_count());
        out.variance += v / double(film.pixel_count());
    }
    return out;
}

TEST(Adaptive, MC_11_two_stages_are_unbiased_have_less_error_and_say_how_much)
{
    // 600 pictures; five standard errors, a false alarm in two million for each of the two equalities.
    constexpr int kPictures = 600;
    Outcome even, two, reused;
    double squares = 0, off = 0, off_squares = 0;
    for (int k = 0; k < kPictures; ++k) {
        even.square += run(std::uint64_t(k), false, false).square / kPictures;
        const Outcome a = run(std::uint64_t(10000 + k), true, false);
        two.mean += (a.mean - 1) / kPictures;
        squares += (a.mean - 1) * (a.mean - 1) / kPictures;
        two.square += a.square / kPictures;
        two.variance += a.variance / kPictures;
        off += (a.square - a.variance) / kPictures;
        off_squares += std::pow(a.square - a.variance, 2) / kPictures;
        reused.mean += (run(std::uint64_t(20000 + k), true, true).mean - 1) / kPictures;
    }
    const double error = std::sqrt(squares / kPictures);
    std::printf(
        "mean off by %+.1f standard errors (%+.1f if the pilot were kept); %.2f of the squared error of even "
        "samples; variance off by %+.1f standard errors\n",
        two.mean / error, reused.mean / error, two.square / even.square, off / std::sqrt(off_squares / kPictures));
    EXPECT_NEAR(two.mean, 0, 5 * error);
    EXPECT_NEAR(off, 0, 5 * std::sqrt(off_squares / kPictures));
    EXPECT_LT(two.square, 0.5 * even.square);
}

}  // namespace
}  // namespace etalon
