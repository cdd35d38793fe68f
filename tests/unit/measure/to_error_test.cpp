#include "engine/measure/to_error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "engine/base/error.h"
#include "engine/math/stats.h"
#include "tests/support/errors.h"

namespace etalon {
namespace {

constexpr int kSide = 64;
constexpr double kDeviation = 0.5;  // of one sample, relative to the mean of 1

// A path tracer whose pixels are normal with known mean and deviation.
Film sampled(const RenderSettings& settings, const Progress& /*progress*/)
{
    Film film{.width = kSide, .height = kSide, .samples = settings.spp};
    std::mt19937_64 random(settings.seed);
    const double n = double(settings.spp);
    std::normal_distribution<double> mean(1, kDeviation / std::sqrt(n));
    std::chi_squared_distribution<double> squares(std::max(n - 1, 1.0));
    for (std::size_t i = 0; i < film.pixel_count(); ++i) {
        vec3 value, variance;
        for (int c = 0; c < 3; ++c) {
            value[c] = static_cast<float>(mean(random));
            variance[c] = static_cast<float>(kDeviation * kDeviation * squares(random) / (n - 1) / n);
        }
        film.mean.push_back(value);
        film.variance.push_back(variance);
        film.alpha.push_back(1);
    }
    return film;
}

double true_error(const Film& film)
{
    double squares = 0;
    for (const vec3& value : film.mean)
        for (int c = 0; c < 3; ++c) squares += (value[c] - 1.0) * (value[c] - 1.0);
    return std::sqrt(squares / (3.0 * double(film.pixel_count())));
}

TEST(ToError, the_true_error_is_under_the_asked_one_as_often_as_promised)
{
    constexpr int kRuns = 200;
    constexpr double kAsked = 0.02;
    std::uint64_t under = 0;
    for (int run = 0; run < kRuns; ++run) {
        const RenderSettings settings{.renderer = Renderer::path, .seed = std::uint64_t(run) + 1};
        const FilmToError made = render_to_error(settings, kAsked, 1 << 20, sampled, {});
        EXPECT_FALSE(made.capped);
        EXPECT_EQ(made.film.samples, made.asked_samples);
        under += true_error(made.film) <= kAsked;
        // (0.5 / 0.02)² = 625 samples are needed; the pilot's upper bound asks for a little more.
        EXPECT_LT(made.asked_samples, 625u * 5 / 4);
    }
    EXPECT_GE(binomial_interval(under, kRuns, 0.999).high, 0.95);
    EXPECT_GT(double(under) / kRuns, 0.9);
}

TEST(ToError, the_picture_is_that_of_so_many_samples_and_no_sample_of_the_pilot_is_in_it)
{
    RenderSettings settings{.renderer = Renderer::path, .seed = 5};
    const FilmToError made = render_to_error(settings, 0.1, 1 << 20, sampled, {});
    settings.spp = made.asked_samples;
    EXPECT_EQ(made.film.mean, sampled(settings, {}).mean);
    EXPECT_EQ(made.pilot_samples, 16u);
}

TEST(ToError, too_much_is_capped_and_said)
{
    const RenderSettings settings{.renderer = Renderer::path, .seed = 5};
    const FilmToError made = render_to_error(settings, 1e-6, 100, sampled, {});
    EXPECT_TRUE(made.capped);
    EXPECT_EQ(made.film.samples, 100u);
}

TEST(ToError, a_rasterizer_or_no_error_at_all_is_refused)
{
    const RenderSettings raster{.renderer = Renderer::raster};
    EXPECT_THAT(test::message_of([&] { render_to_error(raster, 0.1, 100, sampled, {}); }),
                testing::HasSubstr("--renderer path"));
    const RenderSettings path{.renderer = Renderer::path};
    EXPECT_THAT(test::message_of([&] { render_to_error(path, 0, 100, sampled, {}); }),
                testing::HasSubstr("cannot be reached"));
}

}  // namespace
}  // namespace etalon
