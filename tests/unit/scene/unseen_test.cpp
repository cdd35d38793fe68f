// What a view cannot show: boxes beside it and behind it, and mip levels finer than its pixels.
#include "engine/scene/unseen.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "engine/scene/builder.h"
#include "engine/scene/simplify.h"

namespace etalon {
namespace {

View view_of(bool orthographic)
{
    View view{.width = 20, .height = 10, .world_from_camera = look_from({3, 1, 4}, {0, 0, 0}), .camera = {}};
    view.camera.orthographic = orthographic;
    view.camera.yfov = kPi / 3;
    view.camera.xmag = 2;
    return view;
}

/// Whether a world point falls into the picture.
bool shows(const View& view, const dvec3& p)
{
    const dvec3 c = glm::transpose(dmat3(view.world_from_camera)) * (p - dvec3(view.world_from_camera[3]));
    const Camera& camera = view.camera;
    if (camera.orthographic) return std::abs(c.x) <= camera.xmag && std::abs(c.y) <= camera.ymag;
    const double half = std::tan(camera.yfov / 2);
    return c.z < 0 && std::abs(c.x) <= -c.z * half * 2 && std::abs(c.y) <= -c.z * half;
}

TEST(Unseen, no_point_of_a_box_outside_is_in_the_picture)
{
    std::mt19937 random(7);
    std::uniform_real_distribution<float> at(-8, 8), size(0.05f, 4), part(0, 1);
    for (const bool orthographic : {false, true}) {
        const View view = view_of(orthographic);
        int outside = 0;
        for (int i = 0; i < 2000; ++i) {
            const vec3 low(at(random), at(random), at(random));
            const vec3 high = low + vec3(size(random), size(random), size(random));
            const dmat4 placed = translation({1, -2, 0.5}) * rotation_y(i);
            if (!is_outside(view, placed, low, high)) continue;
            ++outside;
            for (int k = 0; k < 50; ++k) {
                const dvec3 p = glm::mix(dvec3(low), dvec3(high), dvec3(part(random), part(random), part(random)));
                ASSERT_FALSE(shows(view, dvec3(placed * dvec4(p, 1)))) << i;
            }
        }
        EXPECT_GT(outside, 500);
        EXPECT_LT(outside, 1990);
    }
}

TEST(Unseen, a_box_around_the_eye_is_seen)
{
    EXPECT_FALSE(is_outside(view_of(false), dmat4(1), vec3(-9), vec3(9)));
    EXPECT_FALSE(is_outside(view_of(true), dmat4(1), vec3(-9), vec3(9)));
}

/// A wall of one square metre with a texture of 64 texels a side, before a picture of `pixels` that it fills.
Unseen of_a_wall(int pixels, bool orthographic, const std::function<void(Material&)>& change = {})
{
    SceneBuilder build("wall");
    Material material;
    material.base_color_texture = build.texture("t", 64, 64, {}, [](int x, int y) {
        return std::array<std::uint8_t, 4>{std::uint8_t(x), std::uint8_t(y), 0, 255};
    });
    if (change) change(material);
    build.show("wall", make_rectangle({0, 0, 0}, {0.5, 0, 0}, {0, 0.5, 0}), build.material(material));
    Camera camera;
    camera.orthographic = orthographic;
    camera.ymag = camera.xmag = 0.5;
    camera.yfov = 0.1;
    build.camera(camera, translation({0, 0, 0.5 / std::tan(0.05)}));
    const Scene scene = std::move(build).finish();
    const PosedScene posed = pose(scene, {.size = ivec2(pixels)});
    const RenderSettings settings;
    return find_unseen(posed, require(posed, settings), settings);
}

TEST(Unseen, levels_finer_than_the_pixels_are_not_read)
{
    for (const bool orthographic : {false, true}) {
        const Unseen small = of_a_wall(15, orthographic);  // a little over 4 texels a pixel
        ASSERT_EQ(small.levels.size(), 1u);
        EXPECT_EQ(small.levels[0].first, 2);
        EXPECT_EQ(small.levels[0].bytes, 8u * (64 * 64 + 32 * 32));
        EXPECT_THAT(of_a_wall(65, orthographic).levels, testing::IsEmpty());
        EXPECT_EQ(of_a_wall(31, orthographic).levels.at(0).first, 1);
        EXPECT_EQ(small.draws, 0u);
    }
}

TEST(Unseen, a_transform_of_the_texture_counts)
{
    const Unseen twice =
        of_a_wall(31, true, [](Material& m) { m.base_color_texture.transform = dmat3(2, 0, 0, 0, 2, 0, 0, 0, 1); });
    EXPECT_EQ(twice.levels.at(0).first, 2);
}

}  // namespace
}  // namespace etalon
