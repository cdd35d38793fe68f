#include "engine/image/adaptive.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numeric>
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
            out.at(pixel) = film.samples + group.samples;
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
        for (const std::uint64_t spp : {16u, 18u, 100u, 1024u}) {
            const Film film = known(size.x, size.y, [](int x, int) { return x < 32 ? 1.0 : 6.0; });
            const auto samples = samples_of(film, plan_samples(film, spp, AdaptiveGoal::error));
            // Tiles at the border are smaller, and may be those with more.
            EXPECT_LE(mean_of(samples), 1.1 * double(spp)) << size.x << " " << spp;
            for (const std::uint64_t s : samples) {
                EXPECT_EQ(s % 2, 0u);
                EXPECT_GE(s, std::max<std::uint64_t>(16, spp / 8 * 2));
                EXPECT_LE(s, 16 * spp);
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
        EXPECT_EQ(groups[0].samples, 48u) << "besides the 16 of the pilot";
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

/// A quarter of a picture of 32 x 32 pixels has rare bright samples; all have the mean 1.
double draw(std::size_t pixel, std::mt19937_64& random)
{
    const double u = std::generate_canonical<double, 32>(random);
    return pixel % 32 < 16 && pixel / 32 < 16 ? (u < 0.02 ? 50.0 : 0.0) : 0.9 + 0.2 * u;
}

Film sampled(std::span<const std::uint32_t> pixels, std::uint64_t samples, std::mt19937_64& random)
{
    Film film;
    film.width = static_cast<int>(pixels.size());
    film.height = 1;
    film.samples = samples;
    for (const std::uint32_t pixel : pixels) {
        double mean = 0, m2 = 0;
        for (std::uint64_t n = 1; n <= samples; ++n) {
            const double delta = draw(pixel, random) - mean;
            mean += delta / double(n);
            m2 += delta * delta * double(n - 1) / double(n);
        }
        film.mean.emplace_back(float(mean));
        film.variance.emplace_back(float(m2 / double(samples - 1) / double(samples)));
        film.alpha.push_back(1);
    }
    return film;
}

struct Outcome {
    double mean = 0, square = 0, variance = 0;
};
Outcome outcome(const Film& film)
{
    Outcome out;
    for (std::size_t i = 0; i < film.mean.size(); ++i) {
        out.mean += double(film.mean[i].x) / double(film.mean.size());
        out.square += std::pow(double(film.mean[i].x) - 1, 2) / double(film.mean.size());
        out.variance += double(film.variance[i].x) / double(film.mean.size());
    }
    return out;
}

std::vector<std::uint32_t> all_pixels()
{
    std::vector<std::uint32_t> out(32 * 32);
    std::iota(out.begin(), out.end(), 0u);
    return out;
}

Outcome adaptive(std::uint64_t seed)
{
    std::mt19937_64 random(seed);
    Film film = sampled(all_pixels(), 8, random);
    film.width = film.height = 32;
    const std::vector<SampleGroup> groups = plan_samples(film, 32, AdaptiveGoal::error);
    film.counts.assign(film.pixel_count(), 8);
    for (const SampleGroup& group : groups)
        if (group.samples > 0) add_samples(film, sampled(group.pixels, group.samples, random), group.pixels);
    return outcome(film);
}

/// What it must not be: every pixel's own first samples decide of it.
Outcome decided_by_itself(std::uint64_t seed)
{
    std::mt19937_64 random(seed);
    Film film = sampled(all_pixels(), 8, random);
    film.counts.assign(film.pixel_count(), 8);
    for (const std::uint32_t pixel : all_pixels()) {
        const std::array one{pixel};
        if (film.variance[pixel].x > 0.01f) add_samples(film, sampled(one, 48, random), one);
    }
    return outcome(film);
}

TEST(Adaptive, MC_11_samples_dealt_out_are_unbiased_have_less_error_and_say_how_much)
{
    // 600 pictures; five standard errors, a false alarm in two million for each of the two equalities.
    constexpr int kPictures = 600;
    Outcome even, dealt;
    double squares = 0, off = 0, off_squares = 0, biased = 0;
    for (int k = 0; k < kPictures; ++k) {
        const auto seed = static_cast<std::uint64_t>(k);
        std::mt19937_64 random(seed);
        even.square += outcome(sampled(all_pixels(), 32, random)).square / kPictures;
        const Outcome one = adaptive(10000 + seed);
        dealt.mean += (one.mean - 1) / kPictures;
        squares += (one.mean - 1) * (one.mean - 1) / kPictures;
        dealt.square += one.square / kPictures;
        off += (one.square - one.variance) / kPictures;
        off_squares += std::pow(one.square - one.variance, 2) / kPictures;
        biased += (decided_by_itself(20000 + seed).mean - 1) / kPictures;
    }
    const double error = std::sqrt(squares / kPictures), of_variance = std::sqrt(off_squares / kPictures);
    std::printf(
        "mean off by %+.1f standard errors (%+.0f where pixels decide of themselves); %.2f of the squared error "
        "of even samples; variance off by %+.1f standard errors\n",
        dealt.mean / error, biased / error, dealt.square / even.square, off / of_variance);
    EXPECT_NEAR(dealt.mean, 0, 5 * error);
    EXPECT_NEAR(off, 0, 5 * of_variance);
    EXPECT_LT(dealt.square, 0.5 * even.square);
    EXPECT_GT(std::abs(biased), 5 * error) << "the test sees no bias where there is one";
}

}  // namespace
}  // namespace etalon
