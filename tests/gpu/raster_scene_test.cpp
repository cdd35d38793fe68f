#include "engine/render/raster.h"

#include <cmath>
#include <limits>

#include "engine/scene/load.h"
#include "tests/gpu/raster_stage.h"

namespace etalon::test {
namespace {

class RasterSceneTest : public DeviceTest {};

TEST_F(RasterSceneTest, is_drawn_from_many_views_and_sizes_as_if_made_anew)
{
    const Scene scene = make_builtin("spheres");
    const PosedScene first = pose(scene, {.size = ivec2(32, 24)});
    const PosedScene second = pose(scene, {.orbit = Orbit{.azimuth = 70, .elevation = 30}, .size = ivec2(20, 31)});
    const Requirements required = require(first, {});
    RasterScene drawn(device(), first, required, {});
    for (const PosedScene* posed : {&first, &second, &first}) {
        drawn.draw(posed->view);
        const Film again = drawn.read();
        const Film anew = render_raster(device(), *posed, require(*posed, {}), {}, {});
        EXPECT_EQ(again.width, posed->view.width);
        EXPECT_EQ(again.height, posed->view.height);
        EXPECT_EQ(again.mean, anew.mean);
        EXPECT_EQ(drawn.picture().use(), gpu::ImageUse::sampled);
    }
}

TEST_F(RasterSceneTest, draws_the_same_bits_every_time)
{
    const Scene scene = make_builtin("maps");
    const PosedScene posed = pose(scene, {.size = ivec2(64, 48)});
    RenderSettings one_thread;
    one_thread.threads = 1;
    const Film a = render_raster(device(), posed, require(posed, {}), {}, {});
    const Film b = render_raster(device(), posed, require(posed, one_thread), one_thread, {});
    EXPECT_EQ(a.mean, b.mean);
}

TEST_F(RasterSceneTest, aovs_hold_what_the_pixel_centre_sees)
{
    SceneBuilder builder("aovs");
    Material lamp;
    lamp.model = BsdfModel::lambert;
    lamp.base_color = dvec4(0.1, 0.2, 0.3, 1);
    lamp.emission = dvec3(4, 5, 6);
    builder.show("unused place", make_rectangle({9, 9, 0}, {1, 0, 0}, {0, 1, 0}), builder.lambert("other", dvec3(1)));
    builder.show("lamp", make_rectangle({-0.5, 0, 1}, {0.5, 0, 0}, {0, 1, 0}), builder.material(lamp));
    builder.sphere("ball", {0.5, 0, -1}, 0.4, 0);
    RenderSettings settings;
    settings.aovs = true;
    const Film film = draw(device(), std::move(builder), settings, {8, 8});
    const std::size_t wall = 3 * 8 + 1, ball = 3 * 8 + 5, nothing = 0 * 8 + 7;
    EXPECT_NEAR(film.aovs.depth[wall], 4, 1e-5);
    EXPECT_EQ(film.aovs.normal[wall], vec3(0, 0, 1));
    EXPECT_EQ(film.aovs.albedo[wall], vec3(0.1f, 0.2f, 0.3f));
    EXPECT_EQ(film.aovs.emission[wall], vec3(4, 5, 6));
    EXPECT_EQ(film.aovs.object_id[wall], 2u);
    EXPECT_EQ(film.aovs.material_id[wall], 2u);
    EXPECT_NEAR(film.aovs.uv[wall].x, 1.5 / 4, 1e-6);
    EXPECT_NEAR(film.aovs.uv[wall].y, 3.5 / 8, 1e-6);
    EXPECT_EQ(film.aovs.object_id[ball], 3u);
    EXPECT_EQ(film.aovs.material_id[ball], 1u);
    // Pixel centre (0.375, 0.125) of the world; the ball's front there.
    const double height = std::sqrt(0.16 - 0.125 * 0.125 - 0.125 * 0.125);
    EXPECT_NEAR(film.aovs.depth[ball], 6 - height, 1e-5);
    EXPECT_NEAR(film.aovs.normal[ball].z, height / 0.4, 1e-5);
    EXPECT_EQ(film.aovs.depth[nothing], std::numeric_limits<float>::infinity());
    EXPECT_EQ(film.aovs.object_id[nothing], 0u);
    EXPECT_EQ(film.aovs.normal[nothing], vec3(0));
}

TEST_F(RasterSceneTest, an_empty_scene_and_a_picture_of_one_pixel_are_fine)
{
    SceneBuilder empty("empty");
    EXPECT_EQ(center(draw(device(), std::move(empty), {}, {1, 1})), vec3(0));
    SceneBuilder one("one");
    one.show("wall", wall(), one.material(unlit({0.5, 0.5, 0.5, 1})));
    EXPECT_EQ(center(draw(device(), std::move(one), {}, {1, 1})), vec3(0.5f));
}

TEST_F(RasterSceneTest, M13_pixels_that_are_not_finite_are_counted)
{
    SceneBuilder scene("hot");
    scene.show("half", make_rectangle({-1, 0, 0}, {1, 0, 0}, {0, 2, 0}), scene.material(unlit({1e39, 1, 1, 1})));
    const Film film = draw(device(), std::move(scene), {}, {8, 8});
    EXPECT_EQ(film.nonfinite, 32u);
}

}  // namespace
}  // namespace etalon::test
