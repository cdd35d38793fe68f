// Flattening, views and environments.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/base/error.h"
#include "engine/math/robust.h"
#include "engine/scene/builder.h"
#include "engine/scene/load.h"
#include "engine/scene/pose.h"

namespace etalon {
namespace {

using testing::HasSubstr;

// Where on the film, in [0, 1]² with row 0 on top, a view sees a world point: the inverse of View's definition.
dvec2 film_point(const View& view, const dvec3& world)
{
    const dvec4 p = glm::inverse(view.world_from_camera) * dvec4(world, 1);
    const double aspect = double(view.width) / view.height;
    if (view.camera.orthographic) return dvec2(0.5 + 0.5 * p.x / view.camera.xmag, 0.5 - 0.5 * p.y / view.camera.ymag);
    const double t = std::tan(view.camera.yfov / 2);
    return dvec2(0.5 + 0.5 * p.x / -p.z / (t * aspect), 0.5 - 0.5 * p.y / -p.z / t);
}

Scene one_box()
{
    SceneBuilder build("box");
    build.show("box", make_box(dvec3(5, 6, 7), dvec3(1, 2, 3)), build.lambert("grey", dvec3(0.5)));
    return std::move(build).finish();
}

TEST(Pose, multiplies_matrices_down_the_forest_and_places_instances)
{
    Scene scene = one_box();
    Node child = scene.nodes[0];
    child.instances = {translation(dvec3(0, 0, 1)), translation(dvec3(0, 0, 2))};
    scene.nodes[0].mesh = kNone;
    scene.nodes[0].parent_from_node = translation(dvec3(1, 0, 0));
    scene.nodes[0].children = {1};
    child.parent_from_node = translation(dvec3(0, 1, 0));
    scene.nodes.push_back(child);
    const PosedScene posed = pose(scene);
    ASSERT_EQ(posed.draws.size(), 2u);
    EXPECT_EQ(dvec3(posed.draws[0].world_from_object[3]), dvec3(1, 1, 1));
    EXPECT_EQ(dvec3(posed.draws[1].world_from_object[3]), dvec3(1, 1, 2));
    EXPECT_EQ(posed.bounds_min, dvec3(5 - 1 + 1, 6 - 2 + 1, 7 - 3 + 1));
    EXPECT_EQ(posed.bounds_max, dvec3(5 + 1 + 1, 6 + 2 + 1, 7 + 3 + 2));
}

TEST(Pose, hides_a_subtree_but_keeps_its_cameras)
{
    Scene scene = one_box();
    scene.cameras.emplace_back();
    scene.nodes[0].visible = false;
    scene.nodes[0].children = {1};
    Node child = scene.nodes[0];
    child.children.clear();
    child.visible = true;
    child.camera = 0;
    scene.nodes.push_back(child);
    const PosedScene posed = pose(scene);
    EXPECT_TRUE(posed.draws.empty());
    EXPECT_EQ(posed.view.camera.yfov, kPi / 4);
    EXPECT_EQ(posed.view.camera.name, "");
}

TEST(Pose, walks_a_chain_of_a_million_nodes)
{
    Scene scene = one_box();
    constexpr Index kDepth = 1'000'000;
    scene.nodes[0].mesh = kNone;
    for (Index i = 1; i < kDepth; ++i) {
        scene.nodes[i - 1].children = {i};
        scene.nodes.emplace_back().parent_from_node = translation(dvec3(0, 0, 1));
    }
    scene.nodes.back().mesh = 0;
    EXPECT_EQ(pose(scene).draws.at(0).world_from_object[3].z, kDepth - 1);
}

TEST(Pose, refuses_a_node_reached_twice_and_a_matrix_that_is_not_finite)
{
    Scene twice = one_box();
    twice.roots[0].nodes = {0, 0};
    EXPECT_THROW(static_cast<void>(pose(twice)), Error);
    Scene cycle = one_box();
    cycle.nodes[0].children = {0};
    EXPECT_THROW(static_cast<void>(pose(cycle)), Error);
    Scene infinite = one_box();
    infinite.nodes[0].parent_from_node[0][0] = 1e308;
    infinite.nodes[0].children = {1};
    infinite.nodes.push_back(infinite.nodes[0]);
    infinite.nodes[1].children.clear();
    EXPECT_THROW(static_cast<void>(pose(infinite)), Error);
}

TEST(Pose, refuses_more_draws_than_memory_holds)
{
    Scene scene = one_box();
    scene.nodes[0].instances.assign(1'000'001, dmat4(1));
    scene.meshes[0].primitives.resize(10, scene.meshes[0].primitives[0]);
    EXPECT_THROW(static_cast<void>(pose(scene)), Error);
}

TEST(Pose, places_lights_and_turns_their_direction_without_scale)
{
    SceneBuilder build("lights");
    Light sun;
    sun.type = LightType::directional;
    dmat4 frame = look_from(dvec3(1, 2, 3), dvec3(1, -5, -9));
    frame[2] = frame[2] * 7.0;
    build.light(sun, frame);
    const Scene scene = std::move(build).finish();
    const PosedScene posed = pose(scene);
    ASSERT_EQ(posed.lights.size(), 1u);
    EXPECT_EQ(posed.lights[0].position, dvec3(1, 2, 3));
    EXPECT_LT(angle_between(posed.lights[0].direction, normalize(dvec3(0, -7, -12))), 1e-12);
    EXPECT_NEAR(length(posed.lights[0].direction), 1, 1e-15);
}

TEST(Pose, keeps_a_scaled_camera_rigid)
{
    Scene scene = one_box();
    SceneBuilder build("camera");
    Camera camera;
    dmat4 frame = look_from(dvec3(1, 2, 3), dvec3(4, 4, 4));
    for (int column = 0; column < 3; ++column) frame[column] = frame[column] * (2.0 + column);
    build.camera(camera, frame);
    const Scene scaled = std::move(build).finish();
    const dmat4 m = pose(scaled).view.world_from_camera;
    const dmat3 rotation(m);
    const dmat3 product = glm::transpose(rotation) * rotation;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) EXPECT_NEAR(product[i][j], i == j ? 1 : 0, 1e-14);
    EXPECT_NEAR(glm::determinant(rotation), 1, 1e-14);
    EXPECT_EQ(dvec3(m[3]), dvec3(1, 2, 3));
}

TEST(View, frames_a_scene_without_a_camera_so_that_all_of_it_is_seen_and_large)
{
    const Scene scene = one_box();
    for (const ivec2 size : {ivec2(1280, 720), ivec2(300, 300), ivec2(200, 900)}) {
        PoseSettings settings;
        settings.size = size;
        const PosedScene posed = pose(scene, settings);
        EXPECT_THAT(posed.notes.at(0), HasSubstr("no camera"));
        double extent = 0;
        for (const vec3& p : scene.meshes[0].primitives[0].positions) {
            const dvec2 at = film_point(posed.view, dvec3(p));
            for (const double s : {at.x, at.y}) {
                EXPECT_GT(s, 0) << size.x;
                EXPECT_LT(s, 1) << size.x;
                extent = std::max(extent, std::abs(s - 0.5));
            }
        }
        EXPECT_GT(extent, 0.3) << "the subject fills the picture";
        EXPECT_NEAR(film_point(posed.view, dvec3(5, 6, 7)).x, 0.5, 1e-12);
    }
}

TEST(View, frames_nothing_and_a_single_point_without_trouble)
{
    const Scene nothing = std::move(SceneBuilder("nothing")).finish();
    EXPECT_TRUE(std::isfinite(pose(nothing).view.world_from_camera[3].x));
    SceneBuilder build("point");
    Primitive point;
    point.topology = Topology::points;
    point.positions = {vec3(1e6f, 0, 0)};
    point.indices = {0};
    build.show("point", point, build.lambert("white", dvec3(1)));
    const Scene scene = std::move(build).finish();
    EXPECT_NEAR(film_point(pose(scene).view, dvec3(1e6, 0, 0)).x, 0.5, 1e-6);
}

TEST(View, orbits_by_azimuth_and_elevation_up_to_the_poles)
{
    const Scene scene = one_box();
    struct Case {
        double azimuth, elevation;
        dvec3 from;
    };
    for (const auto& [azimuth, elevation, from] :
         {Case{0, 0, dvec3(0, 0, 1)}, Case{90, 0, dvec3(1, 0, 0)}, Case{0, 90, dvec3(0, 1, 0)},
          Case{180, 0, dvec3(0, 0, -1)}, Case{30, -90, dvec3(0, -1, 0)}}) {
        PoseSettings settings;
        settings.orbit =
            Orbit{.azimuth = azimuth, .elevation = elevation, .distance = 10.0, .target = dvec3(1, 2, 3), .yfov = 30.0};
        const View view = pose(scene, settings).view;
        EXPECT_LT(length(dvec3(view.world_from_camera[3]) - (dvec3(1, 2, 3) + 10.0 * from)), 1e-12)
            << azimuth << ' ' << elevation;
        EXPECT_LT(length(film_point(view, dvec3(1, 2, 3)) - dvec2(0.5)), 1e-12);
        EXPECT_DOUBLE_EQ(view.camera.yfov, kPi / 6);
    }
    for (const Orbit& bad : {Orbit{.azimuth = 0, .elevation = 0, .distance = -1.0, .target = {}, .yfov = {}},
                             Orbit{.azimuth = std::nan(""), .elevation = 0, .distance = {}, .target = {}, .yfov = {}},
                             Orbit{.azimuth = 0, .elevation = 0, .distance = {}, .target = {}, .yfov = 180.0}}) {
        PoseSettings settings;
        settings.orbit = bad;
        EXPECT_THROW(static_cast<void>(pose(scene, settings)), Error);
    }
}

TEST(View, chooses_cameras_by_name_and_index_and_lists_them_when_there_is_none_of_that_name)
{
    SceneBuilder build("cameras");
    build.camera("left", 30, dvec3(-1, 0, 5), dvec3(0));
    build.camera("right", 40, dvec3(1, 0, 5), dvec3(0));
    const Scene scene = std::move(build).finish();
    const auto yfov = [&](const std::optional<std::string>& name) {
        PoseSettings settings;
        settings.camera = name;
        return std::lround(pose(scene, settings).view.camera.yfov * 180 / kPi);
    };
    EXPECT_EQ(yfov({}), 30);
    EXPECT_EQ(yfov("right"), 40);
    EXPECT_EQ(yfov("1"), 40);
    try {
        yfov("middle");
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.exit_code(), 2);
        EXPECT_THAT(error.mend(), HasSubstr("left"));
        EXPECT_THAT(error.mend(), HasSubstr("1 \"right\""));
    }
}

