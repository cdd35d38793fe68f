#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "engine/geometry/box.h"

namespace etalon {

/// A light as the tree bounds it.
struct TreeLight {
    Box box;
    dvec3 axis{0, 0, 1};      ///< unit normal of its one emitting side
    bool everywhere = false;  ///< it has more than that side: axis does not matter
    double power = 0;         ///< ∝ emitted power, positive and finite
};

/// A node as a device reads it, three texels: (low, power), (high, cosine of the half angle of the cone around `axis`
/// that holds all normals below), (axis, leaves in the left child; 0: a leaf). Depth first: the left child of node i is
/// node i + 1, the right one node i + 2 · left_leaves. Leaves are numbered from left to right.
struct LightTreeNode {
    vec3 low{0};
    float power = 0;  ///< over that of the whole tree
    vec3 high{0};
    float cos_normals = 1;
    vec3 axis{0, 0, 1};
    std::uint32_t left_leaves = 0;
};
static_assert(sizeof(LightTreeNode) == 48);

/// A binary tree over lights (Conty & Kulla, "Importance Sampling of Many Lights with Adaptive Tree Splitting", 2018),
/// by which one of them is chosen for a point: at each node a child, by a bound of what it could send there.
struct LightTree {
    std::vector<LightTreeNode> nodes;   ///< empty when there are no lights
    std::vector<std::uint32_t> leaves;  ///< the light of each leaf
};

/// Splits by the paper's measure (its equation 6) in 12 bins along each axis, at the median where that separates
/// nothing.
LightTree make_light_tree(std::span<const TreeLight> lights);

}  // namespace etalon
