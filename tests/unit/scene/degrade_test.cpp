#include "engine/scene/degrade.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/error.h"

namespace etalon {
namespace {

Footprint need(std::uint64_t textures, std::uint64_t picture)
{
    return {.program = 100, .geometry = 50, .textures = textures, .picture = picture};
}

// One image of grey codes, as a base colour or as a normal map.
Scene scene_of(int width, int height, std::vector<std::uint8_t> greys, bool is_colour)
{
    Scene scene;
    Texels image{.width = width, .height = height};
    for (const std::uint8_t grey : greys) image.bytes.insert(image.bytes.end(), {grey, grey, grey, 255});
    scene.images.push_back(std::move(image));
    scene.textures.push_back({.image = 0});
    Material material;
    (is_colour ? material.base_color_texture : material.normal_texture).texture = 0;
    scene.materials.push_back(material);
    return scene;
}

TEST(Degrade, what_fits_is_left_alone)
{
    EXPECT_FALSE(plan_degradation(need(400, 400), {640, 480}, 950).any());
}

TEST(Degrade, what_takes_more_is_halved_first_and_no_further_than_needed)
{
    const Degradation textures = plan_degradation(need(4000, 400), {640, 480}, 1600);
    EXPECT_EQ(textures.textures, 1);
    EXPECT_EQ(textures.picture, 0);
    const Degradation picture = plan_degradation(need(400, 4000), {640, 480}, 1600);
    EXPECT_EQ(picture.textures, 0);
    EXPECT_EQ(picture.picture, 1);
    const Degradation both = plan_degradation(need(4000, 3999), {640, 480}, 2200);
    EXPECT_EQ(both.textures, 1);
    EXPECT_EQ(both.picture, 1);
}

TEST(Degrade, program_and_geometry_alone_too_large_are_refused)
{
    EXPECT_THROW(plan_degradation(need(4000, 4000), {640, 480}, 149), Error);
    // A picture of 16 pixels is not made smaller still.
    EXPECT_THROW(plan_degradation(need(0, 4000), {16, 4096}, 1000), Error);
}

TEST(Degrade, a_size_is_halved_down_to_one)
{
    EXPECT_EQ(halved({640, 401}, 1), ivec2(320, 200));
    EXPECT_EQ(halved({3, 1}, 5), ivec2(1, 1));
}

TEST(Degrade, colours_are_averaged_in_linear_light_and_other_values_as_they_are)
{
    Scene colour = scene_of(2, 2, {0, 255, 0, 255}, true);
    halve_images(colour, 1);
    EXPECT_EQ(colour.images[0].width, 1);
    EXPECT_EQ(colour.images[0].bytes, (std::vector<std::uint8_t>{188, 188, 188, 255}));  // sRGB of 0.5
    Scene normal = scene_of(2, 2, {0, 254, 0, 254}, false);
    halve_images(normal, 1);
    EXPECT_EQ(normal.images[0].bytes, (std::vector<std::uint8_t>{127, 127, 127, 255}));
}

TEST(Degrade, odd_sides_keep_every_texel_by_its_share)
{
    Scene scene = scene_of(5, 1, {0, 0, 100, 0, 0}, false);  // two texels of two and a half each
    halve_images(scene, 1);
    ASSERT_EQ(scene.images[0].width, 2);
    EXPECT_EQ(scene.images[0].bytes[0], 20);
    EXPECT_EQ(scene.images[0].bytes[4], 20);
}

TEST(Degrade, the_change_is_the_spread_of_what_was_averaged)
{
    Scene flat = scene_of(4, 4, std::vector<std::uint8_t>(16, 90), false);
    EXPECT_EQ(halve_images(flat, 2), 0);
    Scene stripes = scene_of(4, 1, {0, 200, 0, 200}, false);  // a mean of 100 and a deviation of 100
    EXPECT_NEAR(halve_images(stripes, 1), 1, 1e-12);
    Scene steps = scene_of(4, 1, {50, 50, 150, 150}, false);  // seen only by the second halving
    EXPECT_NEAR(halve_images(steps, 2), 0.5, 1e-12);
}

TEST(Degrade, wide_texels_stay_wide)
{
    Scene scene = scene_of(1, 1, {0}, false);
    scene.images[0] = {.width = 2, .height = 1, .is_8_bit = false, .wide = {0, 1, 2, 1, 4, 3, 4, 0.5f}};
    halve_images(scene, 1);
    EXPECT_EQ(scene.images[0].wide, (std::vector<float>{2, 2, 3, 0.75f}));
}

}  // namespace
}  // namespace etalon
