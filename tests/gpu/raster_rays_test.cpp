#include "engine/render/raster.h"
#include "engine/scene/load.h"
#include "tests/gpu/raster_stage.h"

// Rays of the rasterizer under the validation layers; what they find is asked in tests/agree.
namespace etalon::test {
namespace {

using RasterRays = DeviceTest;

RenderSettings with_rays(int paths)
{
    RenderSettings settings;
    settings.ambient_rays = paths;
    settings.shadows = Shadows::ray;
    return settings;
}

/// Points are listed by atomics in any order, and images come and go with the size: no bit depends on either.
TEST_F(RasterRays, SH_44_SH_45_are_the_same_bits_whatever_was_drawn_before)
{
    const Scene scene = make_builtin("lights");
    const PosedScene posed = pose(scene, {.size = ivec2(40, 30)});
    RenderSettings settings = with_rays(2);
    settings.aovs = true;  // other pipelines with the same bindings
    RasterScene raster(device(), posed, require(posed, settings), settings);
    View larger = posed.view;
    larger.width += 23;
    larger.height += 9;
    raster.draw(posed.view);
    const Film first = raster.read();
    raster.draw(larger);
    EXPECT_EQ(raster.read().width, 63);
    raster.draw(posed.view);
    const Film again = raster.read();
    EXPECT_EQ(again.mean, first.mean);
    EXPECT_EQ(again.alpha, first.alpha);
}

/// Before the wall stands another, across the view, in three kinds: solid, masked away, and blended at a quarter.
TEST_F(RasterRays, SH_6_what_is_masked_away_hides_nothing)
{
    const auto middle = [&](AlphaMode mode, double alpha) {
        SceneBuilder scene("screened");
        Material matt;
        matt.model = BsdfModel::lambert;
        matt.base_color = dvec4(0.5, 0.5, 0.5, 1);
        scene.show("wall", wall(), scene.material(matt));
        Material screen;
        screen.model = BsdfModel::lambert;
        screen.base_color = dvec4(0, 0, 0, alpha);
        screen.alpha_mode = mode;
        screen.double_sided = true;
        // Beside the picture, not before it.
        scene.show("screen", make_rectangle({1.5, 0, 2}, {0, 2, 0}, {0, 0, 2}), scene.material(screen));
        scene.environment(constant_environment(dvec3(1)));
        RenderSettings settings = with_rays(16);
        settings.max_depth = 2;
        return center(draw(device(), std::move(scene), settings)).x;
    };
    const float solid = middle(AlphaMode::opaque, 1);
    EXPECT_LT(solid, 0.45f);
    EXPECT_NEAR(middle(AlphaMode::mask, 0.2), 0.5f, 1e-5f);
    EXPECT_NEAR(middle(AlphaMode::mask, 0.8), solid, 1e-5f);
    const float blended = middle(AlphaMode::blend, 0.25);
    EXPECT_GT(blended, solid + 0.01f);
    EXPECT_LT(blended, 0.5f);
}

}  // namespace
}  // namespace etalon::test
