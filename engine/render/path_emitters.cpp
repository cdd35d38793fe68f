#include <algorithm>
#include <bit>

#include "engine/render/path_alias.h"
#include "engine/render/path_geometry.h"
#include "engine/render/path_light_tree.h"
#include "shaders/shared/path.h"

namespace etalon {
namespace {

void set_light_density(PathGeometry& geometry, const PathEmitter& emitter, double value)
{
    geometry.primitives[3 * std::size_t(emitter.primitive) + 1].w = std::bit_cast<std::uint32_t>(float(value));
}

std::vector<uvec4> alias_texels(PathGeometry& geometry)
{
    std::vector<double> weights;
    for (const PathEmitter& emitter : geometry.emitters) weights.push_back(emitter.weight);
    const std::vector<AliasEntry> table = make_alias_table(weights);
    std::vector<uvec4> texels;
    for (std::size_t i = 0; i < table.size(); ++i) {
        const PathEmitter& emitter = geometry.emitters[i];
        const bool sphere = (geometry.primitives[3 * std::size_t(emitter.primitive)].w & shared::kPrimitiveSphere) != 0;
        set_light_density(geometry, emitter, table[i].probability / (sphere ? 1 : emitter.area));
        texels.emplace_back(std::bit_cast<std::uint32_t>(table[i].threshold),
                            geometry.emitters[table[i].other].primitive, emitter.primitive, 0u);
    }
    return texels;
}

std::vector<uvec4> tree_texels(PathGeometry& geometry)
{
    double greatest = 0;
    for (const PathEmitter& emitter : geometry.emitters) greatest = std::max(greatest, emitter.weight);
    std::vector<TreeLight> lights;
    std::vector<std::uint32_t> emitter_of;  // a light that is nothing beside the greatest is left to the BSDF's samples
    for (std::size_t i = 0; i < geometry.emitters.size(); ++i) {
        const PathEmitter& emitter = geometry.emitters[i];
        if (!(emitter.weight / greatest > 0)) continue;
        lights.push_back({emitter.box, emitter.normal, emitter.everywhere, emitter.weight / greatest});
        emitter_of.push_back(static_cast<std::uint32_t>(i));
    }
    const LightTree tree = make_light_tree(lights);
    std::vector<uvec4> texels;
    for (std::size_t leaf = 0; leaf < tree.leaves.size(); ++leaf) {
        const PathEmitter& emitter = geometry.emitters[emitter_of[tree.leaves[leaf]]];
        set_light_density(geometry, emitter, double(leaf + 1));
        texels.emplace_back(emitter.primitive, 0u, 0u, 0u);
    }
    const auto texel = [](const vec3& v, std::uint32_t w) {
        return uvec4(std::bit_cast<std::uint32_t>(v.x), std::bit_cast<std::uint32_t>(v.y),
                     std::bit_cast<std::uint32_t>(v.z), w);
    };
    for (const LightTreeNode& node : tree.nodes) {
        texels.push_back(texel(node.low, std::bit_cast<std::uint32_t>(node.power)));
        texels.push_back(texel(node.high, std::bit_cast<std::uint32_t>(node.cos_normals)));
        texels.push_back(texel(node.axis, node.left_leaves));
    }
    return texels;
}

}  // namespace

EmitterTable emitter_table(PathGeometry& geometry, LightSelection selection)
{
    // A leaf's number must be exact in a float; and of two lights a tree knows little that their powers do not say.
    constexpr std::size_t kLeast = 3;
    constexpr std::size_t kMost = std::size_t{1} << 24;
    const std::size_t count = geometry.emitters.size();
    EmitterTable out;
    out.tree = selection == LightSelection::tree && count >= kLeast && count < kMost;
    out.texels = out.tree ? tree_texels(geometry) : alias_texels(geometry);
    // n leaves and 2n - 1 nodes of three texels.
    out.count = static_cast<std::uint32_t>(out.tree ? (out.texels.size() + 3) / 7 : out.texels.size());
    return out;
}

}  // namespace etalon
