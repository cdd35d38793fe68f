#include "engine/reference/intersect.h"

#include <gtest/gtest.h>

#include <array>

#include "tests/unit/reference/random.h"

namespace etalon::reference {
namespace {

using test::Random;

struct Mesh {
    std::vector<dvec3> points;
    std::vector<std::array<int, 3>> faces;
};

Mesh icosahedron()
{
    const double g = (1 + std::sqrt(5.0)) / 2;
    return {.points = {{-1, g, 0},
                       {1, g, 0},
                       {-1, -g, 0},
                       {1, -g, 0},
                       {0, -1, g},
                       {0, 1, g},
                       {0, -1, -g},
                       {0, 1, -g},
                       {g, 0, -1},
                       {g, 0, 1},
                       {-g, 0, -1},
                       {-g, 0, 1}},
            .faces = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                      {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                      {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}}};
}

int hits(const Mesh& mesh, const Ray& ray)
{
    const ShearedRay sheared(ray);
    int count = 0;
    for (const auto& f : mesh.faces)
        if (intersect_triangle(sheared, mesh.points[std::size_t(f[0])], mesh.points[std::size_t(f[1])],
                               mesh.points[std::size_t(f[2])]))
            ++count;
    return count;
}

TEST(Intersect, G10_no_ray_from_inside_a_closed_mesh_leaks_through_edges_or_vertices)
{
    Random random(1);
    for (const double offset : {0.0, 1e3}) {
        Mesh mesh = icosahedron();
        for (dvec3& p : mesh.points) p += dvec3(offset, -2 * offset, offset / 3);
        for (int i = 0; i < 60000; ++i) {
            const auto& f = mesh.faces[std::size_t(i) % mesh.faces.size()];
            const dvec3 a = mesh.points[std::size_t(f[0])], b = mesh.points[std::size_t(f[1])];
            const dvec3 target = i % 3 == 0 ? a : a + random.uniform() * (b - a);
            const dvec3 origin = dvec3(offset, -2 * offset, offset / 3) + random.box(0.3);
            ASSERT_GE(hits(mesh, {.origin = origin, .direction = target - origin}), 1)
                << "ray " << i << " offset " << offset;
        }
    }
}

TEST(Intersect, triangle_hit_lies_on_the_triangle_and_on_the_ray)
{
    Random random(2);
    for (int i = 0; i < 20000; ++i) {
        const dvec3 p0 = random.box(10), p1 = random.box(10), p2 = random.box(10), origin = random.box(10);
        const double b1 = random.uniform(), b2 = random.uniform() * (1 - b1);
        const dvec3 target = p0 + b1 * (p1 - p0) + b2 * (p2 - p0);
        const Ray ray{.origin = origin, .direction = 2.0 * (target - origin)};
        const double grazing = std::abs(dot(normalize(cross(p1 - p0, p2 - p0)), normalize(ray.direction)));
        if (grazing < 1e-2 || length(cross(p1 - p0, p2 - p0)) < 1) continue;
        const auto hit = intersect_triangle(ShearedRay(ray), p0, p1, p2);
        ASSERT_TRUE(hit) << i;
        EXPECT_NEAR(hit->t, 0.5, 1e-11);
        EXPECT_NEAR(hit->b1, b1, 1e-10);
        EXPECT_NEAR(hit->b2, b2, 1e-10);
    }
}

TEST(Intersect, G13_hits_do_not_change_when_everything_is_scaled_by_a_power_of_two)
{
    Random random(3);
    for (const double scale : {0x1p-40, 0x1p-20, 0x1p20, 0x1p40})
        for (int i = 0; i < 2000; ++i) {
            const dvec3 p0 = random.box(1), p1 = random.box(1), p2 = random.box(1), o = random.box(1),
                        d = random.direction();
            const auto one = intersect_triangle(ShearedRay({.origin = o, .direction = d}), p0, p1, p2);
            const auto other = intersect_triangle(ShearedRay({.origin = scale * o, .direction = d}), scale * p0,
                                                  scale * p1, scale * p2);
            ASSERT_EQ(one.has_value(), other.has_value());
            if (one) {
                EXPECT_EQ(one->t * scale, other->t);
            }
        }
}

TEST(Intersect, G18_a_ray_in_the_plane_of_a_triangle_misses_it)
{
    const Ray ray{.origin = {-5, 0, 0}, .direction = {1, 0, 0}};
    EXPECT_FALSE(intersect_triangle(ShearedRay(ray), {0, 0, -1}, {1, 0, 1}, {2, 0, -1}));
}

TEST(Intersect, G14_far_spheres_are_met_where_they_are)
{
    Random random(4);
    for (const double distance : {10.0, 1e4, 1e8, 1e12})
        for (int i = 0; i < 500; ++i) {
            const dvec3 point = random.direction();
            const Ray ray{.origin = distance * random.direction(), .direction = dvec3(0)};
            const Ray aimed{.origin = ray.origin, .direction = normalize(point * 0.999 - ray.origin)};
            const SphereHits hits = intersect_sphere(aimed, dvec3(0), 1);
            ASSERT_EQ(hits.count, 2) << distance;
            for (int h = 0; h < 2; ++h) {
                const dvec3 p = aimed.origin + hits.t[std::size_t(h)] * aimed.direction;
                // Rounding of t and p is a few ulp of the distance; nearly tangent rays magnify it as 1/cosθ.
                EXPECT_NEAR(length(p), 1, 1e-14 * distance + 1e-14) << distance;
            }
        }
}

TEST(Intersect, G15_a_huge_ground_sphere_is_met_at_the_height_of_the_eye)
{
    const double r = 6.4e6;
    const SphereHits hits = intersect_sphere({.origin = {0, 2, 0}, .direction = {0, -1, 0}}, {0, -r, 0}, r);
    ASSERT_EQ(hits.count, 2);
    EXPECT_NEAR(hits.t[0], 2, 1e-12);
    // The horizon dips by acos(r / (r + h)); a hair below it the ground is met near the tangent's length, above it
    // never.
    const double dip = std::acos(r / (r + 2)), tangent = std::sqrt(2 * (2 * r + 2));
    const auto look = [&](double angle) {
        return intersect_sphere({.origin = {0, 2, 0}, .direction = {std::cos(angle), -std::sin(angle), 0}}, {0, -r, 0},
                                r);
    };
    EXPECT_EQ(look(dip * (1 - 1e-6)).count, 0);
    ASSERT_EQ(look(dip * (1 + 1e-6)).count, 2);
    EXPECT_NEAR(look(dip * (1 + 1e-6)).t[0], tangent, 2e-3 * tangent);
}

TEST(Intersect, sphere_hits_behind_the_origin_do_not_count)
{
    EXPECT_EQ(intersect_sphere({.origin = {0, 0, 5}, .direction = {0, 0, 1}}, dvec3(0), 1).count, 0);
    const SphereHits inside = intersect_sphere({.origin = {0, 0, 0.5}, .direction = {0, 0, 1}}, dvec3(0), 1);
    ASSERT_EQ(inside.count, 1);
    EXPECT_NEAR(inside.t[0], 0.5, 1e-15);
}

TEST(Intersect, G23_rays_that_leave_a_triangle_do_not_meet_it_again_at_any_scale)
{
    Random random(5);
    constexpr double u = 0x1p-53;
    for (const double scale : {1e-12, 1.0, 1e12})
        for (int i = 0; i < 20000; ++i) {
            const dvec3 p0 = scale * random.box(1), p1 = scale * random.box(1), p2 = scale * random.box(1);
            const dvec3 n = normalize(cross(p1 - p0, p2 - p0));
            const double b1 = random.uniform(), b2 = random.uniform() * (1 - b1);
            const dvec3 x0 = (1 - b1 - b2) * p0, x1 = b1 * p1, x2 = b2 * p2;
            const dvec3 error = 10 * u * (glm::abs(x0) + glm::abs(x1) + glm::abs(x2) + glm::abs(p0));
            const dvec3 d = random.direction();
            const dvec3 origin = offset_origin(x0 + x1 + x2, error, n, d);
            EXPECT_LT(length(origin - (x0 + x1 + x2)), 1e-13 * scale);
            ASSERT_FALSE(intersect_triangle(ShearedRay({.origin = origin, .direction = d}), p0, p1, p2))
                << i << " at scale " << scale;
        }
}

}  // namespace
}  // namespace etalon::reference
