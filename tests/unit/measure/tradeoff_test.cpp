#include "engine/measure/tradeoff.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <random>
#include <set>
#include <thread>

#include "engine/measure/frontier.h"
#include "tests/support/files.h"

namespace etalon {
namespace {

Film constant_film(int side, float value, float variance)
{
    Film film{.width = side, .height = side};
    film.mean.assign(film.pixel_count(), vec3(value));
    film.variance.assign(film.pixel_count(), vec3(variance));
    film.alpha.assign(film.pixel_count(), 1);
    film.samples = 1000;
    return film;
}

Film noisy(const Film& truth, double deviation, std::uint64_t seed)
{
    Film film = truth;
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal(0, deviation);
    for (vec3& value : film.mean)
        for (int c = 0; c < 3; ++c) value[c] += static_cast<float>(normal(random));
    for (vec3& v : film.variance) v = vec3(static_cast<float>(deviation * deviation));
    return film;
}

TEST(Frontier, the_interval_of_a_median_holds_it_as_often_as_it_says)
{
    std::mt19937_64 random(7);
    std::exponential_distribution<double> skewed(1);
    constexpr int kTrials = 4000;
    int held = 0;
    double confidence = 0;
    for (int trial = 0; trial < kTrials; ++trial) {
        std::vector<double> values(9);
        for (double& value : values) value = skewed(random);
        const MedianInterval interval = median_interval(values);
        confidence = interval.confidence;
        held += interval.low <= std::log(2.0) && std::log(2.0) <= interval.high;
    }
    EXPECT_NEAR(confidence, 1 - 2 * 10 / 512.0, 1e-12) << "second smallest to second largest of nine";
    // 4 standard deviations of a binomial: a false alarm in 16,000.
    EXPECT_NEAR(held, kTrials * confidence, 4 * std::sqrt(kTrials * confidence * (1 - confidence)));
}

TEST(Frontier, few_values_have_their_whole_range_as_interval)
{
    const std::vector<double> values = {3, 1, 2};
    const MedianInterval interval = median_interval(values);
    EXPECT_EQ(interval.low, 1);
    EXPECT_EQ(interval.high, 3);
    EXPECT_NEAR(interval.confidence, 0.75, 1e-12);
    EXPECT_EQ(median_interval(std::vector<double>{5}).confidence, 0);
}

TEST(Frontier, the_references_noise_is_not_counted_as_error)
{
    const Film truth = constant_film(64, 1, 0);
    const Film reference = noisy(truth, 0.02, 1);
    const ErrorMeasurement exact = measure_error(truth, reference);
    // A picture without error against a noisy reference: nothing is left beyond chance.
    EXPECT_LT(std::abs(exact.relmse), 4 * exact.deviation);
    EXPECT_NEAR(exact.reference_share, 0.0004 / 1.01, 1e-5);
    EXPECT_FALSE(exact.resolved());

    Film biased = truth;
    for (vec3& value : biased.mean) value *= 1.2f;
    const ErrorMeasurement off = measure_error(biased, reference);
    EXPECT_NEAR(off.relmse, 0.04 / 1.01, 4 * off.deviation);
    EXPECT_TRUE(off.resolved());
}

TEST(Frontier, the_stated_deviation_is_the_scatter_over_references)
{
    const Film truth = constant_film(24, 1, 0);
    Film biased = truth;
    for (vec3& value : biased.mean) value *= 1.1f;
    std::vector<double> errors;
    double stated = 0;
    constexpr int kTrials = 300;
    for (int trial = 0; trial < kTrials; ++trial) {
        const ErrorMeasurement one = measure_error(biased, noisy(truth, 0.05, 100 + std::uint64_t(trial)));
        errors.push_back(one.relmse);
        stated += one.deviation / kTrials;
    }
    double mean = 0, squares = 0;
    for (const double error : errors) mean += error / kTrials;
    for (const double error : errors) squares += (error - mean) * (error - mean);
    const double scatter = std::sqrt(squares / (kTrials - 1));
    // The relative deviation of a standard deviation of 300 is 4%: 4 of those, and the clamp at d² = v.
    EXPECT_NEAR(stated / scatter, 1, 0.2);
    EXPECT_NEAR(mean, 0.01 / 1.01, 5 * scatter / std::sqrt(double(kTrials)));
}

TEST(Frontier, a_point_is_beaten_only_by_one_that_is_better_in_one_and_no_worse_in_the_other)
{
    const std::vector<CostAndError> points = {{1, 1}, {2, 0.5}, {2, 1}, {1, 1}, {3, 0.5}};
    EXPECT_THAT(times_beaten(points), testing::ElementsAre(0u, 0u, 3u, 0u, 1u));
}

TEST(Tradeoff, the_plan_has_each_standard_then_each_other_value_of_each_knob_then_combinations)
{
    TradeoffSettings settings;
    settings.combinations = 8;
    const std::vector<TradePoint> points = plan_tradeoff(settings, 1000);
    ASSERT_GE(points.size(), 4u);
    EXPECT_EQ(points[0].flags, "--renderer raster");
    EXPECT_EQ(points[1].flags, "--renderer path");
    std::set<std::string> flags;
    std::set<std::string> turned;
    std::size_t several = 0;
    for (const TradePoint& point : points) {
        EXPECT_TRUE(flags.insert(point.flags).second) << "twice: " << point.flags;
        if (point.turned == "several")
            ++several;
        else
            EXPECT_EQ(several, 0u) << point.flags;
        turned.insert(point.turned);
        EXPECT_EQ(points[point.base].settings.renderer, point.settings.renderer);
        EXPECT_LE(point.settings.spp, 1000u);
    }
    for (const char* knob : {"spp", "max-depth", "russian-roulette", "msaa", "mipmaps"})
        EXPECT_TRUE(turned.contains(knob)) << knob;
    EXPECT_FALSE(turned.contains("threads")) << "it changes no pixel";
    EXPECT_LE(several, 8u);
    EXPECT_GT(several, 0u);
}

// A renderer whose time and error are known: sleeping is all that it does for its time.
Film pretend(const RenderSettings& settings)
{
    Film truth = constant_film(16, 1, 0);
    if (settings.renderer == Renderer::raster) {
        if (settings.msaa == 4) std::this_thread::sleep_for(std::chrono::milliseconds(2));
        for (vec3& value : truth.mean) value *= settings.msaa == 4 ? 1.1f : 1.3f;
        return truth;
    }
    std::this_thread::sleep_for(std::chrono::microseconds(20 * settings.spp));
    Film film = noisy(truth, 1 / std::sqrt(double(settings.spp)), settings.seed);
    film.samples = settings.spp;
    return film;
}

TEST(Tradeoff, a_renderer_of_known_cost_and_error_is_measured_as_it_is)
{
    TradeoffSettings settings{.budget_seconds = 2, .rounds = 3, .combinations = 4};
    const Tradeoff out = measure_tradeoff({.scene = "pretend"}, settings,
                                          [](const RenderSettings& s, const Progress&) { return pretend(s); }, {});
    ASSERT_GE(out.points.size(), 4u);
    EXPECT_GE(out.reference.samples, 1000u);
    EXPECT_FALSE(out.interrupted);
    for (const TradePoint& point : out.points) {
        if (point.settings.renderer == Renderer::raster) {
            const double excess = point.settings.msaa == 4 ? 0.1 : 0.3;
            EXPECT_NEAR(point.error.relmse, excess * excess / 1.01, 5 * point.error.deviation + 1e-3) << point.flags;
        } else {
            const double expected = 1 / (1.01 * double(point.settings.spp));
            EXPECT_NEAR(point.error.relmse, expected, 0.35 * expected + 5 * point.error.deviation) << point.flags;
        }
    }
    std::size_t frontier = 0;
    for (const TradePoint& point : out.points) frontier += point.frontier;
    EXPECT_GE(frontier, 1u);
    EXPECT_LT(frontier, out.points.size());
    EXPECT_THAT(tradeoff_table(out), testing::HasSubstr("Frontier"));
    EXPECT_THAT(tradeoff_csv(out), testing::StartsWith("settings,turned,frontier"));
    EXPECT_THAT(tradeoff_html(out), testing::HasSubstr("<svg"));
    EXPECT_THAT(tradeoff_json(out), testing::HasSubstr("\"etalon-tradeoff/1\""));
}

TEST(Tradeoff, a_reference_that_resolves_the_standard_is_taken_from_the_cache)
{
    const test::TemporaryDirectory folder;
    const ReferenceCache cache(folder.path());
    TradeoffSettings settings{
        .budget_seconds = 0.5, .rounds = 1, .combinations = 0, .cache = &cache, .cache_key = "pretend"};
    settings.standard.spp = 2;
    const auto render = [](const RenderSettings& how, const Progress&) { return pretend(how); };
    const Tradeoff first = measure_tradeoff({}, settings, render, {});
    EXPECT_FALSE(first.reference_cached);
    const Tradeoff second = measure_tradeoff({}, settings, render, {});
    EXPECT_TRUE(second.reference_cached);
    EXPECT_EQ(second.reference.mean, first.reference.mean);
    EXPECT_EQ(second.reference.samples, first.reference.samples);
    settings.cache_key = "another scene";
    EXPECT_FALSE(measure_tradeoff({}, settings, render, {}).reference_cached);
}

TEST(Tradeoff, stop_keeps_what_is_measured)
{
    std::atomic<bool> stop = false;
    int calls = 0;
    const auto render = [&](const RenderSettings& settings, const Progress&) {
        if (++calls == 9) stop = true;
        return pretend(settings);
    };
    const TradeoffSettings settings{.budget_seconds = 1, .rounds = 3};
    const Tradeoff out = measure_tradeoff({}, settings, render, Progress({}, &stop));
    EXPECT_TRUE(out.interrupted);
    EXPECT_LT(out.points.size(), 4u);
    for (const TradePoint& point : out.points) EXPECT_FALSE(point.time.seconds.empty());
}

}  // namespace
}  // namespace etalon
