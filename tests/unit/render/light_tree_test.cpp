#include "engine/render/path_light_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

namespace etalon {
namespace {

TreeLight light_at(const vec3& center, const dvec3& axis, double power)
{
    Box box;
    box.add(center - vec3(0.01f));
    box.add(center + vec3(0.01f));
    return {.box = box, .axis = axis, .everywhere = false, .power = power};
}

std::vector<TreeLight> lights_in_a_room(std::size_t count)
{
    std::mt19937 random(7);
    std::uniform_real_distribution<double> within(-1, 1);
    std::vector<TreeLight> out;
    for (std::size_t i = 0; i < count; ++i) {
        const dvec3 axis = normalize(dvec3(within(random), within(random), within(random)));
        out.push_back(
            light_at(5.f * vec3(within(random), within(random), within(random)), axis, 1 + within(random) / 2));
        out.back().everywhere = i % 7 == 0;
    }
    return out;
}

/// Visits the leaves below `node`, of which the first is `leaf`; checks what the nodes say of them.
void expect_bounds(const LightTree& tree, const std::vector<TreeLight>& lights, std::size_t node, std::size_t leaf,
                   std::vector<std::size_t>& below)
{
    const LightTreeNode& n = tree.nodes[node];
    std::vector<std::size_t> mine;
    if (n.left_leaves == 0) {
        mine.push_back(leaf);
    } else {
        expect_bounds(tree, lights, node + 1, leaf, mine);
        ASSERT_EQ(mine.size(), n.left_leaves);
        expect_bounds(tree, lights, node + 2 * n.left_leaves, leaf + n.left_leaves, mine);
    }
    double total = 0, power = 0;
    for (const TreeLight& light : lights) total += light.power;
    for (const std::size_t each : mine) {
        const TreeLight& light = lights[tree.leaves[each]];
        power += light.power;
        for (int axis = 0; axis < 3; ++axis) {
            EXPECT_LE(n.low[axis], light.box.min[axis]);
            EXPECT_GE(n.high[axis], light.box.max[axis]);
        }
        if (light.everywhere)
            EXPECT_LE(n.cos_normals, -0.999f);
        else
            EXPECT_GE(dot(dvec3(n.axis), light.axis), double(n.cos_normals) - 1e-6) << "node " << node;
    }
    EXPECT_NEAR(n.power, power / total, 1e-6);
    below.insert(below.end(), mine.begin(), mine.end());
}

TEST(LightTree, every_node_bounds_the_lights_below_it)
{
    for (const std::size_t count : {1, 2, 3, 100, 1000}) {
        const std::vector<TreeLight> lights = lights_in_a_room(count);
        const LightTree tree = make_light_tree(lights);
        ASSERT_EQ(tree.nodes.size(), 2 * count - 1);
        EXPECT_EQ(std::set(tree.leaves.begin(), tree.leaves.end()).size(), count) << "each light has a leaf";
        std::vector<std::size_t> below;
        expect_bounds(tree, lights, 0, 0, below);
        EXPECT_EQ(below.size(), count);
    }
    EXPECT_TRUE(make_light_tree({}).nodes.empty());
}

TEST(LightTree, splits_where_the_lights_are_apart)
{
    // Two rows of lamps far from each other, given alternately.
    std::vector<TreeLight> lights;
    for (int i = 0; i < 8; ++i) lights.push_back(light_at(vec3(i % 2 ? 100 : -100, 0, float(i)), dvec3(0, -1, 0), 1));
    const LightTree tree = make_light_tree(lights);
    EXPECT_EQ(tree.nodes[0].left_leaves, 4u);
    for (std::size_t leaf = 0; leaf < 8; ++leaf) EXPECT_EQ(lights[tree.leaves[leaf]].box.min.x < 0, leaf < 4);
}

TEST(LightTree, any_input_ends_and_stays_shallow)
{
    std::vector<TreeLight> same(3000, light_at(vec3(1), dvec3(0, 1, 0), 1));
    EXPECT_EQ(make_light_tree(same).nodes.size(), 5999u);
    // Each light twice as far away as the last: a split by place takes one off at a time.
    std::vector<TreeLight> geometric;
    for (int i = 0; i < 240; ++i)
        geometric.push_back(
            light_at(vec3(std::ldexp(1.f, i - 120), 0, 0), i % 2 ? dvec3(0, 1, 0) : dvec3(0, -1, 0), 1));
    const LightTree tree = make_light_tree(geometric);
    std::vector<std::pair<std::size_t, int>> pending{{0, 0}};
    int deepest = 0;
    while (!pending.empty()) {
        const auto [node, depth] = pending.back();
        pending.pop_back();
        deepest = std::max(deepest, depth);
        if (tree.nodes[node].left_leaves == 0) continue;
        pending.emplace_back(node + 1, depth + 1);
        pending.emplace_back(node + 2 * tree.nodes[node].left_leaves, depth + 1);
    }
    EXPECT_LE(deepest, 48);
}

}  // namespace
}  // namespace etalon
