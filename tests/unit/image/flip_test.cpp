#include "engine/image/flip.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "tests/support/errors.h"

namespace etalon {
namespace {

constexpr int kWidth = 80, kHeight = 56;

// Pictures that a script of any language can make again: a coloured ramp inverted in a checker, and three spoilt ones.
double ramp(int x, int y, int c)
{
    const double base = 0.1 + 0.8 * x / (kWidth - 1) * (0.5 + 0.5 * c / 2);
    return (x / 8 + y / 8) % 2 == 0 ? 1 - base : base;
}

double hashed(std::uint32_t i)
{
    std::uint32_t x = i * 2654435761u;
    x ^= x >> 16;
    x *= 0x45d9f3bu;
    x ^= x >> 16;
    return x / 4294967296.0;
}

Image picture(const std::function<double(int, int, int)>& value)
{
    Image out(kWidth, kHeight, 3);
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x)
            for (int c = 0; c < 3; ++c)
                out.values[std::size_t((y * kWidth + x) * 3 + c)] = static_cast<float>(value(x, y, c));
    return out;
}

Image flat(double r, double g, double b)
{
    return picture([&](int, int, int c) { return c == 0 ? r : c == 1 ? g : b; });
}

float at(const Image& map, int x, int y)
{
    return map.values[std::size_t(y * kWidth + x)];
}

struct Known {
    const char* what;
    Image test;
    double mean, at_30_20, most;
};

// Values of the authors' own program: flip-evaluator 1.7 of PyPI, "LDR", 67.02 pixels per degree, in float32.
TEST(Flip, is_that_of_the_authors_program)
{
    const auto noise = [](int x, int y, int c) {
        return std::clamp(ramp(x, y, c) + 0.4 * (hashed(std::uint32_t((y * kWidth + x) * 3 + c)) - 0.5), 0.0, 1.0);
    };
    const auto shift = [](int x, int y, int c) { return ramp(std::min(x + 1, kWidth - 1), y, c); };
    const auto tint = [](int x, int y, int c) { return std::min(ramp(x, y, c) * (c == 0 ? 1.1 : 0.9), 1.0); };
    const Known known[] = {{"noise", picture(noise), 0.2104987, 0.2707695, 0.5491284},
                           {"shift", picture(shift), 0.1791437, 0.4579598, 0.6783660},
                           {"tint", picture(tint), 0.3144417, 0.2308209, 0.5379959}};
    const Image reference = picture(ramp);
    for (const auto& [what, test, mean, here, most] : known) {
        const Image map = flip(reference, test);
        EXPECT_NEAR(mean_flip(reference, test), mean, 2e-5) << what;
        EXPECT_NEAR(at(map, 30, 20), here, 2e-4) << what;
        EXPECT_NEAR(*std::max_element(map.values.begin(), map.values.end()), most, 2e-4) << what;
        EXPECT_NEAR(mean_flip(test, reference), mean, 2e-5) << what << ", the other way round";
    }
}

TEST(Flip, of_flat_pictures_is_the_redistributed_distance_of_their_colours)
{
    EXPECT_EQ(mean_flip(flat(0.3, 0.5, 0.7), flat(0.3, 0.5, 0.7)), 0);
    // Green and blue are what the scale ends at. Of black and white the distance is 100, all of it in lightness.
    EXPECT_NEAR(mean_flip(flat(0, 1, 0), flat(0, 0, 1)), 1, 1e-9);
    EXPECT_NEAR(mean_flip(flat(0, 0, 0), flat(1, 1, 1)), 0.96734, 5e-5);
    EXPECT_NEAR(mean_flip(flat(0.5, 0.5, 0.5), flat(0.52, 0.5, 0.5)), 0.0775147, 2e-5);
}

TEST(Flip, is_less_from_further_away)
{
    const Image a = picture(ramp);
    const Image b = picture([](int x, int y, int c) { return 0.95 * ramp(x, y, c) + ((x + y) % 2 == 0 ? 0.05 : 0.0); });
    EXPECT_LT(mean_flip(a, b, 120), mean_flip(a, b, 30));
}

TEST(Flip, other_sizes_are_refused_and_what_is_not_finite_is_black)
{
    EXPECT_THAT(test::message_of([] { flip(Image(4, 4, 3), Image(4, 5, 3)); }), testing::HasSubstr("sizes"));
    Image nan = flat(0, 0, 0);
    nan.values[100] = NAN;
    EXPECT_EQ(mean_flip(flat(0, 0, 0), nan), 0);
}

}  // namespace
}  // namespace etalon
