// What is taken from materials because no picture shows it changes no bit of what the path tracer draws.
#include "tests/gpu/path_picture.h"
#include "tests/gpu/simplify_scene.h"

namespace etalon::test {
namespace {

TEST_F(PathPicture, of_a_simplified_scene_is_the_same_to_the_bit)
{
    const SimplifiableScene wall = simplifiable_scene();
    PosedScene posed = pose_whole(wall.scene, {.size = ivec2(54, 36)});
    const RenderSettings how = settings(3);
    Requirements with_all = require(posed, how);
    for (const Feature feature : {Feature::alpha_mask, Feature::alpha_blend, Feature::vertex_colors})
        with_all.set(feature, "test");
    const Film whole = render_path(device(), posed, with_all, how, {});
    EXPECT_EQ(simplify(posed).size(), wall.removable);
    const Requirements required = require(posed, how);
    EXPECT_FALSE(required.has(Feature::alpha_mask));     // of 1 everywhere
    EXPECT_FALSE(required.has(Feature::alpha_blend));    // likewise
    EXPECT_FALSE(required.has(Feature::vertex_colors));  // white
    EXPECT_TRUE(same_film(whole, render_path(device(), posed, required, how, {})));
}

/// A wall with another alpha everywhere: the modes must be told apart again.
TEST_F(PathPicture, of_surfaces_that_are_partly_there_asks_for_their_alpha)
{
    for (const AlphaMode mode : {AlphaMode::mask, AlphaMode::blend}) {
        SceneBuilder build("partly");
        Material material;
        material.alpha_mode = mode;
        material.alpha_cutoff = mode == AlphaMode::mask ? 1.5 : 0.5;  // over every alpha
        material.base_color.w = mode == AlphaMode::mask ? 1 : 0.5;
        build.show("wall", make_rectangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}), build.material(material));
        const Scene scene = std::move(build).finish();
        const Requirements required = require(pose(scene, {.size = ivec2(8)}), settings(1));
        EXPECT_TRUE(required.has(mode == AlphaMode::mask ? Feature::alpha_mask : Feature::alpha_blend));
    }
}

}  // namespace
}  // namespace etalon::test
