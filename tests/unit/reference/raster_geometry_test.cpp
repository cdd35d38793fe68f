#include "engine/reference/raster_geometry.h"

#include <gtest/gtest.h>

#include <map>

#include "engine/reference/camera.h"
#include "engine/scene/builder.h"
#include "tests/unit/reference/random.h"

namespace etalon::reference {
namespace {

using test::Random;

FixedPoint random_point(Random& random, double half)
{
    return {static_cast<std::int64_t>(random.uniform(-half, half)),
            static_cast<std::int64_t>(random.uniform(-half, half))};
}

TEST(RasterGeometry, G1_the_edge_function_changes_its_sign_with_its_direction)
{
    Random random(41);
    for (int i = 0; i < 100000; ++i) {
        const FixedPoint a = random_point(random, 1 << 28), b = random_point(random, 1 << 28),
                         p = random_point(random, 1 << 28);
        ASSERT_EQ(edge(a, b, p), -edge(b, a, p));
    }
}

__extension__ typedef __int128 Wide;

TEST(RasterGeometry, G2_edges_are_exact_for_the_largest_pictures)
{
    Random random(42);
    for (int i = 0; i < 10000; ++i) {
        const FixedPoint a = random_point(random, 1 << 28), b = random_point(random, 1 << 28),
                         p = random_point(random, 1 << 28);
        const auto wide = static_cast<Wide>(a.x - p.x) * (b.y - p.y) - static_cast<Wide>(a.y - p.y) * (b.x - p.x);
        ASSERT_TRUE(wide == edge(a, b, p));
    }
}

TEST(RasterGeometry, TR_1_inside_is_positive_for_clockwise_with_y_down)
{
    const FixedPoint a{0, 0}, b{256, 0}, c{0, 256}, inside{50, 50};
    EXPECT_GT(edge(a, b, inside), 0);
    EXPECT_GT(edge(b, c, inside), 0);
    EXPECT_GT(edge(c, a, inside), 0);
}

// Clockwise (y down) corners, whatever order they came in.
std::array<FixedPoint, 3> clockwise(FixedPoint a, FixedPoint b, FixedPoint c)
{
    if (edge(b, c, a) < 0) std::swap(b, c);
    return {a, b, c};
}

TEST(RasterGeometry, G3_a_tiling_covers_every_sample_once_even_through_sample_positions)
{
    Random random(43);
    // A grid of vertices, some exactly on pixel centres and sample positions, each cell cut by either diagonal.
    constexpr int kCells = 24;
    std::array<std::array<FixedPoint, kCells + 1>, kCells + 1> grid;
    for (int y = 0; y <= kCells; ++y)
        for (int x = 0; x <= kCells; ++x) {
            const bool border = x == 0 || y == 0 || x == kCells || y == kCells;
            const std::int64_t step = 32;  // multiples of the sample grid: ties are the rule here
            const auto shift = [&] { return border ? 0 : step * static_cast<std::int64_t>(random.uniform(-3.9, 3.9)); };
            grid[std::size_t(y)][std::size_t(x)] = {x * 256 + shift(), y * 256 + shift()};
        }
    std::map<std::pair<std::int64_t, std::int64_t>, int> count;
    int ties = 0;
    for (std::size_t y = 0; y < kCells; ++y)
        for (std::size_t x = 0; x < kCells; ++x) {
            const FixedPoint a = grid[y][x], b = grid[y][x + 1], c = grid[y + 1][x + 1], d = grid[y + 1][x];
            const bool cut = random.uniform() < 0.5;
            // A concave cell is tiled by one of its diagonals only.
            const bool a_c = edge(b, c, a) > 0 && edge(c, d, a) > 0, b_d = edge(b, d, a) > 0 && edge(c, d, b) > 0;
            ASSERT_TRUE(a_c || b_d);
            std::vector<std::array<FixedPoint, 3>> triangles{{a, b, c}, {a, c, d}};
            if ((cut && b_d) || !a_c) triangles = {{a, b, d}, {b, c, d}};
            for (const auto& triangle : triangles)
                for (std::int64_t py = static_cast<std::int64_t>(y) * 256 - 160;
                     py < static_cast<std::int64_t>(y + 2) * 256; py += 32)
                    for (std::int64_t px = static_cast<std::int64_t>(x) * 256 - 160;
                         px < static_cast<std::int64_t>(x + 2) * 256; px += 32) {
                        const FixedPoint p{px, py};
                        if (covers(triangle, p)) ++count[{px, py}];
                        for (std::size_t e = 0; e < 3; ++e) ties += edge(triangle[e], triangle[(e + 1) % 3], p) == 0;
                    }
        }
    EXPECT_GT(ties, 1000);
    int checked = 0;
    for (std::int64_t py = 0; py < kCells * 256; py += 32)
        for (std::int64_t px = 0; px < kCells * 256; px += 32, ++checked) {
            const auto found = count.find({px, py});
            ASSERT_TRUE(found != count.end() && found->second == 1)
                << px << " " << py << ": " << (found == count.end() ? 0 : found->second);
        }
    EXPECT_EQ(checked, kCells * kCells * 64);
}

TEST(RasterGeometry, G3_a_fan_around_a_sample_covers_it_once)
{
    Random random(44);
    for (int i = 0; i < 2000; ++i) {
        const FixedPoint hub{128, 128};
        std::vector<FixedPoint> rim;
        const int n = 3 + i % 6;
        const double turn = random.uniform(0, 2 * kPi);
        for (int k = 0; k < n; ++k) {
            const double angle = turn + 2 * kPi * k / n;
            rim.push_back({128 + std::llround(900 * std::cos(angle)), 128 + std::llround(900 * std::sin(angle))});
        }
        int covered = 0;
        for (int k = 0; k < n; ++k)
            covered += covers(clockwise(hub, rim[std::size_t(k)], rim[std::size_t((k + 1) % n)]), hub);
        ASSERT_EQ(covered, 1) << "spokes " << n;
    }
}

struct OneTriangle {
    Scene scene;
    PosedScene posed;
    std::vector<Piece> pieces;
    OneTriangle(const std::array<dvec3, 3>& p, double yfov, int width, int height, double znear = 0.01)
    {
        SceneBuilder builder("triangle");
        Material material;
        material.double_sided = true;
        Primitive primitive;
        for (const dvec3& v : p) primitive.positions.emplace_back(v);
        primitive.indices = {0, 1, 2};
        builder.show("triangle", primitive, builder.material(material));
        Camera camera;
        camera.yfov = yfov;
        camera.znear = znear;
        builder.camera(camera, dmat4(1));
        builder.size(width, height);
        builder.environment({.radiance = dvec3(1)});  // else every pose would make a studio
        scene = std::move(builder).finish();
        posed = pose(scene);
        pieces = pieces_of_draw(posed, 0, projection(posed.view, 1));
    }
    dvec3 corner(std::size_t i) const { return dvec3(scene.meshes[0].primitives[0].positions[i]); }
};

TEST(RasterGeometry, G5_interpolation_meets_where_the_ray_meets_the_plane)
{
    Random random(45);
    int compared = 0;
    for (int i = 0; i < 3000; ++i) {
        const auto point = [&] {
            const double depth = std::pow(10.0, random.uniform(-1, 3));  // w from 0.1 to 1000 in one triangle
            return depth * dvec3(random.uniform(-1, 1), random.uniform(-1, 1), -1);
        };
        const OneTriangle t({point(), point(), point()}, 1.2, 64, 48);
        const CameraRays camera(t.posed.view);
        for (const Piece& piece : t.pieces) {
            const dvec2 pixel(random.uniform(0, 64), random.uniform(0, 48));
            const auto at = interpolate(piece, pixel);
            const auto hit =
                intersect_triangle(ShearedRay(camera.pinhole(pixel)), t.corner(0), t.corner(1), t.corner(2));
            if (!hit) continue;
            ASSERT_TRUE(at.valid);
            // Turned triangles have swapped corners but the same b; the film's rounding is magnified by the spread of
            // w.
            EXPECT_NEAR(at.b.x, hit->b1, 1e-9);
            EXPECT_NEAR(at.b.y, hit->b2, 1e-9);
            const double depth = camera.depth(camera.pinhole(pixel).origin + hit->t * camera.pinhole(pixel).direction);
            EXPECT_NEAR(depth_at(piece, pixel) * depth, t.posed.view.camera.znear, 1e-9);  // z = near / depth
            ++compared;
        }
    }
    EXPECT_GT(compared, 200);
}

TEST(RasterGeometry, G5_a_constant_stays_constant_and_derivatives_meet_differences)
{
    const OneTriangle t({dvec3(-1, -1, -2), dvec3(3, -1, -8), dvec3(0, 2, -3)}, 1.0, 100, 100);
    ASSERT_EQ(t.pieces.size(), 1u);
    for (const dvec2 pixel : {dvec2(40, 50), dvec2(60, 60), dvec2(45, 40)}) {
        const auto at = interpolate(t.pieces[0], pixel);
        constexpr double kStep = 1e-5;
        const dvec2 dx = (interpolate(t.pieces[0], pixel + dvec2(kStep, 0)).b -
                          interpolate(t.pieces[0], pixel - dvec2(kStep, 0)).b) /
                         (2 * kStep);
        const dvec2 dy = (interpolate(t.pieces[0], pixel + dvec2(0, kStep)).b -
                          interpolate(t.pieces[0], pixel - dvec2(0, kStep)).b) /
                         (2 * kStep);
        EXPECT_NEAR(length(at.b_dx - dx), 0, 1e-9);
        EXPECT_NEAR(length(at.b_dy - dy), 0, 1e-9);
        Piece flat = t.pieces[0];
        for (ScreenVertex& v : flat.v) v.b = dvec2(0.3, 0.1);
        EXPECT_EQ(interpolate(flat, pixel).b, dvec2(0.3, 0.1));
    }
}

TEST(RasterGeometry, G6_triangles_behind_the_eye_give_nothing_and_those_through_it_are_cut)
{
    EXPECT_TRUE(OneTriangle({dvec3(-1, -1, 2), dvec3(1, -1, 2), dvec3(0, 1, 2)}, 1, 64, 64).pieces.empty());
    EXPECT_TRUE(OneTriangle({dvec3(-1, -1, 0), dvec3(1, -1, 0), dvec3(0, 1, 0)}, 1, 64, 64).pieces.empty());
    // A floor that runs from behind the eye to the horizon: what is in front is drawn, below the middle only.
    const OneTriangle floor({dvec3(-50, -1, 50), dvec3(50, -1, 50), dvec3(0, -1, -500)}, 1, 64, 64);
    ASSERT_FALSE(floor.pieces.empty());
    for (const Piece& piece : floor.pieces)
        for (const ScreenVertex& v : piece.v) {
            EXPECT_GT(v.inverse_w, 0);
            EXPECT_GE(v.pixel.y, 32);
            EXPECT_LE(v.depth, 1 + 1e-12);
        }
}

TEST(RasterGeometry, G6_neighbours_cut_by_the_near_plane_share_the_same_cut)
{
    const std::array<ClipVertex, 3> one{
        {{{-1, 0, 0.5, 2}, {0, 0}}, {{1, 0.3, 0.5, 0.1}, {1, 0}}, {{0, 1, 0.5, 1.7}, {0, 1}}}};
    const std::array<ClipVertex, 3> other{{one[1], one[0], {{0, -1, 0.5, 1.9}, {0, 1}}}};
    const auto a = clip(one, dvec2(1e6)), b = clip(other, dvec2(1e6));
    ASSERT_EQ(a.size(), 4u);
    int shared = 0;
    for (const ClipVertex& v : a)
        for (const ClipVertex& w : b) shared += v.position == w.position;
    EXPECT_EQ(shared, 2);  // the inner end of the common edge, and the cut
}

TEST(RasterGeometry, glTF_front_faces_are_kept_and_backs_culled_mirrored_or_not)
{
    for (const bool mirrored : {false, true})
        for (const bool front : {false, true}) {
            SceneBuilder builder("one");
            Primitive primitive;
            primitive.positions = {vec3(-1, -1, 0), vec3(1, -1, 0), vec3(0, 1, 0)};  // counter-clockwise seen from +Z
            primitive.indices = {0, 1, 2};
            dmat4 place = translation({0, 0, -5}) * rotation_y(front ? 0 : kPi);
            if (mirrored) place = place * dmat4(-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1);
            builder.show("one", primitive, builder.metallic_roughness("m", dvec3(0.5), 0, 1), place);
            builder.camera(Camera{}, dmat4(1));
            const Scene scene = std::move(builder).finish();
            const PosedScene posed = pose(scene);
            EXPECT_EQ(pieces_of_draw(posed, 0, projection(posed.view, 1)).size(), front ? 1u : 0u) << mirrored;
        }
}

TEST(RasterGeometry, TF_4_near_is_one_and_far_away_is_nothing)
{
    const OneTriangle t({dvec3(-1, -1, -2), dvec3(1, -1, -2), dvec3(0, 1, -2)}, kPi / 2, 200, 100, 0.5);
    const dmat4 m = projection(t.posed.view, 1);
    const auto ndc = [&](const dvec3& p) {
        const dvec4 c = m * dvec4(p, 1);
        return dvec3(c) / c.w;
    };
    EXPECT_NEAR(ndc({0, 0, -0.5}).z, 1, 1e-15);
    EXPECT_NEAR(ndc({0, 0, -5e12}).z, 1e-13, 1e-27);
    EXPECT_NEAR(ndc({2, 1, -1}).x, 1, 1e-15);   // aspect 2, 90 degrees: the right edge
    EXPECT_NEAR(ndc({2, 1, -1}).y, -1, 1e-15);  // the top edge is y = -1
}

}  // namespace
}  // namespace etalon::reference
