#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "engine/base/error.h"
#include "engine/reference/reference.h"
#include "engine/scene/builder.h"
#include "engine/scene/load.h"

namespace etalon::reference {
namespace {

Film render(const Scene& scene, RenderSettings settings, ivec2 size)
{
    PoseSettings pose_settings;
    pose_settings.size = size;
    const PosedScene posed = pose(scene, pose_settings);
    settings.renderer = Renderer::reference_raster;
    return render_raster(posed, require(posed, settings), settings, {});
}

Scene built(const std::function<void(SceneBuilder&)>& fill)
{
    SceneBuilder builder("test");
    fill(builder);
    return std::move(builder).finish();
}

Material unlit(dvec4 color, AlphaMode mode = AlphaMode::opaque)
{
    Material m;
    m.model = BsdfModel::unlit;
    m.base_color = color;
    m.alpha_mode = mode;
    m.double_sided = true;
    return m;
}

const vec3& at(const Film& film, int x, int y)
{
    return film.mean[std::size_t(y) * std::size_t(film.width) + std::size_t(x)];
}

/// A camera that sees `width` × `height` units, one a pixel, of the plane z = 0; (0, 0) is the top left corner.
void pixel_camera(SceneBuilder& b, double width, double height)
{
    const Camera camera{.orthographic = true, .xmag = width / 2, .ymag = height / 2};
    b.camera(camera, translation({width / 2, -height / 2, 10}));
    b.environment({.radiance = dvec3(0)});
}

TEST(ReferenceRaster, G3_a_closed_tiling_blended_over_nothing_covers_every_sample_once)
{
    // Eight by eight cells of two triangles each, at half opacity: samples covered twice or never would show.
    const Scene scene = built([](SceneBuilder& b) {
        Primitive sheet;
        for (int y = 0; y <= 8; ++y)
            for (int x = 0; x <= 8; ++x)
                sheet.positions.emplace_back(2 * x + (y % 3) * 0.125, -2 * y - (x % 4) * 0.0625, 0);
        for (std::uint32_t y = 0; y < 8; ++y)
            for (std::uint32_t x = 0; x < 8; ++x) {
                const std::uint32_t a = y * 9 + x;
                for (const std::uint32_t i : {a, a + 9, a + 1, a + 1, a + 9, a + 10}) sheet.indices.push_back(i);
            }
        b.show("sheet", sheet, b.material(unlit({1, 1, 1, 0.5}, AlphaMode::blend)));
        pixel_camera(b, 16, 16);
    });
    const Film film = render(scene, {.background = Background::transparent}, {16, 16});
    for (int y = 1; y < 15; ++y)
        for (int x = 1; x < 15; ++x) EXPECT_EQ(at(film, x, y), vec3(0.5)) << x << " " << y;
    EXPECT_EQ(film.alpha[5 * 16 + 5], 0.5f);
}

TEST(ReferenceRaster, G9c_edges_are_shares_of_four_samples)
{
    // Left of x = 5.25 is white: samples at 0.125 are inside, those at 0.375, 0.625, 0.875 are not.
    const Scene scene = built([](SceneBuilder& b) {
        b.show("half", make_rectangle({2.625, -5, 0}, {2.625, 0, 0}, {0, 5, 0}), b.material(unlit({1, 1, 1, 1})));
        pixel_camera(b, 10, 10);
    });
    const Film film = render(scene, {.background = Background::transparent}, {10, 10});
    EXPECT_EQ(at(film, 4, 5), vec3(1));
    EXPECT_EQ(at(film, 5, 5), vec3(0.25));
    EXPECT_EQ(film.alpha[5 * 10 + 5], 0.25f);
    EXPECT_EQ(at(film, 6, 5), vec3(0));
    const Film single = render(scene, {.background = Background::transparent, .msaa = 1}, {10, 10});
    EXPECT_EQ(at(single, 5, 5), vec3(0));
    EXPECT_TRUE(film.variance.empty());
}

TEST(ReferenceRaster, G7_the_nearer_surface_wins_even_by_a_millionth_far_away)
{
    for (const double distance : {1.0, 1e3, 1e6, 1e9})
        for (const bool swapped : {false, true}) {
            const Scene scene = built([&](SceneBuilder& b) {
                const auto wall = [&](double z) { return make_rectangle({0, 0, -z}, {z, 0, 0}, {0, z, 0}); };
                const Index red = b.material(unlit({1, 0, 0, 1})), green = b.material(unlit({0, 1, 0, 1}));
                b.show("first", wall(swapped ? distance : distance * (1 + 1e-6)), swapped ? green : red);
                b.show("second", wall(swapped ? distance * (1 + 1e-6) : distance), swapped ? red : green);
                b.camera(Camera{}, dmat4(1));
                b.environment({.radiance = dvec3(0)});
            });
            for (const vec3& pixel : render(scene, {}, {8, 8}).mean) EXPECT_EQ(pixel, vec3(0, 1, 0)) << distance;
        }
}

TEST(ReferenceRaster, SH_32_blended_draws_go_over_the_rest_farthest_first)
{
    const Scene scene = built([](SceneBuilder& b) {
        const auto pane = [](double z) { return make_rectangle({5, -5, z}, {5, 0, 0}, {0, 5, 0}); };
        b.show("near glass", pane(2), b.material(unlit({0, 1, 0, 0.5}, AlphaMode::blend)));
        b.show("far glass", pane(1), b.material(unlit({1, 0, 0, 0.5}, AlphaMode::blend)));
        b.show("hidden glass", pane(-1), b.material(unlit({1, 1, 1, 1}, AlphaMode::blend)));
        b.show("wall", pane(0), b.material(unlit({0, 0, 1, 1})));
        pixel_camera(b, 10, 10);
    });
    EXPECT_EQ(at(render(scene, {}, {10, 10}), 5, 5), vec3(0.25, 0.5, 0.25));
}

TEST(ReferenceRaster, T2_a_texel_a_pixel_reads_level_0_and_two_read_level_1)
{
    // Columns of black and white texels: level 0 shows them, level 1 is grey.
    for (const double texels_per_pixel : {1.0, 2.0, 4.0}) {
        const Scene scene = built([&](SceneBuilder& b) {
            Material m = unlit(dvec4(1));
            m.base_color_texture = b.texture("stripes", 16, 16, Sampler{}, [](int x, int) {
                const auto v = static_cast<std::uint8_t>(x % 2 == 0 ? 0 : 255);
                return std::array<std::uint8_t, 4>{v, v, v, 255};
            });
            const double half = 8 / texels_per_pixel;
            b.show("quad", make_rectangle({half, -half, 0}, {half, 0, 0}, {0, half, 0}), b.material(m));
            pixel_camera(b, 16, 16);
        });
        const Film film = render(scene, {.msaa = 1}, {16, 16});
        if (texels_per_pixel == 1) {
            EXPECT_NEAR(at(film, 2, 2).x, 0, 1e-5);
            EXPECT_NEAR(at(film, 3, 2).x, 1, 1e-5);
        } else {
            EXPECT_NEAR(at(film, 1, 1).x, 0.5, 1e-5);
            EXPECT_NEAR(at(film, 2, 2).x, 0.5, 1e-5);
        }
        const Film without = render(scene, {.msaa = 1, .mipmaps = false}, {16, 16});
        if (texels_per_pixel == 4) {
            EXPECT_NEAR(at(without, 1, 1).x, 0.5, 1e-5);
        }  // between two texels of level 0
    }
}

TEST(ReferenceRaster, SH_7_points_and_lines_are_one_pixel_wide)
{
    const Scene scene = built([](SceneBuilder& b) {
        const Index white = b.material(unlit({1, 1, 1, 1}));
        Primitive points;
        points.topology = Topology::points;
        points.positions = {vec3(2.5, -2.5, 0), vec3(7, -7, 0)};
        points.indices = {0, 1};
        b.show("points", points, white);
        Primitive line;
        line.topology = Topology::lines;
        line.positions = {vec3(12.5, -2, 0), vec3(12.5, -9, 0)};
        line.indices = {0, 1};
        b.show("line", line, white);
        pixel_camera(b, 16, 16);
    });
    const Film film = render(scene, {}, {16, 16});
    double sum = 0;
    for (const vec3& pixel : film.mean) sum += pixel.x;
    EXPECT_EQ(at(film, 2, 2), vec3(1));     // centred in a pixel: all of it
    EXPECT_EQ(at(film, 6, 6), vec3(0.25));  // on a corner: a quarter each
    EXPECT_EQ(at(film, 7, 7), vec3(0.25));
    EXPECT_EQ(at(film, 12, 5), vec3(1));
    EXPECT_EQ(at(film, 11, 5), vec3(0));
    EXPECT_EQ(sum, 1 + 1 + 7);
}

TEST(ReferenceRaster, SH_31_a_light_shines_on_a_plane_as_the_equation_says)
{
    const Scene scene = built([](SceneBuilder& b) {
        b.show("floor", make_rectangle({8, -8, 0}, {8, 0, 0}, {0, 8, 0}), b.lambert("half", dvec3(0.5)));
        b.light({.type = LightType::point, .intensity = 30}, translation({5, -5, 3}));
        pixel_camera(b, 16, 16);
    });
    const Film film = render(scene, {}, {16, 16});
    for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 16; ++x) {
            const dvec3 to_light = dvec3(5, -5, 3) - dvec3(x + 0.5, -y - 0.5, 0);
            const double d2 = dot(to_light, to_light);
            EXPECT_NEAR(at(film, x, y).x, 0.5 / kPi * 30 / d2 * 3 / std::sqrt(d2), 1e-6);
        }
}

TEST(ReferenceRaster, SH_39_a_lamp_lights_what_it_faces_but_not_itself)
{
    const auto floor_below = [](bool turned) {
        return built([&](SceneBuilder& b) {
            b.show("floor", make_rectangle({8, -8, 0}, {8, 0, 0}, {0, 8, 0}), b.lambert("half", dvec3(0.5)));
            Material lamp;
            lamp.model = BsdfModel::lambert;
            lamp.base_color = dvec4(0.5, 0.5, 0.5, 1);
            lamp.emission = dvec3(10);
            b.show("lamp", make_rectangle({8, -8, 12}, {turned ? 1 : -1, 0, 0}, {0, 1, 0}), b.material(lamp));
            pixel_camera(b, 16, 16);
        });
    };
    const Film film =
        render(floor_below(false), {}, {16, 16});  // the lamp is behind the eye, 12 above the floor, and looks down
    for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 16; ++x) {
            const dvec3 to_lamp = dvec3(8, -8, 12) - dvec3(x + 0.5, -y - 0.5, 0);
            const double d2 = dot(to_lamp, to_lamp), cosine = 12 / std::sqrt(d2);
            EXPECT_NEAR(at(film, x, y).x, 0.5 / kPi * cosine * 10 * 4 * cosine / d2, 1e-6);
        }
    for (const vec3& pixel : render(floor_below(true), {}, {16, 16}).mean) EXPECT_EQ(pixel, vec3(0));
}

