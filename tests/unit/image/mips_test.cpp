#include "engine/image/mips.h"

#include <gmock/gmock.h>

#include <numeric>
#include <random>

#include "engine/image/develop.h"

namespace etalon {
namespace {

using ::testing::ElementsAre;

double mean_of(const Image& image, int channel = 0)
{
    double sum = 0;
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) sum += double(image.at(x, y, channel));
    return sum / double(image.pixel_count());
}

Image noise(int width, int height, int channels)
{
    Image image(width, height, channels);
    std::mt19937 random(3);
    std::uniform_real_distribution<float> uniform;
    for (float& value : image.values) value = uniform(random);
    return image;
}

TEST(Mips, level_counts_and_sizes_are_those_of_vulkan)
{
    EXPECT_EQ(mip_levels(1, 1), 1);
    EXPECT_EQ(mip_levels(2, 1), 2);
    EXPECT_EQ(mip_levels(3, 5), 3);
    EXPECT_EQ(mip_levels(1024, 16), 11);
    const std::vector<Image> chain = mip_chain(Image(5, 3, 1));
    ASSERT_EQ(chain.size(), 3u);
    EXPECT_EQ(chain[1].width, 2);
    EXPECT_EQ(chain[1].height, 1);
    EXPECT_EQ(chain[2].width, 1);
}

TEST(Mips, T8_odd_sizes_lose_nothing)
{
    Image last_column(5, 1, 1);
    last_column.values = {0, 0, 0, 0, 1};
    const std::vector<Image> chain = mip_chain(last_column);
    EXPECT_THAT(chain[1].values, ElementsAre(0, 0.4f)) << "2-tap boxes would drop the last texel";
    EXPECT_FLOAT_EQ(chain[2].values[0], 0.2f);
}

TEST(Mips, T8_every_level_has_the_mean_of_the_first)
{
    for (const auto& [w, h] : {std::pair{1, 1}, {1, 37}, {37, 1}, {64, 64}, {63, 17}, {100, 3}, {7, 129}})
        for (const Image& level : mip_chain(noise(w, h, 3)))
            for (int c = 0; c < 3; ++c)
                EXPECT_NEAR(mean_of(level, c), mean_of(noise(w, h, 3), c), 1.2e-7)
                    << w << 'x' << h << " at " << level.width << 'x' << level.height;
}

TEST(Mips, power_of_two_levels_are_plain_boxes)
{
    const Image image = noise(8, 8, 2);
    const Image half = mip_chain(image)[1];
    for (int y = 0; y < 4; ++y)
        for (int x = 0; x < 4; ++x) {
            const double box = (double(image.at(2 * x, 2 * y, 1)) + double(image.at(2 * x + 1, 2 * y, 1)) +
                                double(image.at(2 * x, 2 * y + 1, 1)) + double(image.at(2 * x + 1, 2 * y + 1, 1))) /
                               4;
            EXPECT_EQ(half.at(x, y, 1), float(box));
        }
}

TEST(Shrink, does_not_depend_on_threads)
{
    const Image image = noise(301, 233, 4);
    EXPECT_EQ(shrink(image, 100, 77, 1).values, shrink(image, 100, 77, 3).values);
}

TEST(Shrink, SH_41_to_its_own_size_is_the_identity_and_constants_stay)
{
    const Image image = noise(31, 17, 3);
    EXPECT_EQ(shrink(image, 31, 17).values, image.values);
    Image constant(31, 17, 1);
    for (float& value : constant.values) value = 0.3f;
    for (const float value : shrink(constant, 10, 9).values) EXPECT_EQ(value, 0.3f);
}

TEST(Shrink, SH_41_growing_repeats_texels_by_their_share)
{
    Image two(2, 1, 1);
    two.values = {1, 4};
    EXPECT_THAT(shrink(two, 4, 1).values, ElementsAre(1, 1, 4, 4));
    EXPECT_THAT(shrink(two, 3, 1).values, ElementsAre(1, 2.5f, 4));
}

Texels texels_of(int width, int height, std::vector<std::uint8_t> bytes)
{
    Texels texels;
    texels.width = width;
    texels.height = height;
    texels.bytes = std::move(bytes);
    return texels;
}

TEST(LinearImage, T9_a_checker_of_black_and_white_is_half_the_light)
{
    const Texels checker = texels_of(2, 1, {0, 0, 0, 0, 255, 255, 255, 255});
    const Image small = mip_chain(linear_image(checker, true))[1];
    EXPECT_EQ(small.values[0], 0.5f);
    EXPECT_EQ(std::floor(255 * srgb_from_linear(double(small.values[0])) + 0.5), 188) << "not 128";
    EXPECT_EQ(small.values[3], 0.5f) << "alpha is linear";
}

TEST(LinearImage, decodes_colour_and_never_alpha)
{
    const Image srgb = linear_image(texels_of(1, 1, {188, 128, 255, 128}), true);
    EXPECT_EQ(srgb.values[1], float(linear_from_srgb(128 / 255.0)));
    EXPECT_EQ(srgb.values[2], 1);
    EXPECT_EQ(srgb.values[3], float(128 / 255.0));
    const Image linear = linear_image(texels_of(1, 1, {188, 128, 255, 128}), false);
    EXPECT_EQ(linear.values[1], float(128 / 255.0));

    Texels wide;
    wide.width = wide.height = 1;
    wide.is_8_bit = false;
    wide.wide = {0.5f, 0, 1, 0.5f};
    EXPECT_THAT(linear_image(wide, true).values, ElementsAre(float(linear_from_srgb(0.5)), 0, 1, 0.5f));
    EXPECT_THAT(linear_image(wide, false).values, ElementsAre(0.5f, 0, 1, 0.5f));
}

}  // namespace
}  // namespace etalon