TEST(View, keeps_the_height_of_an_orthographic_view_whatever_the_picture_is_wide)
{
    const Scene scene = make_builtin("orthographic");
    PoseSettings settings;
    settings.size = ivec2(500, 100);
    const View view = pose(scene, settings).view;
    EXPECT_EQ(view.camera.ymag, 2.4);
    EXPECT_EQ(view.camera.xmag, 12);
}

TEST(View, TF_8_gets_a_lens_from_an_f_stop_focused_on_the_centre_or_where_it_is_told)
{
    const Scene scene = one_box();
    PoseSettings settings;
    settings.orbit =
        Orbit{.azimuth = 0, .elevation = 0, .distance = 12, .target = {}, .yfov = 2 * std::atan(0.5) * 180 / kPi};
    settings.lens = LensSettings{.f_stop = 2, .focus = {}, .blades = 6};
    const Camera camera = pose(scene, settings).view.camera;  // focal length 24 mm: the film's height
    ASSERT_TRUE(camera.lens.has_value());
    EXPECT_NEAR(camera.lens->aperture_radius, 0.006, 1e-12);
    EXPECT_NEAR(camera.lens->focus_distance, 12, 1e-9);
    EXPECT_EQ(camera.lens->blades, 6);
    settings.lens->focus = 3;
    EXPECT_EQ(pose(scene, settings).view.camera.lens->focus_distance, 3);
    for (const LensSettings& bad : {LensSettings{.f_stop = 0, .focus = 1}, LensSettings{.f_stop = 2, .focus = -1},
                                    LensSettings{.f_stop = NAN, .focus = 1}, LensSettings{.f_stop = 2, .blades = -1}}) {
        settings.lens = bad;
        EXPECT_THROW(pose(scene, settings), Error);
    }
    settings.lens = LensSettings{};
    settings.projection = Projection::equirectangular;
    EXPECT_THROW(pose(scene, settings), Error) << "a camera that sees all around has no lens";
}

