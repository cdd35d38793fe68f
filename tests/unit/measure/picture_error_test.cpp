#include "engine/measure/picture_error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>

#include "engine/math/stats.h"
#include "tests/support/errors.h"
#include "tests/unit/measure/films.h"

namespace etalon {
namespace {

constexpr int kWidth = 96, kHeight = 64;

Film film_of(const std::function<vec3(int, int)>& value)
{
    Film film{.width = kWidth, .height = kHeight, .samples = 1};
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) film.mean.push_back(value(x, y));
    film.alpha.assign(film.pixel_count(), 1);
    return film;
}

/// A picture with soft shading, and an error that is small in most pixels and large along an edge, as a rasterizer's.
Film truth_picture()
{
    return film_of([](int x, int y) { return vec3(float(0.2 + 0.01 * y + (x > 50 ? 0.4 : 0.0))); });
}
Film wrong_picture()
{
    Film film = truth_picture();
    for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
            vec3& value = film.mean[std::size_t(y * kWidth + x)];
            value *= 1.05f;
            if (x == 50) value += vec3(0.2f);
            if (y > 48 && x < 20) value *= 0.6f;
        }
    }
    return film;
}

/// What `samples` samples of `draw` (mean 1) in each probed pixel would find.
PixelProbe traced(PixelProbe probe, const Film& truth, int samples, const test::Draw& draw, std::uint64_t seed)
{
    std::mt19937_64 random(seed);
    probe.truth = {.width = int(probe.pixels.size()), .height = 1, .samples = std::uint64_t(samples)};
    for (const std::uint32_t pixel : probe.pixels) {
        vec3 mean, variance;
        for (int c = 0; c < 3; ++c) {
            double m = 0, m2 = 0;
            for (int n = 1; n <= samples; ++n) {
                const double delta = double(truth.mean[pixel][c]) * draw(random) - m;
                m += delta / n;
                m2 += delta * delta * (n - 1) / n;
            }
            mean[c] = float(m);
            variance[c] = float(m2 / (samples - 1) / samples);
        }
        probe.truth.mean.push_back(mean);
        probe.truth.variance.push_back(variance);
        probe.truth.alpha.push_back(1);
    }
    return probe;
}

/// Every figure by all pixels and without noise.
PictureError measured_everywhere(const Film& film, const Film& truth)
{
    PixelProbe probe = choose_pixels(kWidth, kHeight, std::size_t(kWidth * kHeight), 1);
    return measure_picture(film,
                           traced(
                               probe, truth, 2, [](std::mt19937_64&) { return 1.0; }, 1),
                           {});
}

TEST(PictureError, pixels_are_drawn_once_and_evenly)
{
    const PixelProbe probe = choose_pixels(1280, 720, 2048, 7);
    EXPECT_EQ(std::set<std::uint32_t>(probe.pixels.begin(), probe.pixels.end()).size(), probe.pixels.size());
    EXPECT_NEAR(double(probe.pixels.size()), 2048, 200);
    double weights = 0;
    std::size_t begin = 0;
    for (std::size_t h = 0; h < probe.ends.size(); ++h) {
        weights += probe.weight(h);
        const int cx = int(h) % probe.cells_x, cy = int(h) / probe.cells_x;
        EXPECT_GT(probe.ends[h], begin + 1);
        for (; begin < probe.ends[h]; ++begin) {
            const int x = int(probe.pixels[begin] % 1280), y = int(probe.pixels[begin] / 1280);
            EXPECT_TRUE(1280 * cx / probe.cells_x <= x && x < 1280 * (cx + 1) / probe.cells_x);
            EXPECT_TRUE(720 * cy / probe.cells_y <= y && y < 720 * (cy + 1) / probe.cells_y);
        }
    }
    EXPECT_NEAR(weights, 1, 1e-12);
}

TEST(PictureError, tiny_and_narrow_pictures_have_a_probe_too)
{
    for (const ivec2 size : {ivec2(1, 1), ivec2(1, 5000), ivec2(5000, 1), ivec2(7, 3), ivec2(64, 48)}) {
        const PixelProbe probe = choose_pixels(size.x, size.y, 2048, 7);
        EXPECT_GE(probe.pixels.size(), std::size_t(std::min(size.x * size.y, 1024)));
        for (const std::uint32_t pixel : probe.pixels) EXPECT_LT(pixel, std::uint32_t(size.x * size.y));
    }
    EXPECT_THAT(test::message_of([] { choose_pixels(0, 4, 10, 1); }), testing::HasSubstr("no pixels"));
}

TEST(PictureError, a_known_error_is_found_as_it_is)
{
    const Film truth = film_of([](int, int) { return vec3(0.5f); });
    const Film off = film_of([](int, int) { return vec3(0.6f); });
    const PictureError error = measured_everywhere(off, truth);
    EXPECT_NEAR(error.rmse.value, 0.1, 1e-6);
    EXPECT_NEAR(error.relative.value, 0.2, 1e-6);
    EXPECT_NEAR(error.relmse.value, 0.04 / 1.01, 1e-6);
    EXPECT_NEAR(error.brightness.value, 0.2, 1e-6);
    EXPECT_NEAR(error.display.value, 255 * (srgb_from_linear(0.6) - srgb_from_linear(0.5)), 1e-3);
    EXPECT_FALSE(error.systematic);
    for (const double cell : error.map) EXPECT_NEAR(cell, 0.2, 1e-6);
}

struct Tally {
    std::uint64_t relative = 0, relmse = 0, display = 0, brightness = 0;
    double mean_square = 0;
};

