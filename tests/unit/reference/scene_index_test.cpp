#include "engine/reference/scene_index.h"

#include <gtest/gtest.h>

#include "engine/scene/builder.h"
#include "tests/unit/reference/random.h"

namespace etalon::reference {
namespace {

using test::Random;

Primitive random_triangles(Random& random, int count, double size)
{
    Primitive primitive;
    for (int i = 0; i < count; ++i) {
        const dvec3 center = random.box(1);
        for (int c = 0; c < 3; ++c) {
            primitive.indices.push_back(static_cast<std::uint32_t>(primitive.positions.size()));
            primitive.positions.emplace_back(center + random.box(size));
        }
    }
    return primitive;
}

struct Posed {
    Scene scene;
    PosedScene posed;
    explicit Posed(Scene s) : scene(std::move(s)), posed(pose(scene)) {}
};

Posed random_scene(int triangles, int spheres, double size)
{
    Random random(11);
    SceneBuilder builder("random");
    const Index material = builder.lambert("grey", dvec3(0.5));
    builder.show("soup", random_triangles(random, triangles, size), material);
    builder.show("turned", random_triangles(random, triangles / 2, size), material,
                 rotation_y(0.3) * translation({0.1, 0, 0}));
    for (int i = 0; i < spheres; ++i) builder.sphere("ball", random.box(1), random.uniform(0.01, 0.2), material);
    return Posed(std::move(builder).finish());
}

const auto kEverything = [](const Hit&) { return true; };

bool same(const std::optional<Hit>& a, const std::optional<Hit>& b)
{
    if (!a || !b) return a.has_value() == b.has_value();
    return a->t == b->t && a->b1 == b->b1 && a->b2 == b->b2 && a->shape == b->shape;
}

TEST(SceneIndex, finds_bit_for_bit_what_trying_every_shape_finds)
{
    for (const double size : {0.02, 0.3, 2.0}) {
        const Posed scene = random_scene(400, 40, size);
        const SceneIndex index(scene.posed);
        ASSERT_EQ(index.shapes().size(), 640u);
        Random random(12);
        int met = 0;
        for (int i = 0; i < 4000; ++i) {
            const Ray ray{.origin = random.box(2), .direction = random.direction()};
            const auto fast = index.closest(ray, kEverything);
            ASSERT_TRUE(same(fast, index.closest_of_all(ray, kEverything))) << "ray " << i;
            met += fast.has_value();
        }
        EXPECT_GT(met, 100);
    }
}

TEST(SceneIndex, G19_rays_along_the_axes_and_in_the_faces_of_boxes_miss_nothing)
{
    SceneBuilder builder("boxes");
    const Index material = builder.lambert("grey", dvec3(0.5));
    for (int i = 0; i < 27; ++i) builder.show("box", make_box({i % 3, i / 3 % 3, i / 9}, dvec3(0.25)), material);
    const Posed scene(std::move(builder).finish());
    const SceneIndex index(scene.posed);
    for (int axis = 0; axis < 3; ++axis)
        for (const double sign : {1.0, -1.0})
            for (int i = 0; i < 400; ++i) {
                Ray ray{.origin = {(i % 20) * 0.125 - 0.25, (i / 20) * 0.125 - 0.25, 0.25}, .direction = dvec3(0)};
                std::swap(ray.origin[2], ray.origin[axis]);
                ray.direction = dvec3(0.0, -0.0, 0.0);
                ray.direction[axis] = sign;
                ray.origin[axis] = -5 * sign;
                ASSERT_TRUE(same(index.closest(ray, kEverything), index.closest_of_all(ray, kEverything)));
            }
}

TEST(SceneIndex, G22_a_thousand_copies_of_one_triangle_end_and_the_first_wins)
{
    Random random(13);
    Primitive one = random_triangles(random, 1, 1), many;
    for (int i = 0; i < 1000; ++i) many = i == 0 ? one : joined(many, one);
    SceneBuilder builder("copies");
    builder.show("copies", many, builder.lambert("grey", dvec3(0.5)));
    const Posed scene(std::move(builder).finish());
    const SceneIndex index(scene.posed);
    const dvec3 middle = (dvec3(one.positions[0]) + dvec3(one.positions[1]) + dvec3(one.positions[2])) / 3.0;
    const auto hit = index.closest({.origin = middle + dvec3(0, 0, 4), .direction = {0, 0, -1}}, kEverything);
    ASSERT_TRUE(hit);
    EXPECT_EQ(index.shapes()[hit->shape].element, 0u);
}

TEST(SceneIndex, an_empty_scene_and_triangles_without_area_are_met_by_nothing)
{
    SceneBuilder builder("flat");
    Primitive flat;
    flat.positions = {vec3(0), vec3(1), vec3(2), vec3(3)};
    flat.indices = {0, 1, 2, 0, 0, 3};
    builder.show("flat", flat, builder.lambert("grey", dvec3(0.5)));
    const Posed scene(std::move(builder).finish());
    const SceneIndex index(scene.posed);
    EXPECT_TRUE(index.shapes().empty());
    EXPECT_FALSE(index.closest({.origin = {-1, -1, -1}, .direction = {1, 1, 1}}, kEverything));
}

TEST(SceneIndex, transmittance_multiplies_every_shape_up_to_the_end_of_the_ray)
{
    SceneBuilder builder("panes");
    const Index material = builder.lambert("grey", dvec3(0.5));
    for (int i = 1; i <= 5; ++i) builder.show("pane", make_rectangle({0, 0, -i}, {1, 0, 0}, {0, 1, 0}), material);
    const Posed scene(std::move(builder).finish());
    const SceneIndex index(scene.posed);
    const auto half = [](const Hit&) { return 0.5; };
    const Ray ray{.origin = {0.1, 0.2, 0}, .direction = {0, 0, -1}};
    EXPECT_EQ(index.transmittance(ray, half), 1.0 / 32);
    EXPECT_EQ(index.transmittance({.origin = ray.origin, .direction = ray.direction, .t_max = 3.5}, half), 1.0 / 8);
    EXPECT_EQ(index.transmittance(ray, [](const Hit&) { return 0.0; }), 0);
}

}  // namespace
}  // namespace etalon::reference
