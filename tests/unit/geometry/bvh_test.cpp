#include "engine/geometry/bvh.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <numeric>
#include <optional>
#include <random>

#include "tests/support/nasty.h"

namespace etalon {
namespace {

using Triangle = std::array<vec3, 3>;

Box box_of(const Triangle& triangle)
{
    Box box;
    for (const vec3& p : triangle) box.add(p);
    return box;
}

std::vector<Box> boxes_of(const std::vector<Triangle>& triangles)
{
    std::vector<Box> boxes;
    for (const Triangle& triangle : triangles) boxes.push_back(box_of(triangle));
    return boxes;
}

/// Small triangles in a cube of side 2 about `center`.
std::vector<Triangle> soup(std::size_t count, float size, unsigned seed, vec3 center = vec3(0))
{
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> in_cube(-1, 1), around(-size, size);
    std::vector<Triangle> out;
    for (std::size_t i = 0; i < count; ++i) {
        const vec3 at = center + vec3(in_cube(random), in_cube(random), in_cube(random));
        Triangle triangle;
        for (vec3& p : triangle) p = at + vec3(around(random), around(random), around(random));
        out.push_back(triangle);
    }
    return out;
}

struct Ray {
    vec3 origin{0};
    vec3 direction{0, 0, 1};
};

std::vector<Ray> rays_through(const Box& bounds, std::size_t count, unsigned seed)
{
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> unit(0, 1);
    const vec3 size = bounds.max - bounds.min;
    const auto inside = [&] { return bounds.min + size * vec3(unit(random), unit(random), unit(random)); };
    std::vector<Ray> rays;
    while (rays.size() < count) {
        const Ray ray{inside(), inside() - inside()};
        if (ray.direction != vec3(0)) rays.push_back(ray);
    }
    return rays;
}

/// Möller & Trumbore in double; t > 0.
std::optional<double> intersect(const Ray& ray, const Triangle& triangle)
{
    const dvec3 o(ray.origin), d(ray.direction), a(triangle[0]);
    const dvec3 e1 = dvec3(triangle[1]) - a, e2 = dvec3(triangle[2]) - a;
    const dvec3 p = cross(d, e2);
    const double det = dot(e1, p);
    if (det == 0) return std::nullopt;
    const dvec3 s = o - a;
    const double u = dot(s, p) / det;
    const dvec3 q = cross(s, e1);
    const double v = dot(d, q) / det;
    const double t = dot(e2, q) / det;
    if (u < 0 || v < 0 || u + v > 1 || t <= 0) return std::nullopt;
    return t;
}

/// The slab test of shaders/path/traversal.glsl, operation for operation.
bool meets(const BvhChild& child, const vec3& inverse, const vec3& shifted)
{
    const uvec3 low = child.low(), high = child.high();
    std::int32_t t_near = 0, t_far = 0x7f7fffff;
    for (int axis = 0; axis < 3; ++axis) {
        const auto a = std::bit_cast<std::int32_t>(float(low[axis]) * inverse[axis] - shifted[axis]);
        const auto b = std::bit_cast<std::int32_t>(float(high[axis]) * inverse[axis] - shifted[axis]);
        t_near = std::max(t_near, std::min(a, b));
        t_far = std::min(t_far, std::max(a, b));
    }
    return t_near <= t_far;
}

struct Found {
    double t = std::numeric_limits<double>::infinity();
    std::size_t nodes = 0;
    std::size_t tests = 0;
    int highest_stack = 0;
};

/// Everything that the boxes let through, whatever is met before.
Found traverse(const Bvh& bvh, const std::vector<Triangle>& triangles, const Ray& ray)
{
    Found found;
    const vec3 scaled = ray.direction * bvh.grid.scale;
    vec3 inverse;
    for (int i = 0; i < 3; ++i) inverse[i] = 1.f / (std::abs(scaled[i]) < 1e-18f ? 1e-18f : scaled[i]);
    const vec3 shifted = (ray.origin - bvh.grid.base) * bvh.grid.scale * inverse;
    std::vector<std::int32_t> stack{0};
    while (!stack.empty()) {
        const std::int32_t at = stack.back();
        stack.pop_back();
        if (at >= 0) {
            ++found.nodes;
            for (const BvhChild& child : bvh.nodes[std::size_t(at)])
                if (meets(child, inverse, shifted)) stack.push_back(child.ref);
            found.highest_stack = std::max(found.highest_stack, static_cast<int>(stack.size()) - 1);
            continue;
        }
        const BvhChild leaf{0, 0, 0, at};
        for (std::uint32_t i = 0; i < leaf.count(); ++i) {
            ++found.tests;
            if (const auto t = intersect(ray, triangles[bvh.order[leaf.first() + i]])) found.t = std::min(found.t, *t);
        }
    }
    return found;
}

double nearest(const std::vector<Triangle>& triangles, const Ray& ray)
{
    double t = std::numeric_limits<double>::infinity();
    for (const Triangle& triangle : triangles)
        if (const auto hit = intersect(ray, triangle)) t = std::min(t, *hit);
    return t;
}

/// Calls check(child, the boxes below it).
template <class Check>
std::vector<std::uint32_t> visit(const Bvh& bvh, const BvhChild& child, const Check& check)
{
    std::vector<std::uint32_t> below;
    if (child.is_leaf()) {
        for (std::uint32_t i = 0; i < child.count(); ++i) below.push_back(bvh.order[child.first() + i]);
    } else {
        for (const BvhChild& each : bvh.nodes[std::size_t(child.ref)]) {
            const auto more = visit(bvh, each, check);
            below.insert(below.end(), more.begin(), more.end());
        }
    }
    check(child, below);
    return below;
}

void expect_contains_all(const Bvh& bvh, const std::vector<Box>& boxes)
{
    std::size_t outside = 0;
    const BvhChild root{0, 0xffff0000u, 0xffffffffu, 0};
    const auto all = visit(bvh, root, [&](const BvhChild& child, const std::vector<std::uint32_t>& below) {
        const dvec3 base(bvh.grid.base), scale(bvh.grid.scale);
        const dvec3 low = base + dvec3(child.low()) / scale, high = base + dvec3(child.high()) / scale;
        for (const std::uint32_t i : below)
            outside += glm::any(glm::lessThan(dvec3(boxes[i].min), low)) ||
                       glm::any(glm::greaterThan(dvec3(boxes[i].max), high));
    });
    EXPECT_EQ(outside, 0u);
    std::vector<std::uint32_t> sorted(all);
    std::sort(sorted.begin(), sorted.end());
    std::vector<std::uint32_t> expected(boxes.size());
    std::iota(expected.begin(), expected.end(), 0u);
    EXPECT_EQ(sorted, expected) << "each box is in exactly one leaf";
}

TEST(Bvh, G21_decoded_boxes_contain_what_is_below_them)
{
    for (const vec3 center : {vec3(0), vec3(1e4f, -3, 1e-3f), vec3(148376.f, 1234.f, -223423.f)})
        for (const float size : {1e-6f, 1e-2f, 1.f}) {
            const std::vector<Box> boxes = boxes_of(soup(2000, size, 7, center));
            expect_contains_all(build_bvh(boxes), boxes);
        }
}

TEST(Bvh, G20_no_hit_of_brute_force_is_lost)
{
    for (const float size : {0.02f, 0.3f}) {
        const std::vector<Triangle> triangles = soup(400, size, 11);
        const Bvh bvh = build_bvh(boxes_of(triangles));
        std::size_t lost = 0, met = 0;
        for (const Ray& ray : rays_through(bvh.bounds, 60000, 12)) {
            const double expected = nearest(triangles, ray);
            met += std::isfinite(expected);
            lost += traverse(bvh, triangles, ray).t != expected;
        }
        EXPECT_EQ(lost, 0u);
        EXPECT_GT(met, 200u);
    }
}

TEST(Bvh, G19_G20_no_hit_is_lost_along_axes_and_in_flat_scenes)
{
    std::vector<Triangle> tiles;  // a floor of 40 × 40 squares at y = 0
    for (int x = 0; x < 40; ++x)
        for (int z = 0; z < 40; ++z) {
            const vec3 a(float(x), 0, float(z)), b = a + vec3(1, 0, 0), c = a + vec3(1, 0, 1), d = a + vec3(0, 0, 1);
            tiles.push_back({a, c, b});
            tiles.push_back({a, d, c});
        }
    const Bvh bvh = build_bvh(boxes_of(tiles));
    std::mt19937 random(3);
    std::uniform_real_distribution<float> in_floor(0, 40);
    for (int i = 0; i < 5000; ++i) {
        // Straight down, on tile borders too, and almost along the floor.
        const float x = i % 3 == 0 ? float(i % 41) : in_floor(random);
        const Ray down{{x, 5, in_floor(random)}, {0, -1, 0}};
        EXPECT_EQ(traverse(bvh, tiles, down).t, nearest(tiles, down));
        const Ray along{{-1, 1e-3f, in_floor(random)}, {1, -1e-4f, 0.1f}};
        EXPECT_EQ(traverse(bvh, tiles, along).t, nearest(tiles, along));
    }
}

TEST(Bvh, visits_few_nodes_and_primitives)
{
    // 20 × 20 × 20 separate little boxes: a good tree visits a handful, a broken split cost visits hundreds.
    std::vector<Triangle> triangles;
    for (int i = 0; i < 8000; ++i) {
        const vec3 at(float(i % 20), float(i / 20 % 20), float(i / 400));
        triangles.push_back({at, at + vec3(0.3f, 0, 0), at + vec3(0, 0.3f, 0.3f)});
    }
    const Bvh bvh = build_bvh(boxes_of(triangles));
    double nodes = 0, tests = 0;
    const std::vector<Ray> rays = rays_through(bvh.bounds, 2000, 5);
    for (const Ray& ray : rays) {
        const Found found = traverse(bvh, triangles, ray);
        nodes += double(found.nodes);
        tests += double(found.tests);
    }
    // Measured: 15.0 nodes, 1.3 primitives, cost 41.6. Splits with a wrong cost visit several times as much.
    EXPECT_LT(nodes / double(rays.size()), 20);
    EXPECT_LT(tests / double(rays.size()), 2);
    EXPECT_LT(bvh.sah_cost, 48);
}

TEST(Bvh, G22_any_input_ends_with_a_bounded_stack)
{
    const std::vector<std::pair<const char*, std::vector<Box>>> cases = [] {
        std::vector<std::pair<const char*, std::vector<Box>>> out;
        Box unit;
        unit.add(vec3(0));
        unit.add(vec3(1));
        out.emplace_back("200000 copies of one box", std::vector<Box>(200000, unit));
        Box point;
        point.add(vec3(3, -2, 1));
        out.emplace_back("1000 copies of one point", std::vector<Box>(1000, point));
        std::vector<Box> nested, powers, line;
        for (int i = 0; i < 1000; ++i) {
            Box a, b, c;
            a.add(vec3(-float(i)));
            a.add(vec3(float(i)));
            nested.push_back(a);
            b.add(vec3(std::ldexp(1.f, i % 200 - 100)));
            powers.push_back(b);
            c.add(vec3(float(i), 0, 0));
            line.push_back(c);
        }
        out.emplace_back("boxes in boxes", nested);
        out.emplace_back("powers of two over 200 octaves", powers);
        out.emplace_back("points on a line", line);
        return out;
    }();
    for (const auto& [why, boxes] : cases) {
        const Bvh bvh = build_bvh(boxes);
        EXPECT_EQ(bvh.order.size(), boxes.size()) << why;
        EXPECT_LE(bvh.stack_need, 3 * 64) << why;
        EXPECT_EQ(bvh.dropped, 0u) << why;
    }
}

TEST(Bvh, G22_boxes_that_are_empty_or_not_finite_are_dropped_and_counted)
{
    std::vector<Box> boxes = boxes_of(soup(100, 0.1f, 1));
    boxes[3] = Box{};
    std::size_t bad = 1;
    for (const auto& value : nasty::not_finite<float>()) {
        boxes[10 + bad].max.y = value.value;
        ++bad;
    }
    const Bvh bvh = build_bvh(boxes);
    EXPECT_EQ(bvh.dropped, bad);
    EXPECT_EQ(bvh.order.size(), boxes.size() - bad);
    EXPECT_EQ(build_bvh({}).nodes.size(), 1u) << "an empty scene still has a root";
}

TEST(Bvh, nasty_triangles_are_found_wherever_they_are_finite)
{
    std::vector<Triangle> triangles = soup(200, 0.1f, 41);
    for (const nasty::Triangle& nasty : nasty::triangles()) triangles.push_back(nasty.positions);
    const std::vector<Box> boxes = boxes_of(triangles);
    const Bvh bvh = build_bvh(boxes);
    EXPECT_EQ(bvh.order.size(), boxes.size());
    EXPECT_EQ(bvh.dropped, 0u);
    expect_contains_all(bvh, boxes);
    for (const Ray& ray : rays_through(bvh.bounds, 500, 42))
        EXPECT_EQ(traverse(bvh, triangles, ray).t, nearest(triangles, ray));
}

TEST(Bvh, stack_need_is_never_exceeded)
{
    const std::vector<Triangle> triangles = soup(3000, 0.4f, 21);
    const Bvh bvh = build_bvh(boxes_of(triangles));
    int highest = 0;
    for (const Ray& ray : rays_through(bvh.bounds, 500, 22))
        highest = std::max(highest, traverse(bvh, triangles, ray).highest_stack);
    EXPECT_LE(highest, bvh.stack_need);
    EXPECT_GT(highest, bvh.stack_need / 3) << "and is not far above what happens";
}

TEST(Bvh, is_the_same_to_the_bit_for_any_thread_count)
{
    const std::vector<Box> boxes = boxes_of(soup(100000, 0.01f, 31));
    BvhOptions one, four;
    one.threads = 1;
    four.threads = 4;
    const Bvh a = build_bvh(boxes, one), b = build_bvh(boxes, four);
    EXPECT_EQ(a.order, b.order);
    const auto same = [](const BvhNode& x, const BvhNode& y) { return std::memcmp(&x, &y, sizeof x) == 0; };
    EXPECT_TRUE(std::equal(a.nodes.begin(), a.nodes.end(), b.nodes.begin(), b.nodes.end(), same));
}

}  // namespace
}  // namespace etalon
