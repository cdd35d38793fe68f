#include <array>
#include <cmath>
#include <random>

#include "tests/gpu/raster_stage.h"

namespace etalon::test {
namespace {

class RasterCoverage : public DeviceTest {};

constexpr std::array<dvec2, 4> kStandardSamples{
    {{0.375, 0.125}, {0.875, 0.375}, {0.125, 0.625}, {0.625, 0.875}}};  // Vulkan, standard sample locations

/// World position of a pixel position in a square picture of `draw`.
dvec3 world_of(dvec2 pixel, int size)
{
    return {2 * pixel.x / size - 1, 1 - 2 * pixel.y / size, 0};
}

Primitive triangle_of(const std::array<dvec2, 3>& corners, int size)
{
    Primitive primitive;
    for (const dvec2& corner : corners) primitive.positions.emplace_back(world_of(corner, size));
    primitive.normals.assign(3, vec3(0, 0, 1));
    primitive.indices = {0, 1, 2};
    return primitive;
}

/// Distance in pixels from the sample to the triangle, negative inside; (TR-1) over each edge's length.
double distance_outside(const std::array<dvec2, 3>& corners, dvec2 sample)
{
    double farthest = -1e300;
    for (std::size_t i = 0; i < 3; ++i) {
        const dvec2 a = corners[i] - sample, b = corners[(i + 1) % 3] - sample;
        farthest = std::max(farthest, (a.x * b.y - a.y * b.x) / glm::length(b - a));
    }
    return farthest;
}

double signed_area(const std::array<dvec2, 3>& c)
{
    return (c[1].x - c[0].x) * (c[2].y - c[0].y) - (c[1].y - c[0].y) * (c[2].x - c[0].x);
}

// Coverage of random triangles, sample by sample, against edge functions in double. A corner may be snapped by half of
// 2⁻⁸ px in x and in y, so a sample may be decided either way only within 2⁻⁸ / √2 px of an edge.
void check_coverage(gpu::Device& device, int msaa)
{
    constexpr int kSize = 48;
    const double snapping = std::sqrt(0.5) / (1u << device.limits().subpixel_bits) + 1e-4;
    std::mt19937 random(7);
    std::uniform_real_distribution<double> anywhere(-8, kSize + 8);
    int decided = 0;
    for (int round = 0; round < 6; ++round) {
        std::array<dvec2, 3> corners;
        for (dvec2& corner : corners) corner = {anywhere(random), anywhere(random)};
        if (signed_area(corners) > 0) std::swap(corners[1], corners[2]);  // counter-clockwise with y up
        SceneBuilder scene("triangle");
        scene.show("triangle", triangle_of(corners, kSize), scene.material(unlit(dvec4(1))));
        const Film film = draw(device, std::move(scene), transparent(msaa), {kSize, kSize});
        for (int y = 0; y < kSize; ++y)
            for (int x = 0; x < kSize; ++x) {
                int inside = 0, doubtful = 0;
                for (int s = 0; s < msaa; ++s) {
                    const dvec2 offset = msaa == 1 ? dvec2(0.5) : kStandardSamples[static_cast<std::size_t>(s)];
                    const double outside = distance_outside(corners, dvec2(x, y) + offset);
                    inside += outside < 0;
                    doubtful += std::abs(outside) <= snapping;
                }
                const float alpha = film.alpha[static_cast<std::size_t>(y * kSize + x)] * static_cast<float>(msaa);
                EXPECT_LE(std::abs(alpha - static_cast<float>(inside)), static_cast<float>(doubtful))
                    << "pixel " << x << ", " << y << " of triangle " << round;
                decided += doubtful == 0;
            }
    }
    EXPECT_GT(decided, 6 * kSize * kSize * 95 / 100);
}

TEST_F(RasterCoverage, covers_the_pixel_centres_inside_a_triangle)
{
    check_coverage(device(), 1);
}

TEST_F(RasterCoverage, covers_the_standard_sample_positions_inside_a_triangle)
{
    check_coverage(device(), 4);
}

TEST_F(RasterCoverage, G3_a_closed_tiling_covers_every_sample_once)
{
    // Vertices on pixel centres and sample positions; a sample that is hit twice or never has an alpha other than 1/2.
    constexpr int kSize = 16;
    Primitive grid;
    for (int y = 0; y < kSize; ++y)
        for (int x = 0; x < kSize; ++x) {
            const dvec2 a(x - 0.5 + 0.125 * (y % 3), y - 0.5),
                b = a + dvec2(1, 0), c = b + dvec2(0.125 * ((y + 1) % 3 - y % 3), 1), d = c - dvec2(1, 0);
            grid = joined(std::move(grid), triangle_of({a, c, b}, kSize));
            grid = joined(std::move(grid), triangle_of({a, d, c}, kSize));
        }
    for (const int msaa : {1, 4}) {
        SceneBuilder scene("tiling");
        Material half = unlit({1, 1, 1, 0.5});
        half.alpha_mode = AlphaMode::blend;
        scene.show("grid", grid, scene.material(half));
        const Film film = draw(device(), std::move(scene), transparent(msaa), {kSize, kSize});
        for (int y = 0; y < kSize - 2; ++y)
            for (int x = 2; x < kSize - 2; ++x)
                EXPECT_EQ(film.alpha[static_cast<std::size_t>(y * kSize + x)], 0.5f)
                    << x << ", " << y << " msaa " << msaa;
    }
}

TEST_F(RasterCoverage, an_edge_through_a_pixel_gives_the_mean_of_its_samples)
{
    constexpr int kSize = 8;
    // Left of x = 4.5 px: in column 4 the samples at 0.375 and 0.125.
    SceneBuilder scene("edge");
    scene.show("half", make_rectangle({-0.9375, 0, 0}, {1.0625, 0, 0}, {0, 2, 0}), scene.material(unlit({2, 2, 2, 1})));
    const Film film = draw(device(), std::move(scene), transparent(4), {kSize, kSize});
    for (int x = 0; x < kSize; ++x) {
        const float covered = x < 4 ? 1.f : x == 4 ? 0.5f : 0.f;
        EXPECT_EQ(film.alpha[static_cast<std::size_t>(3 * kSize + x)], covered);
        EXPECT_EQ(film.mean[static_cast<std::size_t>(3 * kSize + x)], vec3(2 * covered));
    }
}

TEST_F(RasterCoverage, G9c_resolve_is_linear_whatever_the_radiance)
{
    constexpr int kSize = 8;
    SceneBuilder scene("edge");
    scene.show("half", make_rectangle({-0.9375, 0, 0}, {1.0625, 0, 0}, {0, 2, 0}),
               scene.material(unlit({1e6, 1e6, 1e6, 1})));
    scene.show("behind", wall(-1), scene.material(unlit({1, 1, 1, 1})));
    const Film film = draw(device(), std::move(scene), transparent(4), {kSize, kSize});
    EXPECT_EQ(film.mean[3 * kSize + 4], vec3(500000.5f));
}

TEST_F(RasterCoverage, G7_planes_a_millionth_apart_keep_their_order_at_any_distance)
{
    for (const double distance : {0.02, 1.0, 1e3, 1e6, 1e9}) {
        SceneBuilder scene("planes");
        const double half = distance;
        // Drawn far, near, far: neither the first nor the last wins by its place.
        const auto plane = [&](double z) { return make_rectangle({0, 0, -z}, {half, 0, 0}, {0, half, 0}); };
        const Index red = scene.material(unlit({1, 0, 0, 1})), green = scene.material(unlit({0, 1, 0, 1}));
        scene.show("far", plane(distance * (1 + 2e-6)), red);
        scene.show("near", plane(distance), green);
        scene.show("far again", plane(distance * (1 + 2e-6)), red);
        scene.camera("eye", 45, {0, 0, 0}, {0, 0, -1});
        const Scene built = std::move(scene).finish();
        const PosedScene posed = pose(built, {.size = ivec2(8, 8), .no_environment = true});
        const Film film = render_raster(device(), posed, require(posed, {}), {}, {});
        for (const vec3& pixel : film.mean) EXPECT_EQ(pixel, vec3(0, 1, 0)) << "at " << distance << " m";
    }
}

// (TF-2)
TEST_F(RasterCoverage, G9a_a_scene_far_from_the_origin_looks_as_at_the_origin)
{
    const auto picture = [&](dvec3 offset) {
        SceneBuilder scene("far");
        scene.show("box", make_box({0, 0, 0}, {0.5, 0.5, 0.5}, 0.6), scene.lambert("grey", dvec3(0.5)),
                   translation(offset));
        scene.light(directional(dvec3(1), 3), translation(offset) * rotation_x(-0.5));
        Camera camera;
        scene.camera(camera, translation(offset) * look_from({1.5, 1, 2}, {0, 0, 0}));
        const Scene built = std::move(scene).finish();
        const PosedScene posed = pose(built, {.size = ivec2(48, 48), .no_environment = true});
        return render_raster(device(), posed, require(posed, {}), {}, {});
    };
    const Film here = picture(dvec3(0));
    // Powers of two: nothing is rounded in the doubles that hold the nodes.
    const Film there = picture(dvec3(0x1p24, 0x1p20, -0x1p23));
    for (std::size_t i = 0; i < here.pixel_count(); ++i) EXPECT_EQ(here.mean[i], there.mean[i]) << "pixel " << i;
}

TEST_F(RasterCoverage, nothing_nearer_than_the_near_plane_is_drawn)
{
    SceneBuilder scene("near");
    scene.show("too near", wall(4.995), scene.material(unlit({1, 0, 0, 1})));
    scene.show("wall", wall(), scene.material(unlit({0, 1, 0, 1})));
    EXPECT_EQ(center(draw(device(), std::move(scene))), vec3(0, 1, 0));
}

TEST_F(RasterCoverage, single_sided_backs_are_culled_and_mirrors_turn_the_sides)
{
    struct Case {
        const char* why;
        bool double_sided;
        double turn;    // about +Y
        double mirror;  // scale of x
        bool drawn;
    };
    for (const Case& c : {Case{"front", false, 0, 1, true}, Case{"back", false, kPi, 1, false},
                          Case{"back of a double-sided one", true, kPi, 1, true},
                          Case{"mirrored front", false, 0, -1, true}, Case{"mirrored back", false, kPi, -1, false}}) {
        SceneBuilder scene("sides");
        Material material = unlit(dvec4(1));
        material.double_sided = c.double_sided;
        dmat4 mirror(1);
        mirror[0][0] = c.mirror;
        scene.show("wall", wall(), scene.material(material), rotation_y(c.turn) * mirror);
        EXPECT_EQ(draw(device(), std::move(scene), transparent(1)).alpha[40], c.drawn ? 1.f : 0.f) << c.why;
    }
}

TEST_F(RasterCoverage, points_and_lines_are_as_wide_as_asked_for_however_finely_they_are_drawn)
{
    constexpr int kSize = 16;
    struct Case {
        int width, msaa, ssaa;
    };
    for (const auto& [width, msaa, ssaa] :
         {Case{1, 1, 1}, Case{1, 4, 1}, Case{3, 4, 1}, Case{1, 1, 3}, Case{3, 1, 2}}) {
        const int half = width / 2;
        Primitive points;
        points.topology = Topology::points;
        points.positions = {vec3(world_of({3.5, 4.5}, kSize)), vec3(world_of({10.5, 12.5}, kSize))};
        points.indices = {0, 1};
        Primitive line;
        line.topology = Topology::lines;
        line.positions = {vec3(world_of({2, 8.5}, kSize)), vec3(world_of({12, 8.5}, kSize))};
        line.indices = {0, 1};
        SceneBuilder scene("thin");
        const Index white = scene.metallic_roughness("white", dvec3(1), 0, 1);
        scene.show("points", points, white);
        scene.show("line", line, white);
        RenderSettings settings = transparent(msaa);
        settings.point_size = settings.line_width = width;
        settings.ssaa = ssaa;
        const Film film = draw(device(), std::move(scene), settings, {kSize, kSize});
        for (int y = 0; y < kSize; ++y)
            for (int x = 0; x < kSize; ++x) {
                const bool on_line = std::abs(y - 8) <= half && x >= 2 && x < 12;
                const bool on_point = (std::abs(x - 3) <= half && std::abs(y - 4) <= half) ||
                                      (std::abs(x - 10) <= half && std::abs(y - 12) <= half);
                EXPECT_EQ(film.alpha[static_cast<std::size_t>(y * kSize + x)], on_line || on_point ? 1.f : 0.f)
                    << x << ", " << y << " width " << width << " msaa " << msaa << " ssaa " << ssaa;
                // Without normals they are not lit: base colour, although there is no light at all.
                EXPECT_EQ(film.mean[static_cast<std::size_t>(y * kSize + x)], vec3(on_line || on_point ? 1.f : 0.f));
            }
    }
}

TEST_F(RasterCoverage, a_sphere_covers_the_samples_whose_rays_meet_it)
{
    constexpr int kSize = 32;
    constexpr double kRadius = 0.7;
    SceneBuilder scene("sphere");
    scene.sphere("ball", {0.05, -0.1, -2}, kRadius, scene.material(unlit(dvec4(1))));
    const Film film = draw(device(), std::move(scene), transparent(4), {kSize, kSize});
    for (int y = 0; y < kSize; ++y)
        for (int x = 0; x < kSize; ++x) {
            int inside = 0, doubtful = 0;
            for (const dvec2& sample : kStandardSamples) {
                const dvec3 at = world_of(dvec2(x, y) + sample, kSize);
                const double distance = std::hypot(at.x - 0.05, at.y + 0.1) - kRadius;
                inside += distance < 0;
                doubtful += std::abs(distance) < 1e-5;
            }
            EXPECT_LE(std::abs(4 * film.alpha[static_cast<std::size_t>(y * kSize + x)] - static_cast<float>(inside)),
                      static_cast<float>(doubtful))
                << x << ", " << y;
        }
}

}  // namespace
}  // namespace etalon::test
