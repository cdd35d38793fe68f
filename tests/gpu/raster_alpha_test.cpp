#include "tests/gpu/raster_stage.h"

namespace etalon::test {
namespace {

class RasterAlpha : public DeviceTest {};

Material with_alpha(Material material, AlphaMode mode)
{
    material.alpha_mode = mode;
    return material;
}

TEST_F(RasterAlpha, mask_drops_what_is_below_the_cutoff_and_opaque_ignores_alpha)
{
    struct Case {
        AlphaMode mode;
        double alpha;
        float drawn;
    };
    for (const Case& c :
         {Case{AlphaMode::mask, 0.49, 0.f}, Case{AlphaMode::mask, 0.5, 1.f}, Case{AlphaMode::opaque, 0.1, 1.f}}) {
        SceneBuilder scene("mask");
        scene.show("wall", wall(), scene.material(with_alpha(unlit({1, 1, 1, c.alpha}), c.mode)));
        EXPECT_EQ(draw(device(), std::move(scene), transparent(4)).alpha[40], c.drawn) << c.alpha;
    }
}

TEST_F(RasterAlpha, blend_goes_over_what_is_behind_farthest_first_whatever_the_order_of_draws)
{
    for (const bool far_first : {true, false}) {
        SceneBuilder scene("blend");
        const Index red = scene.material(with_alpha(unlit({1, 0, 0, 0.5}), AlphaMode::blend));
        const Index blue = scene.material(with_alpha(unlit({0, 0, 1, 0.25}), AlphaMode::blend));
        if (far_first) scene.show("far", wall(-1), red);
        scene.show("near", wall(1), blue);
        if (!far_first) scene.show("far", wall(-1), red);
        scene.show("opaque", wall(-2), scene.material(unlit({0, 1, 0, 1})));
        const Film film = draw(device(), std::move(scene), transparent(4));
        // Green 1, then red over it by 1/2, then blue by 1/4.
        EXPECT_EQ(center(film), vec3(0.375f, 0.375f, 0.25f));
        EXPECT_EQ(film.alpha[40], 1.f);
    }
}

TEST_F(RasterAlpha, blend_alone_leaves_premultiplied_radiance_and_its_alpha)
{
    SceneBuilder scene("blend");
    scene.show("glass", wall(), scene.material(with_alpha(unlit({1, 0.5, 0, 0.25}), AlphaMode::blend)));
    const Film film = draw(device(), std::move(scene), transparent(4));
    EXPECT_EQ(center(film), vec3(0.25f, 0.125f, 0.f));
    EXPECT_EQ(film.alpha[40], 0.25f);
}

TEST_F(RasterAlpha, blend_is_hidden_by_opaque_surfaces_in_front)
{
    SceneBuilder scene("blend");
    scene.show("glass", wall(-1), scene.material(with_alpha(unlit({1, 1, 1, 0.5}), AlphaMode::blend)));
    scene.show("opaque", wall(0), scene.material(unlit({0, 1, 0, 1})));
    EXPECT_EQ(center(draw(device(), std::move(scene))), vec3(0, 1, 0));
}

TEST_F(RasterAlpha, background_is_a_colour_nothing_or_the_environment)
{
    const auto empty = [&](Background background) {
        SceneBuilder scene("empty");
        scene.environment(constant_environment({1, 2, 3}));
        RenderSettings settings;
        settings.background = background;
        settings.background_color = dvec3(0.25, 0.5, 0.75);
        return draw(device(), std::move(scene), settings);
    };
    EXPECT_EQ(center(empty(Background::environment)), vec3(1, 2, 3));
    EXPECT_EQ(empty(Background::environment).alpha[40], 1.f);
    EXPECT_EQ(center(empty(Background::colour)), vec3(0.25f, 0.5f, 0.75f));
    EXPECT_EQ(empty(Background::colour).alpha[40], 1.f);
    EXPECT_EQ(center(empty(Background::transparent)), vec3(0));
    EXPECT_EQ(empty(Background::transparent).alpha[40], 0.f);
}

}  // namespace
}  // namespace etalon::test
