#include "engine/image/develop.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "engine/base/error.h"
#include "tests/support/nasty.h"

namespace etalon {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;

Film pixel(const vec3& mean, float alpha = 1)
{
    Film film;
    film.width = film.height = 1;
    film.mean = {mean};
    film.alpha = {alpha};
    return film;
}

int code(double coded)
{
    return int(std::floor(255 * coded + 0.5));
}

TEST(Srgb, T10_every_code_returns_from_float_linear_light)
{
    int wrong_gamma = 0;
    for (int c = 0; c < 256; ++c) {
        EXPECT_EQ(code(srgb_from_linear(double(float(linear_from_srgb(c / 255.0))))), c);
        wrong_gamma += code(srgb_from_linear(std::pow(c / 255.0, 2.2))) != c ? 1 : 0;
    }
    EXPECT_EQ(wrong_gamma, 216) << "the exhibit: decoding by 2.2";
}

TEST(Srgb, T10_is_monotone_continuous_and_odd)
{
    EXPECT_NEAR(srgb_from_linear(0.0031308), srgb_from_linear(std::nextafter(0.0031308, 1)), 3e-8);
    EXPECT_NEAR(linear_from_srgb(0.04045), linear_from_srgb(std::nextafter(0.04045, 1)), 3e-8);
    double last = -1;
    for (double x = 0; x <= 1; x += 1e-5) {
        const double now = srgb_from_linear(x);
        ASSERT_GT(now, last);
        EXPECT_NEAR(linear_from_srgb(now), x, 1e-7);
        last = now;
    }
    EXPECT_EQ(srgb_from_linear(-0.3), -srgb_from_linear(0.3));
    EXPECT_EQ(linear_from_srgb(-0.3), -linear_from_srgb(0.3));
    EXPECT_NEAR(srgb_from_linear(1), 1, 1e-15);
    EXPECT_EQ(srgb_from_linear(0), 0);
    EXPECT_TRUE(std::isnan(srgb_from_linear(NAN)));
}

TEST(Develop, codes_clamps_and_keeps_alpha)
{
    EXPECT_THAT(develop(pixel(vec3(0.5f, 0, 7)), {}).values, ElementsAre(float(srgb_from_linear(0.5)), 0, 1, 1));
    EXPECT_THAT(develop(pixel(vec3(-1, 0, 0)), {}).values, ElementsAre(0, 0, 0, 1));
}

TEST(Develop, undoes_premultiplication)
{
    EXPECT_THAT(develop(pixel(vec3(0.25f, 0.125f, 0), 0.5f), {}).values,
                ElementsAre(float(srgb_from_linear(0.5)), float(srgb_from_linear(0.25)), 0, 0.5f));
    EXPECT_THAT(develop(pixel(vec3(0), 0), {}).values, ElementsAre(0, 0, 0, 0));
    EXPECT_THAT(develop(pixel(vec3(0.1f), 1e-30f), {}).values, ElementsAre(1, 1, 1, 1e-30f));
    EXPECT_THAT(develop(pixel(vec3(1), 1.5f), {}).values.back(), 1) << "rounding may push coverage over 1";
}

TEST(Develop, I9_whole_stops_are_exact_and_undo_each_other)
{
    const vec3 radiance(0.3f, 0.17f, 0.0411f);
    for (int ev = -60; ev <= 60; ++ev) {
        const Film film = pixel(radiance * std::ldexp(1.0f, -ev));
        EXPECT_EQ(develop(film, {.exposure = double(ev)}).values, develop(pixel(radiance), {}).values) << ev;
    }
    EXPECT_NEAR(develop(pixel(vec3(0.25f)), {.exposure = 0.5}).values[0], srgb_from_linear(0.25 * std::sqrt(2.0)),
                1e-6);
    for (const double ev : {double(NAN), double(INFINITY), 1e4})
        EXPECT_THROW(develop(pixel(vec3(1)), {.exposure = ev}), Error) << ev;
}

TEST(Develop, pixels_that_are_not_finite_are_magenta)
{
    for (const auto& [why, value] : nasty::not_finite<float>()) {
        EXPECT_THAT(develop(pixel(vec3(0.5f, value, 0.5f)), {}).values, ElementsAre(1, 0, 1, 1)) << why;
        EXPECT_THAT(develop(pixel(vec3(0.5f), value), {}).values, ElementsAre(1, 0, 1, 1)) << why;
    }
}

TEST(Develop, I8_tones_rise_to_white_over_the_whole_range_of_float)
{
    for (const Tone tone : {Tone::none, Tone::aces, Tone::neutral, Tone::reinhard, Tone::agx}) {
        float last = -1;
        for (float x = 1e-38f; x < std::numeric_limits<float>::max() / 2; x *= 1.5f) {
            const std::vector<float> now = develop(pixel(vec3(x)), {.exposure = 0, .tone = tone}).values;
            ASSERT_GE(now[0], last) << x << " tone " << int(tone);
            // AgX's matrices have four digits, and its curve ends at 0.9986.
            ASSERT_NEAR(now[0], now[1], tone == Tone::agx ? 2e-4 : 0) << "grey stays grey";
            last = now[0];
        }
        EXPECT_GT(last, tone == Tone::agx ? 0.998f : 0.999f) << int(tone);
        for (const auto& [why, value] : nasty::finite<float>())
            EXPECT_THAT(develop(pixel(vec3(value, 0.5f, 1)), {.exposure = 0, .tone = tone}).values,
                        Each(::testing::AllOf(::testing::Ge(0), ::testing::Le(1))))
                << why;
    }
}

TEST(Develop, aces_equals_its_formula)
{
    // Grey passes the two matrices but for their rounding, so the curve can be read off.
    const double v = 0.18 / 0.6;
    const double curve = (v * (v + 0.0245786) - 0.000090537) / (v * (0.983729 * v + 0.4329510) + 0.238081);
    const Image out = develop(pixel(vec3(0.18f)), {.exposure = 0, .tone = Tone::aces});
    EXPECT_NEAR(linear_from_srgb(double(out.values[1])), curve, 2e-4);
}

TEST(Develop, reinhard_and_agx_equal_published_values)
{
    // Middle grey: 0.18/1.18; and a colour of luminance 1 halves.
    EXPECT_NEAR(apply_tone(Tone::reinhard, dvec3(0.18)).x, 0.18 / 1.18, 1e-15);
    EXPECT_NEAR(apply_tone(Tone::reinhard, dvec3(1 / 0.2126, 0, 0)).x, 0.5 / 0.2126, 1e-12);
    EXPECT_NEAR(apply_tone(Tone::reinhard, dvec3(1e300)).y, 1, 1e-12);
    // By hand: log2(0.18) is at 0.60606 of the range; the polynomial there is 0.49673; its 2.2nd power.
    EXPECT_NEAR(apply_tone(Tone::agx, dvec3(0.18)).y, std::pow(0.49673, 2.2), 1e-3);
}

TEST(Exposure, I10_automatic_exposure_moves_against_the_light_and_ignores_what_is_not_light)
{
    Film film{.width = 4, .height = 1, .mean = {vec3(1), vec3(1), vec3(1), vec3(1)}, .alpha = {1, 1, 1, 1}};
    const double one = automatic_exposure(film);
    EXPECT_NEAR(one, std::log2(0.18), 1.0 / 16);
    for (vec3& c : film.mean) c *= 4.0f;
    EXPECT_EQ(automatic_exposure(film), one - 2) << "bins are exact";
    film.mean[0] = vec3(0);
    film.mean[1] = vec3(std::numeric_limits<float>::infinity());
    film.mean[2] = vec3(NAN, 1, 1);
    EXPECT_EQ(automatic_exposure(film), one - 2);
    film.mean[3] = vec3(-1);
    EXPECT_EQ(automatic_exposure(film), 0) << "nothing to go by";
}

TEST(Develop, neutral_equals_its_definition)
{
    const auto linear = [](const vec3& color) {
        const Image out = develop(pixel(color), {.exposure = 0, .tone = Tone::neutral});
        return dvec3(linear_from_srgb(double(out.values[0])), linear_from_srgb(double(out.values[1])),
                     linear_from_srgb(double(out.values[2])));
    };
    // A base colour lit by a dielectric carries 4% of Fresnel, which the tone takes back.
    EXPECT_NEAR(linear(vec3(0.54f)).x, 0.5, 1e-6);
    EXPECT_NEAR(linear(vec3(0.04f)).x, 6.25 * 0.04 * 0.04, 1e-6);
    // Where compression begins it is continuous with slope 1.
    EXPECT_NEAR(linear(vec3(0.8f)).x, 0.76, 1e-6);
    EXPECT_NEAR((linear(vec3(0.801f)).x - linear(vec3(0.799f)).x) / 0.002, 1, 0.01);
    // Peak 2.0 - 0.04: compressed to 1 - 0.24²/(1.96 + 0.24 - 0.76).
    const double peak = 1 - 0.24 * 0.24 / 1.44;
    EXPECT_NEAR(linear(vec3(2)).x, peak, 1e-6);
    const double to_white = 1 - 1 / (0.15 * (1.96 - peak) + 1);
    const dvec3 red = linear(vec3(2, 0.14f, 0.14f));
    EXPECT_NEAR(red.y, 0.1 * peak / 1.96 * (1 - to_white) + peak * to_white, 1e-6);
}

}  // namespace
}  // namespace etalon