/// How often intervals of probes with noise hold the figure of the whole picture.
Tally covered(const Film& film, const Film& truth, int trials, int samples, const test::Draw& draw)
{
    const PictureError whole = measured_everywhere(film, truth);
    const auto holds = [](const Estimate& e, double value) { return e.low <= value && value <= e.high; };
    Tally out;
    for (int trial = 0; trial < trials; ++trial) {
        PixelProbe probe = choose_pixels(kWidth, kHeight, 1024, 100 + std::uint64_t(trial));
        probe = traced(std::move(probe), truth, samples, draw, 9000 + std::uint64_t(trial));
        const PictureError error = measure_picture(film, probe, {});
        out.relative += holds(error.relative, whole.relative.value);
        out.relmse += holds(error.relmse, whole.relmse.value);
        out.display += holds(error.display, whole.display.value);
        out.brightness += holds(error.brightness, whole.brightness.value);
        out.mean_square += error.rmse.value * error.rmse.value / trials;
    }
    return out;
}

/// The least successes that an honest 95% interval has in 999 of 1000 runs.
std::uint64_t least(int trials)
{
    std::uint64_t k = std::uint64_t(trials);
    while (k > 0 && binomial_upper_tail(k, std::uint64_t(trials), 0.95) < 0.999) --k;
    return k;
}

TEST(PictureError, the_intervals_hold_the_whole_pictures_figures_as_often_as_they_say)
{
    constexpr int kTrials = 200;
    const Film truth = truth_picture(), film = wrong_picture();
    const Tally tally = covered(film, truth, kTrials, 64, test::exponential);
    EXPECT_GE(tally.relative, least(kTrials));
    EXPECT_GE(tally.relmse, least(kTrials));
    EXPECT_GE(tally.display, least(kTrials));
    EXPECT_GE(tally.brightness, least(kTrials));
    const double whole = measured_everywhere(film, truth).rmse.value;
    EXPECT_NEAR(std::sqrt(tally.mean_square) / whole, 1, 0.03) << "the probe's noise is taken off";
}

TEST(PictureError, a_perfect_picture_has_no_error_within_its_interval_however_noisy_the_probe)
{
    constexpr int kTrials = 200;
    const Film truth = truth_picture();
    std::uint64_t zero = 0;
    for (int trial = 0; trial < kTrials; ++trial) {
        PixelProbe probe = choose_pixels(kWidth, kHeight, 1024, 100 + std::uint64_t(trial));
        probe = traced(std::move(probe), truth, 16, test::exponential, 500 + std::uint64_t(trial));
        zero += measure_picture(truth, probe, {}).relative.low == 0;
    }
    EXPECT_GE(zero, least(kTrials));
}

TEST(PictureError, of_a_path_traced_picture_the_part_that_is_not_noise_is_told_apart)
{
    const Film truth = film_of([](int x, int y) { return vec3(float(test::ramp(x, y, 0))); });
    // 64 samples a pixel of noise 1 and a twentieth of the light lost.
    Film film = test::noisy_film(kWidth, kHeight, 64, 3, test::exponential,
                                 [](int x, int y, int) { return 0.95 * test::ramp(x, y, 0); });
    PixelProbe probe = choose_pixels(kWidth, kHeight, 2048, 5);
    const PictureError error = measure_picture(film, traced(std::move(probe), truth, 256, test::exponential, 4), {});
    ASSERT_TRUE(error.systematic);
    EXPECT_NEAR(error.relative.value, std::hypot(0.05, 0.95 / 8) * 1.04, 0.01) << "noise and loss together";
    EXPECT_LT(error.systematic->low, 0.055);
    EXPECT_GT(error.systematic->high, 0.05);
    EXPECT_LT(error.brightness.low, -0.05);
    EXPECT_GT(error.brightness.high, -0.05);
}

TEST(PictureError, the_map_shows_where)
{
    const PictureError error = measured_everywhere(wrong_picture(), truth_picture());
    const auto cell = [&](int x, int y) {
        return error.map[std::size_t(y * error.cells_y / kHeight * error.cells_x + x * error.cells_x / kWidth)];
    };
    EXPECT_GT(cell(10, 60), 3 * cell(10, 10));
    const Image map = picture_error_map(error);
    EXPECT_EQ(map.width, error.cells_x);
    EXPECT_EQ(map.height, error.cells_y);
}

TEST(PictureError, pixels_that_are_not_finite_are_counted_and_left_out)
{
    Film film = wrong_picture();
    const Film truth = truth_picture();
    const double before = measured_everywhere(film, truth).rmse.value;
    film.mean[5] = vec3(NAN);
    film.mean[6] = vec3(INFINITY);
    const PictureError error = measured_everywhere(film, truth);
    EXPECT_EQ(error.left_out, 2u);
    EXPECT_NEAR(error.rmse.value, before, 0.01 * before);
}

TEST(PictureError, words_and_json_say_the_same)
{
    const PictureError error = measured_everywhere(wrong_picture(), truth_picture());
    EXPECT_THAT(describe(error), testing::HasSubstr("95% interval"));
    EXPECT_THAT(picture_error_json(error), testing::HasSubstr("\"etalon-picture-error/1\""));
    EXPECT_THAT(picture_error_json(error), testing::HasSubstr(describe(error)));
    const PictureError none = measured_everywhere(truth_picture(), truth_picture());
    EXPECT_THAT(describe(none), testing::StartsWith("under "));
}

TEST(PictureError, a_probe_of_another_size_is_refused)
{
    PixelProbe probe = choose_pixels(8, 8, 64, 1);
    EXPECT_THAT(test::message_of([&] { measure_picture(truth_picture(), probe, {}); }),
                testing::HasSubstr("another size"));
}

}  // namespace
}  // namespace etalon
