#include "engine/image/metrics.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "engine/base/error.h"

namespace etalon {
namespace {

Image noise(int width, int height, int channels, double mean, double sigma, unsigned seed = 1)
{
    Image image(width, height, channels);
    std::mt19937 random(seed);
    std::normal_distribution<double> normal(mean, sigma);
    for (float& value : image.values) value = float(normal(random));
    return image;
}

Image plus(Image image, float amount)
{
    for (float& value : image.values) value += amount;
    return image;
}

TEST(Metrics, equal_pictures_are_identical)
{
    for (const double level : {0.5, 100.0, 0.0}) {
        const Image image = noise(40, 30, 3, level, 1e-4);
        const Metrics m = measure_difference(image, image);
        EXPECT_TRUE(m.identical);
        EXPECT_EQ(m.mse, 0);
        EXPECT_EQ(m.relmse, 0);
        EXPECT_EQ(m.max_abs, 0);
        EXPECT_EQ(m.psnr, std::nullopt) << "K2: no number is infinite";
        EXPECT_EQ(m.ssim, 1) << "K1: exactly";
    }
}

TEST(Metrics, a_known_difference_has_its_known_numbers)
{
    Image b(4, 4, 3), a;
    for (float& value : b.values) value = 0.5f;
    a = plus(b, 0.25f);
    const Metrics m = measure_difference(a, b);
    EXPECT_FALSE(m.identical);
    EXPECT_DOUBLE_EQ(m.mse, 0.0625);
    EXPECT_DOUBLE_EQ(m.rmse, 0.25);
    EXPECT_DOUBLE_EQ(m.max_abs, 0.25);
    EXPECT_DOUBLE_EQ(m.mean_a, 0.75);
    EXPECT_DOUBLE_EQ(m.mean_b, 0.5);
    EXPECT_DOUBLE_EQ(m.relmse, 0.0625 / (0.25 * (1 + kRelativeEpsilon)));
    ASSERT_TRUE(m.psnr);
    EXPECT_DOUBLE_EQ(*m.psnr, 10 * std::log10(16));
    // Flat pictures: SSIM is its luminance term.
    EXPECT_NEAR(m.ssim, (2 * 0.75 * 0.5 + 1e-4) / (0.75 * 0.75 + 0.5 * 0.5 + 1e-4), 1e-6);
}

TEST(Metrics, K4_relmse_does_not_depend_on_scale_and_survives_black)
{
    Image a = noise(16, 16, 3, 1, 0.2, 1), b = noise(16, 16, 3, 1, 0.2, 2);
    for (std::size_t i = 0; i < 20; ++i) b.values[i] = 0;
    const double relmse = measure_difference(a, b).relmse;
    EXPECT_GT(relmse, 0.01);
    for (const int k : {-100, -20, 20, 60}) {
        Image scaled_a = a, scaled_b = b;
        for (float& value : scaled_a.values) value = std::ldexp(value, k);
        for (float& value : scaled_b.values) value = std::ldexp(value, k);
        EXPECT_EQ(measure_difference(scaled_a, scaled_b).relmse, relmse) << k;
    }
    Image black(16, 16, 3);
    EXPECT_TRUE(std::isfinite(measure_difference(a, black).relmse));
    EXPECT_GT(measure_difference(a, black).relmse, 1);
    EXPECT_EQ(measure_difference(black, black).relmse, 0);
}

TEST(Metrics, K3_sums_do_not_depend_on_the_order_of_pixels)
{
    Image a = noise(300, 300, 1, 0.5, 0.1, 1), b = noise(300, 300, 1, 0.5, 0.1, 2);
    a.values[0] = 1e8f;  // one hot pixel first swallows the rest of a plain float sum
    const double mse = measure_difference(a, b).mse;
    std::ranges::reverse(a.values);
    std::ranges::reverse(b.values);
    EXPECT_NEAR(measure_difference(a, b).mse / mse, 1, 1e-15);
}

TEST(Metrics, K2_unlike_shapes_and_no_pixels_are_refused)
{
    EXPECT_THROW(measure_difference(Image(2, 3, 3), Image(3, 2, 3)), Error);
    EXPECT_THROW(measure_difference(Image(2, 3, 3), Image(2, 3, 4)), Error);
    EXPECT_THROW(measure_difference(Image(), Image()), Error);
    EXPECT_THROW(difference_picture(Image(2, 3, 3), Image(3, 2, 3), 1), Error);
}

TEST(Metrics, K2_values_that_are_not_finite_are_counted_and_left_out)
{
    Image a(4, 1, 1), b(4, 1, 1);
    a.values = {1, NAN, 1, INFINITY};
    b.values = {2, 1, INFINITY, INFINITY};
    const Metrics m = measure_difference(a, b);
    EXPECT_EQ(m.nonfinite_a, 2u);
    EXPECT_EQ(m.nonfinite_b, 2u);
    EXPECT_EQ(m.mse, 1);
    EXPECT_EQ(m.max_abs, 1);
    EXPECT_TRUE(std::isfinite(m.ssim));
    EXPECT_TRUE(measure_difference(a, a).identical) << "the same NaN on both sides is the same";
    Image all(1, 1, 1);
    all.values = {NAN};
    EXPECT_EQ(measure_difference(all, all).mse, 0);
}

TEST(Ssim, K1_is_symmetric_at_most_one_and_steady_on_bright_pictures)
{
    for (const double level : {0.5, 100.0, 1e6}) {
        // At 10^6 floats are 1/16 apart: noise of that size.
        const double sigma = level > 1000 ? 1 : 1e-4 * level;
        const Image a = noise(24, 24, 1, level, sigma, 1), b = noise(24, 24, 1, level, sigma, 2);
        const double s = structural_similarity(a, b, sigma);
        EXPECT_NEAR(s, structural_similarity(b, a, sigma), 1e-15);
        EXPECT_LE(s, 1);
        EXPECT_NEAR(s, 0, 0.25) << "independent noise has no structure in common, at " << level;
        EXPECT_EQ(structural_similarity(a, a, sigma), 1);
    }
}

TEST(Ssim, K1_keeps_the_variance_that_the_plain_form_cancels)
{
    // Two noises of variance 10^-8 on a level of 100, in a window of 11x11: the plain form in float has steps of 10^-3.
    const Image a = noise(11, 11, 1, 100, 1e-4, 1), b = noise(11, 11, 1, 100, 1e-4, 2);
    float sum = 0, squares = 0;
    for (const float value : a.values) {
        sum += value;
        squares += value * value;
    }
    const float mean = sum / 121;
    const float plain = squares / 121 - mean * mean;
    EXPECT_TRUE(plain <= 0 || plain > 1e-6f) << "the exhibit, " << plain;
    EXPECT_LT(structural_similarity(a, b, 1e-3), 0.9) << "unlike noise must show";
    EXPECT_GT(structural_similarity(a, plus(a, 1e-5f), 1e-3), 0.99);
}

TEST(Ssim, orders_pictures_by_damage_and_takes_any_size)
{
    const Image a = noise(20, 20, 1, 0.5, 0.2, 1);
    double last = 1;
    for (const float damage : {0.01f, 0.05f, 0.2f, 0.8f}) {
        Image b = a;
        const Image added = noise(20, 20, 1, 0, 1, 9);
        for (std::size_t i = 0; i < b.values.size(); ++i) b.values[i] += damage * added.values[i];
        const double s = structural_similarity(a, b, 1);
        EXPECT_LT(s, last);
        last = s;
    }
    for (const auto& [w, h] : {std::pair{1, 1}, {1, 5}, {30, 2}})
        EXPECT_EQ(structural_similarity(Image(w, h, 1), Image(w, h, 1), 1), 1);
    EXPECT_EQ(structural_similarity(Image(3, 3, 1), Image(3, 3, 1), 0), 1) << "black against black on no range";
}

TEST(DifferencePicture, brightness_grows_with_the_difference)
{
    Image a(256, 1, 1), b(256, 1, 1);
    for (int x = 0; x < 256; ++x) a.at(x, 0, 0) = float(x) / 255;
    const Image picture = difference_picture(a, b, 1);
    double last = -1;
    for (int x = 0; x < 256; ++x) {
        const double y = 0.2126 * double(picture.at(x, 0, 0)) + 0.7152 * double(picture.at(x, 0, 1)) +
                         0.0722 * double(picture.at(x, 0, 2));
        EXPECT_GT(y, last) << x;
        last = y;
    }
    EXPECT_EQ(picture.at(0, 0, 0), 0);
    EXPECT_EQ(picture.at(255, 0, 2), 1);
    EXPECT_EQ(difference_picture(a, b, 0.5).at(255, 0, 0), 1) << "saturates";
}

TEST(DifferencePicture, says_which_side_is_brighter_and_what_is_not_finite)
{
    using ::testing::ElementsAre;
    Image a(4, 1, 1), b(4, 1, 1);
    a.values = {2, 1, 1, NAN};
    b.values = {1, 2, 1, 1};
    EXPECT_THAT(signed_difference_picture(a, b, 1).values, ElementsAre(1, 0, 0, 0, 0, 1, 1, 1, 1, 0, 1, 0));
    EXPECT_THAT(signed_difference_picture(a, b, 2).values[1], 0.5f);
    const Image plain = difference_picture(a, b, 1);
    EXPECT_EQ(plain.at(3, 0, 1), 1);
    EXPECT_EQ(plain.at(3, 0, 0), 0);
}

}  // namespace
}  // namespace etalon