TEST(View, projects_orthographically_as_large_as_perspective_shows_the_centre)
{
    const Scene scene = one_box();
    PoseSettings settings;
    settings.size = ivec2(200, 100);
    settings.orbit = Orbit{.azimuth = 30, .elevation = 20, .distance = 12, .target = {}, .yfov = {}};
    const View perspective = pose(scene, settings).view;
    settings.projection = Projection::orthographic;
    const View view = pose(scene, settings).view;
    EXPECT_TRUE(view.camera.orthographic);
    // A point beside the centre, across the axis, is at the same place in both.
    const dvec3 beside =
        dvec3(5, 6, 7) + 0.3 * dvec3(view.world_from_camera[0]) + 0.2 * dvec3(view.world_from_camera[1]);
    EXPECT_LT(length(film_point(view, beside) - film_point(perspective, beside)), 1e-12);
    settings.projection = Projection::equirectangular;
    EXPECT_TRUE(pose(scene, settings).view.camera.equirectangular);
}

TEST(View, takes_its_size_from_the_settings_then_the_scene_then_the_standard)
{
    Scene scene = one_box();
    EXPECT_EQ(pose(scene).view.width, 1280);
    scene.roots[0].hints.size = ivec2(64, 32);
    EXPECT_EQ(pose(scene).view.height, 32);
    PoseSettings settings;
    settings.size = ivec2(7, 9);
    EXPECT_EQ(pose(scene, settings).view.width, 7);
    settings.root = 5;
    EXPECT_THROW(static_cast<void>(pose(scene, settings)), Error);
}

