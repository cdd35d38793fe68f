#include "engine/reference/texture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/unit/reference/random.h"

namespace etalon::reference {
namespace {

using test::Random;

Texels grey_texels(int width, int height, const std::vector<std::uint8_t>& values)
{
    Texels texels{.width = width, .height = height, .is_8_bit = true, .bytes = {}, .wide = {}};
    for (const std::uint8_t v : values) texels.bytes.insert(texels.bytes.end(), {v, v, v, 255});
    return texels;
}

Texels random_texels(int width, int height)
{
    Random random(21);
    std::vector<std::uint8_t> values;
    for (int i = 0; i < width * height; ++i) values.push_back(static_cast<std::uint8_t>(256 * random.uniform()));
    return grey_texels(width, height, values);
}

dvec4 mean_of_level(const MipChain& mips, int level)
{
    const ivec2 size = mips.size(level);
    dvec4 sum(0);
    for (int y = 0; y < size.y; ++y)
        for (int x = 0; x < size.x; ++x) sum += mips.texel(level, x, y);
    return sum / static_cast<double>(size.x * size.y);
}

TEST(Texture, T5_wrapped_indices_are_inside_for_every_integer)
{
    EXPECT_EQ(wrap_texel(-1, 4, Wrap::repeat), 3);
    EXPECT_EQ(wrap_texel(-5, 4, Wrap::repeat), 3);
    EXPECT_EQ(wrap_texel(4, 4, Wrap::repeat), 0);
    EXPECT_EQ(wrap_texel(-1, 4, Wrap::mirrored_repeat), 0);
    EXPECT_EQ(wrap_texel(4, 4, Wrap::mirrored_repeat), 3);
    EXPECT_EQ(wrap_texel(7, 4, Wrap::mirrored_repeat), 0);
    EXPECT_EQ(wrap_texel(8, 4, Wrap::mirrored_repeat), 0);
    EXPECT_EQ(wrap_texel(-9, 4, Wrap::mirrored_repeat), 0);
    EXPECT_EQ(wrap_texel(-1, 4, Wrap::clamp_to_edge), 0);
    EXPECT_EQ(wrap_texel(99, 4, Wrap::clamp_to_edge), 3);
    for (const Wrap wrap : {Wrap::repeat, Wrap::mirrored_repeat, Wrap::clamp_to_edge})
        for (const int size : {1, 2, 3, 5, 1024})
            for (const long long i : {0LL, 1LL, -1LL, 1000000000000LL, -1000000000000LL}) {
                EXPECT_GE(wrap_texel(i, size, wrap), 0);
                EXPECT_LT(wrap_texel(i, size, wrap), size);
            }
}

TEST(Texture, T5_T7_coordinates_of_every_kind_read_some_texel)
{
    const Texels texels = random_texels(5, 3);
    const MipChain mips(texels, Coding::linear, true);
    for (const Wrap wrap : {Wrap::repeat, Wrap::mirrored_repeat, Wrap::clamp_to_edge})
        for (const double u : {0.0, 1.0, -1e-8, 1 - 1e-17, 1e6, -1e300, std::numeric_limits<double>::infinity(),
                               std::numeric_limits<double>::quiet_NaN()}) {
            const Sampler sampler{.wrap_u = wrap, .wrap_v = wrap};
            const dvec4 c = sample_mips(mips, sampler, {u, u}, 0);
            EXPECT_TRUE(c.x >= 0 && c.x <= 1) << u;
        }
    // A hair below 0 under repeat lies between the last and the first texel.
    const Sampler sampler;
    const dvec4 expected = 0.5 * mips.texel(0, 4, 1) + 0.5 * mips.texel(0, 0, 1);
    EXPECT_NEAR(sample_mips(mips, sampler, {-1e-12, 0.5}, 0).x, expected.x, 1e-9);
}

TEST(Texture, TX_3_bilinear_meets_texels_at_their_centres_and_their_mean_between)
{
    const Texels texels = grey_texels(2, 1, {0, 255});
    const MipChain mips(texels, Coding::linear, false);
    const Sampler clamp{.wrap_u = Wrap::clamp_to_edge, .wrap_v = Wrap::clamp_to_edge};
    EXPECT_EQ(sample_mips(mips, clamp, {0.25, 0.5}, 0).x, 0);
    EXPECT_EQ(sample_mips(mips, clamp, {0.75, 0.5}, 0).x, 1);
    EXPECT_EQ(sample_mips(mips, clamp, {0.5, 0.5}, 0).x, 0.5);
    EXPECT_EQ(sample_mips(mips, clamp, {0.0, 0.5}, 0).x, 0);
    const Sampler nearest{.mag = Filter::nearest};
    EXPECT_EQ(sample_mips(mips, nearest, {0.499, 0.5}, 0).x, 0);
    EXPECT_EQ(sample_mips(mips, nearest, {0.5, 0.5}, 0).x, 1);
}

TEST(Texture, T9_TX_5_colour_is_decoded_before_it_is_filtered)
{
    const Texels texels = grey_texels(2, 2, {0, 255, 255, 0});
    const MipChain mips(texels, Coding::srgb, true);
    ASSERT_EQ(mips.levels(), 2);
    EXPECT_NEAR(mips.texel(1, 0, 0).x, 0.5, 1e-15);  // 188 in sRGB, not the 128 of averaged codes
    EXPECT_NEAR(MipChain(grey_texels(1, 1, {188}), Coding::srgb, true).levels(), 1, 0);
    const Texels grey = grey_texels(1, 1, {128});
    EXPECT_NEAR(MipChain(grey, Coding::srgb, false).texel(0, 0, 0).x, 0.2158605, 1e-7);
    EXPECT_NEAR(MipChain(grey, Coding::linear, false).texel(0, 0, 0).x, 128 / 255.0, 0);
}

TEST(Texture, T8_every_level_has_the_mean_of_the_image_for_any_size)
{
    for (const ivec2 size : {ivec2(1, 1), ivec2(5, 1), ivec2(1, 7), ivec2(3, 5), ivec2(16, 16), ivec2(13, 24)}) {
        const Texels texels = random_texels(size.x, size.y);
        const MipChain mips(texels, Coding::linear, true);
        EXPECT_EQ(mips.size(mips.levels() - 1), ivec2(1, 1));
        for (int level = 1; level < mips.levels(); ++level)
            EXPECT_NEAR(mean_of_level(mips, level).x, mean_of_level(mips, 0).x, 1e-14) << size.x << "x" << size.y;
    }
    const Texels last = grey_texels(5, 1, {0, 0, 0, 0, 255});
    const MipChain chain(last, Coding::linear, true);
    EXPECT_NEAR(mean_of_level(chain, 2).x, 0.2, 1e-15);  // a dropped column would give 0
}

TEST(Texture, T1_T2_the_level_is_the_log_of_the_footprint_in_texels)
{
    EXPECT_EQ(mip_level({1, 0}, {0, 1}, 10), 0);
    EXPECT_EQ(mip_level({2, 0}, {0, 1}, 10), 1);
    EXPECT_EQ(mip_level({0, 1}, {3, 4}, 10), std::log2(5.0));
    EXPECT_EQ(mip_level({0, 0}, {0, 0}, 10), 0);
    EXPECT_EQ(mip_level({0.1, 0}, {0, 0.1}, 10), 0);
    EXPECT_EQ(mip_level({1e30, 0}, {0, 1}, 10), 9);
    EXPECT_EQ(mip_level({std::nan(""), 0}, {0, 1}, 10), 9);
    EXPECT_EQ(mip_level({std::numeric_limits<double>::infinity(), 0}, {0, 1}, 10), 9);
}

TEST(Texture, T3_trilinear_is_continuous_and_exact_at_whole_levels)
{
    const Texels texels = random_texels(16, 16);
    const MipChain mips(texels, Coding::linear, true);
    const Sampler sampler;
    const dvec2 uv(0.3, 0.7);
    for (int level = 1; level < mips.levels(); ++level) {
        const double at = sample_mips(mips, sampler, uv, level).x;
        EXPECT_NEAR(sample_mips(mips, sampler, uv, level - 1e-9).x, at, 1e-8);
        EXPECT_NEAR(sample_mips(mips, sampler, uv, level + 1e-9).x, at, 1e-8);
    }
    const double a = sample_mips(mips, sampler, uv, 1).x, b = sample_mips(mips, sampler, uv, 2).x;
    EXPECT_NEAR(sample_mips(mips, sampler, uv, 1.25).x, 0.75 * a + 0.25 * b, 1e-15);
    EXPECT_EQ(sample_mips(mips, sampler, uv, 99).x, mips.texel(4, 0, 0).x);
    const Sampler nearest_level{.mip = Filter::nearest};
    EXPECT_EQ(sample_mips(mips, nearest_level, uv, 1.4).x, a);
    EXPECT_EQ(sample_mips(mips, nearest_level, uv, 1.6).x, b);
}

TEST(Texture, R16_under_repeat_a_whole_number_added_to_uv_changes_nothing)
{
    const Texels texels = random_texels(8, 8);
    const MipChain mips(texels, Coding::linear, true);
    Random random(22);
    for (int i = 0; i < 200; ++i) {
        const dvec2 uv = random.square();
        EXPECT_NEAR(sample_mips(mips, {}, uv + dvec2(1000, -3), 0).x, sample_mips(mips, {}, uv, 0).x, 1e-12 * 1e3);
    }
}

}  // namespace
}  // namespace etalon::reference
