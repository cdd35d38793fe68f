// What no picture shows is found, folded into factors or shared, and nothing else is touched.
#include "engine/scene/simplify.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/scene/builder.h"

namespace etalon {
namespace {

using Texel = std::array<std::uint8_t, 4>;

struct Bench {
    SceneBuilder build{"bench"};
    Material material{};

    TextureUse texture(Texel texel, int size = 4, bool varies = false)
    {
        return build.texture("t", size, size, {}, [&](int x, int y) {
            Texel out = texel;
            if (varies && x == 1 && y == 0) out[0] ^= 1;
            return out;
        });
    }
    /// The material as simplified, and what was said.
    std::pair<Material, std::vector<Removal>> simplified()
    {
        build.show("wall", make_rectangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}), build.material(material));
        const Scene scene = std::move(build).finish();
        PosedScene posed = pose_whole(scene, {.size = ivec2(4)});
        const std::vector<Removal> removals = simplify(posed);
        return {posed.materials()[0], removals};
    }
};

TEST(Simplify, folds_ones_and_zeros_into_factors)
{
    Bench bench;
    bench.material.base_color = dvec4(0.2, 0.4, 0.6, 0.8);
    bench.material.base_color_texture = bench.texture({255, 0, 255, 17});
    const auto [material, removals] = bench.simplified();
    EXPECT_EQ(material.base_color, dvec4(0.2, 0, 0.6, 0.8));  // alpha is not read
    EXPECT_FALSE(material.base_color_texture.present());
    ASSERT_EQ(removals.size(), 1u);
    EXPECT_EQ(removals[0].pointer, "/materials/0/pbrMetallicRoughness/baseColorTexture");
    EXPECT_EQ(removals[0].what, "every texel read is 0 or 1 by channel");
}

TEST(Simplify, leaves_what_devices_would_round)
{
    const auto stays = [](Texel texel, bool varies, AlphaMode mode) {
        Bench bench;
        bench.material.alpha_mode = mode;
        bench.material.base_color_texture = bench.texture(texel, 4, varies);
        return bench.simplified().first.base_color_texture.present();
    };
    EXPECT_TRUE(stays({255, 254, 255, 255}, false, AlphaMode::opaque));
    EXPECT_TRUE(stays({255, 255, 255, 255}, true, AlphaMode::opaque));
    EXPECT_TRUE(stays({255, 255, 255, 128}, false, AlphaMode::blend));
    EXPECT_FALSE(stays({255, 255, 255, 128}, false, AlphaMode::opaque));
    EXPECT_FALSE(stays({255, 255, 255, 0}, false, AlphaMode::mask));
}

TEST(Simplify, does_not_turn_a_texture_of_0_into_the_absence_of_transmission)
{
    Bench bench;
    bench.material.layers.emplace().transmission = 1;
    bench.material.layers->transmission_texture = bench.texture({0, 0, 0, 0});
    const auto [material, removals] = bench.simplified();
    EXPECT_TRUE(material.layers->transmission_texture.present());
    EXPECT_TRUE(removals.empty());
}

TEST(Simplify, leaves_spheres_alone_which_have_no_texture_coordinates)
{
    SceneBuilder build("sphere");
    Material material;
    material.base_color_texture = build.texture("t", 2, 2, {}, [](int, int) { return Texel{0, 0, 0, 255}; });
    build.sphere("ball", {0, 0, 0}, 1, build.material(material));
    const Scene scene = std::move(build).finish();
    EXPECT_TRUE(pose(scene, {.size = ivec2(4)}).materials()[0].base_color_texture.present());
}

TEST(Simplify, reads_one_of_textures_that_are_alike)
{
    Bench bench;
    bench.material.base_color_texture = bench.texture({9, 8, 7, 6});
    bench.material.emissive_texture = bench.texture({9, 8, 7, 6});
    bench.material.normal_texture = bench.texture({9, 8, 7, 6}, 4, true);
    bench.material.emission = dvec3(1);
    bench.build.show("wall", make_rectangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}), bench.build.material(bench.material));
    Scene scene = std::move(bench.build).finish();
    share_equal_images(scene);
    EXPECT_EQ(scene.textures[1].image, 0u);
    EXPECT_EQ(scene.textures[2].image, 2u);
    PosedScene posed = pose_whole(scene, {.size = ivec2(4)});
    const std::vector<Removal> removals = simplify(posed);
    ASSERT_EQ(removals.size(), 1u);
    EXPECT_EQ(removals[0].pointer, "/materials/0/emissiveTexture");
    EXPECT_EQ(posed.materials()[0].emissive_texture.texture, 0u);
    EXPECT_EQ(posed.materials()[0].normal_texture.texture, 2u);
}

TEST(Simplify, textures_of_other_samplers_are_not_alike)
{
    SceneBuilder build("samplers");
    const auto grey = [](int, int) { return Texel{9, 8, 7, 6}; };
    Material material;
    material.base_color_texture = build.texture("a", 2, 2, {.wrap_u = Wrap::clamp_to_edge}, grey);
    material.emissive_texture = build.texture("b", 2, 2, {}, grey);
    material.emission = dvec3(1);
    build.show("wall", make_rectangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}), build.material(material));
    Scene scene = std::move(build).finish();
    share_equal_images(scene);
    EXPECT_EQ(pose(scene, {.size = ivec2(4)}).materials()[0].emissive_texture.texture, 1u);
}

TEST(Simplify, a_constant_image_is_held_small_in_its_shape)
{
    const auto image = [](int width, int height) {
        Texels out{.width = width, .height = height, .is_8_bit = true, .bytes = {}, .wide = {}};
        for (int i = 0; i < width * height; ++i) out.bytes.insert(out.bytes.end(), {1, 2, 3, 4});
        return out;
    };
    const std::optional<Texels> small = shrunk_constant(image(32, 8));
    ASSERT_TRUE(small);
    EXPECT_EQ(ivec2(small->width, small->height), ivec2(4, 1));
    EXPECT_THAT(small->bytes, testing::ElementsAre(1, 2, 3, 4, 1, 2, 3, 4, 1, 2, 3, 4, 1, 2, 3, 4));
    Texels differs = image(32, 8);
    differs.bytes.back() = 5;
    EXPECT_FALSE(shrunk_constant(differs));
    EXPECT_FALSE(shrunk_constant(image(3, 5)));  // nothing to gain
    EXPECT_FALSE(shrunk_constant(Texels{}));
}

}  // namespace
}  // namespace etalon