TEST(PosedEnvironment, is_the_studio_only_where_nothing_shines)
{
    Scene scene = one_box();
    EXPECT_TRUE(pose(scene).environment.map);
    PoseSettings none;
    none.no_environment = true;
    EXPECT_TRUE(pose(scene, none).environment.is_black());
    scene.materials[0].emission = dvec3(1);
    EXPECT_TRUE(pose(scene).environment.is_black()) << "a lamp";
    scene.textures.emplace_back();
    scene.materials[0].emissive_texture.texture = 0;
    EXPECT_TRUE(pose(scene).environment.map) << "a glowing part of a model is no lamp";
    scene.roots[0].environment = Environment{};
    EXPECT_TRUE(pose(scene).environment.is_black()) << "the file says black";
}

TEST(PosedEnvironment, is_turned_and_scaled_by_the_settings)
{
    const Scene scene = one_box();
    PoseSettings settings;
    Environment own;
    own.radiance = dvec3(1, 2, 3);
    own.rotation = 0.5;
    own.scale = 2;
    settings.environment = own;
    settings.environment_rotation = 90;
    settings.environment_intensity = 3;
    const Environment environment = pose(scene, settings).environment;
    EXPECT_DOUBLE_EQ(environment.rotation, 0.5 + kPi / 2);
    EXPECT_EQ(environment.scale, 6);
    settings.environment_intensity = -1;
    EXPECT_THROW(static_cast<void>(pose(scene, settings)), Error);
}

TEST(PosedEnvironment, the_studio_is_grey_with_a_mean_of_one_and_brighter_above)
{
    const Environment studio = studio_environment();
    double sum = 0, weight = 0, above = 0;
    for (int y = 0; y < studio.map->height; ++y)
        for (int x = 0; x < studio.map->width; ++x) {
            const double w = std::sin(kPi * (y + 0.5) / studio.map->height);
            EXPECT_EQ(studio.map->at(x, y, 0), studio.map->at(x, y, 2));
            EXPECT_GT(studio.map->at(x, y, 0), 0);
            sum += w * double(studio.map->at(x, y, 0));
            weight += w;
            if (y < studio.map->height / 2) above += w * double(studio.map->at(x, y, 0));
        }
    EXPECT_NEAR(sum / weight, 1, 1e-6);
    EXPECT_GT(above / sum, 0.6);
}

}  // namespace
}  // namespace etalon
