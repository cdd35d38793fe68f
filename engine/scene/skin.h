#pragma once
#include <span>
#include <vector>

#include "engine/scene/animation.h"

namespace etalon {

/// parent_from_node as the motion has it.
dmat4 parent_from_node(const Scene& scene, const Motion& motion, Index node);

/// world_from_node of every node of the forest, whatever root it is under.
std::vector<dmat4> world_matrices(const Scene& scene, const Motion& motion);

/// world_from_mesh of each joint: world_from_node · inverse_bind. Error(input) when one is not finite.
std::vector<dmat4> joint_matrices(const Scene& scene, const Skin& skin, std::span<const dmat4> world_from_node);

struct Skinned {
    Primitive primitive;
    dvec3 origin{0};  ///< world; positions are relative to it, axes are the world's
};

/// Linear blend skinning in double (glTF 2.0 §3.7.3.3): each vertex moves by the mean of its joints' matrices,
/// weighted; weights are made to add up to 1 (promise G36), and a vertex without any moves with `rigid`, its node.
/// Normals turn by the cofactor of the mean, tangents by itself. Triangles that joints mirror keep their outside: their
/// winding is turned. The origin is the world's unless the body is farther from it than sixteen times its size, where
/// floats would be coarse. Error(input) when a vertex is beyond every number.
Skinned skinned(Primitive base, std::span<const dmat4> world_from_mesh, const dmat4& rigid);

}  // namespace etalon