TEST(ReferenceRaster, SH_33_a_white_lambert_floor_under_a_constant_sky_has_the_skys_radiance)
{
    const Scene scene = built([](SceneBuilder& b) {
        b.show("floor", make_rectangle(dvec3(0), {0, 0, 5}, {5, 0, 0}), b.lambert("white", dvec3(1)));
        b.sphere("ball", {0, 1, 0}, 1, b.lambert("white", dvec3(1)));
        b.environment({.radiance = {1, 2, 3}});
        b.camera("camera", 40, {0, 3, 6}, {0, 0.5, 0});
    });
    for (const vec3& pixel : render(scene, {}, {24, 24}).mean)
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(pixel[c], c + 1, 1e-6);
}

TEST(ReferenceRaster, G6_the_floor_under_the_camera_meets_the_path_tracers_first_hits)
{
    const Scene scene = make_builtin("texture-plane");
    PoseSettings pose_settings;
    pose_settings.size = ivec2(64, 48);
    const PosedScene posed = pose(scene, pose_settings);
    const RenderSettings settings{.background = Background::transparent, .msaa = 1, .aovs = true};
    const Film film = render_raster(posed, require(posed, settings), settings, {});
    int covered = 0;
    for (std::size_t i = 0; i < film.alpha.size(); ++i) {
        EXPECT_EQ(film.alpha[i] > 0, film.aovs.object_id[i] != 0) << i;
        covered += film.alpha[i] > 0;
    }
    EXPECT_GT(covered, 1000);
}

TEST(ReferenceRaster, M4_the_same_bits_for_any_number_of_threads)
{
    const Scene scene = make_builtin("alpha");
    const Film one = render(scene, {.threads = 1}, {64, 64});
    for (const unsigned threads : {2u, 5u}) EXPECT_EQ(one.mean, render(scene, {.threads = threads}, {64, 64}).mean);
}

TEST(ReferenceRaster, counts_of_samples_that_Vulkan_need_not_offer_are_refused)
{
    EXPECT_THROW(render(make_builtin("triangle"), {.msaa = 3}, {8, 8}), Error);
}

TEST(ReferenceRaster, every_builtin_scene_is_finite)
{
    for (const BuiltinScene& builtin : builtin_scenes()) {
        const Film film = render(make_builtin(std::string(builtin.name)), {}, {48, 36});
        EXPECT_EQ(film.nonfinite, 0u) << builtin.name;
        EXPECT_FALSE(check(film).single_colour) << builtin.name;
    }
}

}  // namespace
}  // namespace etalon::reference
