#include "engine/scene/skin.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/base/error.h"
#include "engine/base/parallel.h"
#include "engine/math/transform.h"

namespace etalon {

namespace {

constexpr std::size_t kChunk = 1u << 14;  // vertices that one thread takes at a time

// The mean matrix of vertex `v`.
dmat4 blended(const Primitive& base, std::span<const dmat4> world_from_mesh, const dmat4& rigid, std::size_t v)
{
    const std::size_t each = base.influences_per_vertex;
    const std::span<const Influence> influences(base.influences.data() + v * each, each);
    double total = 0;
    for (const Influence& influence : influences) total += static_cast<double>(influence.weight);
    if (total == 0) return rigid;
    dmat4 mean(0);
    for (const Influence& influence : influences) {
        if (influence.weight == 0) continue;
        assume(influence.joint < world_from_mesh.size());
        mean += (static_cast<double>(influence.weight) / total) * world_from_mesh[influence.joint];
    }
    return mean;
}

// Where positions are kept relative to: one float step is then at most 2^-20 of the body's size.
dvec3 origin_of(const std::vector<dvec3>& world)
{
    dvec3 low(std::numeric_limits<double>::infinity());
    dvec3 high = -low;
    for (const dvec3& p : world) {
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
    if (world.empty()) return dvec3(0);
    const dvec3 center = low + (high - low) / 2.0;
    return length(center) > 16 * length(high - low) ? center : dvec3(0);
}

// A triangle whose vertices' matrices mirror it (most of them).
void turn_mirrored(Primitive& primitive, const std::vector<char>& mirrored)
{
    if (primitive.topology != Topology::triangles) return;
    for (std::size_t i = 0; i + 2 < primitive.indices.size(); i += 3) {
        std::uint32_t* corner = &primitive.indices[i];
        if (mirrored[corner[0]] + mirrored[corner[1]] + mirrored[corner[2]] >= 2) std::swap(corner[1], corner[2]);
    }
}

}  // namespace

dmat4 parent_from_node(const Scene& scene, const Motion& motion, Index node)
{
    const auto moved = motion.nodes.find(node);
    if (moved == motion.nodes.end()) return scene.nodes[node].parent_from_node;
    return compose(moved->second.translation, moved->second.rotation, moved->second.scale);
}

std::vector<dmat4> world_matrices(const Scene& scene, const Motion& motion)
{
    std::vector<bool> is_child(scene.nodes.size());
    for (const Node& node : scene.nodes)
        for (const Index child : node.children) is_child.at(child) = true;
    std::vector<dmat4> world(scene.nodes.size(), dmat4(1));
    std::vector<Index> stack;
    for (Index i = 0; i < scene.nodes.size(); ++i) {
        if (is_child[i]) continue;
        world[i] = parent_from_node(scene, motion, i);
        stack.push_back(i);
        while (!stack.empty()) {
            const Index node = stack.back();
            stack.pop_back();
            for (const Index child : scene.nodes[node].children) {
                world[child] = world[node] * parent_from_node(scene, motion, child);
                stack.push_back(child);
            }
        }
    }
    return world;
}

std::vector<dmat4> joint_matrices(const Scene& scene, const Skin& skin, std::span<const dmat4> world_from_node)
{
    assume(skin.inverse_bind.size() == skin.joints.size());
    std::vector<dmat4> out;
    out.reserve(skin.joints.size());
    for (std::size_t i = 0; i < skin.joints.size(); ++i) {
        out.push_back(world_from_node[skin.joints[i]] * skin.inverse_bind[i]);
        for (int column = 0; column < 4; ++column)
            if (!is_finite(dvec3(out.back()[column])))
                throw Error(Blame::input,
                            fmt::format("joint {} of skin \"{}\" (node {} \"{}\"): the matrix is not finite", i,
                                        skin.name, skin.joints[i], scene.nodes[skin.joints[i]].name),
                            "repair the scales and translations above this node, and the inverse bind matrix");
    }
    return out;
}

Skinned skinned(Primitive base, std::span<const dmat4> world_from_mesh, const dmat4& rigid)
{
    const std::size_t vertices = base.positions.size();
    std::vector<dvec3> world(vertices);
    std::vector<char> mirrored(vertices);
    parallel_for((vertices + kChunk - 1) / kChunk, [&](std::size_t chunk) {
        for (std::size_t v = chunk * kChunk; v < std::min(vertices, (chunk + 1) * kChunk); ++v) {
            const dmat4 matrix = blended(base, world_from_mesh, rigid, v);
            const dmat3 linear(matrix);
            const dmat3 turn = cofactor(linear);
            const double sign = dot(linear[0], turn[0]) < 0 ? -1 : 1;  // of the determinant
            world[v] = dvec3(matrix * dvec4(dvec3(base.positions[v]), 1));
            mirrored[v] = sign < 0;
            // Scaled before rounding: cofactors of small matrices are smaller than any float.
            const auto direction = [](const dvec3& d) {
                const double largest = std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)});
                return largest > 0 && std::isfinite(largest) ? vec3(normalize(d / largest)) : vec3(0);
            };
            if (!base.normals.empty()) base.normals[v] = direction(sign * (turn * dvec3(base.normals[v])));
            if (base.tangents.empty()) continue;
            const vec3 tangent = direction(linear * dvec3(base.tangents[v]));
            if (tangent != vec3(0)) base.tangents[v] = vec4(tangent, static_cast<float>(sign) * base.tangents[v].w);
        }
    });
    const dvec3 origin = origin_of(world);
    for (std::size_t v = 0; v < vertices; ++v) {
        base.positions[v] = vec3(world[v] - origin);
        if (!is_finite(dvec3(base.positions[v])))
            throw Error(Blame::input, "a skinned vertex is beyond every number",
                        "repair the scales and translations of the skeleton");
    }
    turn_mirrored(base, mirrored);
    return {.primitive = std::move(base), .origin = origin};
}

}  // namespace etalon
