#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "engine/base/error.h"
#include "engine/render/render.h"
#include "engine/scene/builder.h"
#include "engine/scene/load.h"
#include "tests/agree/raster_pair.h"

// Rays of the rasterizer (SH-44), (SH-45) against what is known: a visibility in closed form, the path tracer, nothing.
namespace etalon::agree {
namespace {

Material lambert(double reflectance)
{
    Material material;
    material.model = BsdfModel::lambert;
    material.base_color = dvec4(dvec3(reflectance), 1);
    material.double_sided = true;
    return material;
}

/// From above, in parallel rays: x and z from -1 to 1.
void look_down(SceneBuilder& scene)
{
    Camera camera;
    camera.orthographic = true;
    camera.xmag = camera.ymag = 1;
    camera.znear = 0.01;
    scene.camera(camera, look_from(dvec3(0, 10, 1e-6), dvec3(0)));
}

constexpr double kWallAt = 1.5;
constexpr double kWallHeight = 2;

/// A floor under a uniform sky of radiance 1, and at x = 1.5, beside the picture, an endless wall two metres high.
PosedScene floor_by_wall(const Scene& scene)
{
    return pose(scene, {.size = ivec2(24)});
}

Scene make_floor_by_wall(double wall_reflectance)
{
    SceneBuilder scene("floor by a wall");
    scene.show("floor", make_rectangle(dvec3(0), dvec3(1, 0, 0), dvec3(0, 0, -1)), scene.material(lambert(0.8)));
    scene.show("wall",
               make_rectangle(dvec3(kWallAt, kWallHeight / 2, 0), dvec3(0, kWallHeight / 2, 0), dvec3(0, 0, 1e4)),
               scene.material(lambert(wall_reflectance)));
    Environment sky;
    sky.radiance = dvec3(1);
    scene.environment(sky);
    look_down(scene);
    return std::move(scene).finish();
}

/// How much of the light of a uniform sky an endless wall of height h takes from a floor at distance d:
/// (1 - d/√(d² + h²))/2.
double hidden(double distance)
{
    return 0.5 * (1 - distance / std::hypot(distance, kWallHeight));
}

TEST(RasterRays, SH_44_a_black_wall_takes_what_its_view_factor_says)
{
    gpu::Device device;
    const Scene scene = make_floor_by_wall(0);
    const PosedScene posed = floor_by_wall(scene);
    RenderSettings settings{.max_depth = 2, .msaa = 1};
    settings.ambient_rays = 128;
    const Film film = by_device(device, posed, settings);
    double found = 0, expected = 0;
    for (int x = 0; x < film.width; ++x) {
        const double left = kWallAt - (2.0 * x / film.width - 1), right = left - 2.0 / film.width;
        const double lit = 0.8 * (1 - (hidden(left) + hidden(right)) / 2);
        double column = 0;
        for (int y = 0; y < film.height; ++y)
            column += double(film.mean[std::size_t(y) * std::size_t(film.width) + std::size_t(x)].x) / film.height;
        // 3072 paths a column, each hidden or not: 5 of their standard deviations, were they independent.
        const double h = hidden(right);
        EXPECT_NEAR(column, lit, 5 * 0.8 * std::sqrt(h * (1 - h) / (128.0 * film.height))) << "column " << x;
        found += column / film.width;
        expected += lit / film.width;
    }
    EXPECT_NEAR(found, expected, 0.002);
}

/// What the wall reflects is there with the third segment, and not with two.
TEST(RasterRays, SH_44_a_white_wall_gives_light_back)
{
    gpu::Device device;
    const Scene scene = make_floor_by_wall(0.9);
    const PosedScene posed = floor_by_wall(scene);
    RenderSettings settings{.spp = 256, .max_depth = 5, .msaa = 1};
    settings.ambient_rays = 128;
    const auto mean = [](const Film& film) {
        dvec3 sum(0);
        for (const vec3& v : film.mean) sum += dvec3(v);
        return sum.x / double(film.pixel_count());
    };
    const double two = [&] {
        RenderSettings visibility = settings;
        visibility.max_depth = 2;
        return mean(by_device(device, posed, visibility));
    }();
    const double rays = mean(by_device(device, posed, settings));
    const double paths = mean(render_path(device, posed, require(posed, settings), settings, {}));
    EXPECT_GT(rays, 1.03 * two);
    EXPECT_NEAR(rays, paths, 0.004 * paths);
}

/// A matte floor under a uniform sky weighs every path alike: no noise, and what is known in closed form.
TEST(RasterRays, SH_44_find_a_uniform_sky_exactly_where_nothing_is_in_the_way)
{
    gpu::Device device;
    SceneBuilder scene("floor");
    scene.show("floor", make_rectangle(dvec3(0), dvec3(0.8, 0, 0), dvec3(0, 0, -0.8)), scene.material(lambert(0.5)));
    Environment sky;
    sky.radiance = dvec3(0.4, 0.5, 0.7);
    scene.environment(sky);
    look_down(scene);
    const Scene whole = std::move(scene).finish();
    const PosedScene posed = pose(whole, {.size = ivec2(24)});
    RenderSettings settings;
    const Film bare = by_device(device, posed, settings);
    settings.ambient_rays = 4;
    const Film rays = by_device(device, posed, settings);
    EXPECT_EQ(rays.alpha, bare.alpha);
    for (std::size_t i = 0; i < rays.pixel_count(); ++i)
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(rays.mean[i][c], bare.mean[i][c], 2e-6f) << "pixel " << i;
    EXPECT_NEAR(rays.mean[rays.pixel_count() / 2 + 12].y, 0.25, 1e-6);
}

/// Emitters and what they light, metals, coats and glass: the path tracer's picture but for what the tables
/// approximate.
TEST(RasterRays, SH_44_whole_pictures_come_near_the_path_tracers)
{
    gpu::Device device;
    struct Row {
        const char* name;
        double off;  ///< root mean square over mean, at most; measured: half of it
    };
    for (const Row& row : {Row{"cornell", 0.3}, Row{"clearcoat", 0.06}, Row{"sheen", 0.09}}) {
        const Scene scene = make_builtin(row.name);
        const PosedScene posed = pose(scene, {.size = ivec2(32, 24)});
        RenderSettings settings{.spp = 128, .msaa = 1, .ssaa = 4};
        const Film paths = render_path(device, posed, require(posed, settings), settings, {});
        const auto distance = [&](const Film& film) {
            double sum = 0, mean = 0;
            for (std::size_t i = 0; i < film.pixel_count(); ++i) {
                // The edge of a lamp is its coverage; it is not asked about here.
                const dvec3 d = glm::min(dvec3(film.mean[i]), 1.0) - glm::min(dvec3(paths.mean[i]), 1.0);
                sum += dot(d, d);
                for (int c = 0; c < 3; ++c) mean += std::min(double(paths.mean[i][c]), 1.0);
            }
            return std::sqrt(3 * sum * double(film.pixel_count())) / mean;
        };
        const double without = distance(by_device(device, posed, settings));
        settings.ambient_rays = 8;
        settings.shadows = Shadows::ray;
        const double with = distance(by_device(device, posed, settings));
        std::cout << fmt::format("{:12} from the path tracer: {:.3f} without rays, {:.3f} with\n", row.name, without,
                                 with);
        EXPECT_LT(with, without) << row.name;
        EXPECT_LT(with, row.off) << row.name;
    }
}

TEST(RasterRays, are_refused_by_name_where_they_cannot_be_had)
{
    const Scene scene = make_floor_by_wall(0);
    const PosedScene posed = floor_by_wall(scene);
    RenderSettings settings;
    settings.ambient_rays = 1;
    EXPECT_THROW(by_reference_raster(posed, settings), Error);
}

}  // namespace
}  // namespace etalon::agree
