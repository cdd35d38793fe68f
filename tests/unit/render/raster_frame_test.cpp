#include "engine/render/raster_frame.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "engine/render/raster_emitters.h"
#include "engine/scene/builder.h"

namespace etalon {
namespace {

View view_of(bool orthographic, dvec3 eye, dvec3 target)
{
    View view{.width = 64, .height = 48, .world_from_camera = look_from(eye, target), .camera = {}};
    view.camera.orthographic = orthographic;
    view.camera.xmag = 4;
    view.camera.ymag = 3;
    return view;
}

TEST(RasterFrame, TF4_TF5_the_shaders_matrix_puts_a_film_ray_at_its_pixel)
{
    for (const bool orthographic : {false, true}) {
        const View view = view_of(orthographic, {3, 2, 5}, {0, 0.5, 0});
        const RasterProjection projection = project(view, dvec3(-10), dvec3(10));
        for (const dvec2 pixel : {dvec2(0, 0), dvec2(10.25, 40.5), dvec2(64, 48)}) {
            // As docs of View: the point of that film position 7 m along the axis.
            const dvec2 film = dvec2(2 * pixel.x / 64 - 1, 1 - 2 * pixel.y / 48) * projection.film_half;
            const dvec3 point = orthographic ? dvec3(film, -7) : 7.0 * dvec3(film, -1);
            const dvec4 clip = projection.clip_from_camera * dvec4(point, 1);
            EXPECT_NEAR((clip.x / clip.w + 1) / 2 * 64, pixel.x, 1e-12);
            EXPECT_NEAR((clip.y / clip.w + 1) / 2 * 48, pixel.y, 1e-12);
            EXPECT_GT(clip.z / clip.w, 0);
            EXPECT_LT(clip.z / clip.w, 1);
        }
    }
}

TEST(RasterFrame, TF5_the_far_plane_lies_behind_the_bounds)
{
    const View view = view_of(true, {0, 0, 50}, {0, 0, 0});
    const RasterProjection projection = project(view, dvec3(-1), dvec3(1));
    EXPECT_GT(projection.far, 51);
    const dvec4 back = projection.clip_from_camera * dvec4(0, 0, -51, 1);
    EXPECT_GT(back.z, 0);
}

TEST(RasterFrame, G28_normals_stay_normal_to_their_face_under_any_scale_and_mirror)
{
    for (const double scale : {1e-13, 1.0, 1e13})
        for (const double mirror : {1.0, -1.0}) {
            const dmat4 m = rotation_x(0.4) * glm::transpose(dmat4(dvec4(mirror, 0.3, 0, 5), dvec4(0, 2, 0, 6),
                                                                   dvec4(0, 0.1, 0.5, 7), dvec4(0, 0, 0, 1 / scale)));
            dmat4 placed = m * scale;
            placed[3] = dvec4(5, 6, 7, 1);
            shared::RasterDraw draw{};
            place(placed, dvec3(5, 6, 7), draw);
            EXPECT_EQ(is_mirrored(placed), mirror < 0);
            EXPECT_EQ(draw.handedness, static_cast<float>(mirror));
            const dvec3 p0(0.1, 0.2, 0.3), p1(1, 0, 0.2), p2(0.3, 1, 0);
            const dmat3 linear(placed);
            const dvec3 expected =
                mirror * normalize(cross(normalize(linear * (p1 - p0)), normalize(linear * (p2 - p0))));
            const dvec3 found = normalize(dvec3(draw.normal_matrix * vec3(normalize(cross(p1 - p0, p2 - p0)))));
            EXPECT_NEAR(dot(expected, found), 1, 1e-6);
            EXPECT_EQ(draw.object_rows[0].w, 0.f);
        }
}

TEST(RasterFrame, the_pixel_box_of_a_sphere_holds_it)
{
    std::mt19937 random(3);
    std::uniform_real_distribution<double> anywhere(-4, 4);
    for (const bool orthographic : {false, true})
        for (int i = 0; i < 200; ++i) {
            const View view = view_of(orthographic, {0, 0, 5}, {0, 0, 0});
            const PosedSphere sphere{.center = {anywhere(random), anywhere(random), anywhere(random) - 2},
                                     .radius = 0.05 + std::abs(anywhere(random)) / 4};
            const auto box = pixels_of(sphere, view, view.camera.znear);
            const RasterProjection projection = project(view, dvec3(-9), dvec3(9));
            for (int k = 0; k < 50; ++k) {
                const dvec3 n = normalize(dvec3(anywhere(random), anywhere(random), anywhere(random)));
                const dvec3 p = sphere.center + sphere.radius * n - dvec3(0, 0, 5);
                const dvec4 clip = projection.clip_from_camera * dvec4(p, 1);
                if (-p.z < view.camera.znear) continue;
                const dvec2 pixel = (dvec2(clip) / clip.w + 1.0) / 2.0 * dvec2(64, 48);
                if (pixel.x < 0 || pixel.y < 0 || pixel.x >= 64 || pixel.y >= 48) continue;
                ASSERT_TRUE(box.has_value());
                EXPECT_GE(pixel.x, box->x);
                EXPECT_GE(pixel.y, box->y);
                EXPECT_LE(pixel.x, box->x + static_cast<int>(box->width));
                EXPECT_LE(pixel.y, box->y + static_cast<int>(box->height));
            }
        }
}

TEST(RasterEmitters, SH39_the_sixteen_most_powerful_count_without_textured_and_unlit_ones)
{
    SceneBuilder builder("lamps");
    const auto lamp = [&](double radiance, BsdfModel model = BsdfModel::lambert) {
        Material material;
        material.model = model;
        material.emission = dvec3(radiance);
        return material;
    };
    for (int i = 0; i < 20; ++i)
        builder.show("lamp", make_rectangle({0, 0, -double(i)}, {0.5, 0, 0}, {0, 0.5, 0}),
                     builder.material(lamp(1 + i)));
    builder.show("unlit", make_rectangle({}, {9, 0, 0}, {0, 9, 0}), builder.material(lamp(99, BsdfModel::unlit)));
    Material textured = lamp(99);
    textured.emissive_texture = builder.texture("t", 1, 1, {}, [](int, int) {
        return std::array<std::uint8_t, 4>{9, 9, 9, 9};
    });
    builder.show("textured", make_rectangle({}, {9, 0, 0}, {0, 9, 0}), builder.material(textured));
    builder.sphere("ball", {1, 2, 3}, 2, builder.material(lamp(7)));
    const Scene scene = std::move(builder).finish();
    const auto emitters = find_emitters(pose(scene));
    ASSERT_EQ(emitters.size(), 16u);
    EXPECT_NEAR(emitters[0].area, 16 * kPi, 1e-9);
    EXPECT_EQ(emitters[0].center, dvec3(1, 2, 3));
    EXPECT_EQ(emitters[0].object_id, 23u);
    EXPECT_NEAR(emitters[1].power(), 20, 1e-9);
    EXPECT_EQ(emitters[1].object_id, 20u);
    EXPECT_NEAR(emitters[1].area_vector.z, 1, 1e-12);
    EXPECT_NEAR(emitters[15].power(), 6, 1e-9);
    const shared::EmitterRecord record = pack(emitters[1], {1, 1, 1});
    EXPECT_EQ(record.center, vec3(-1, -1, -20));
    EXPECT_EQ(record.flags, shared::kEmitterFlat);
    EXPECT_EQ(pack(emitters[0], dvec3(0)).flags, 0u);
}

}  // namespace
}  // namespace etalon
