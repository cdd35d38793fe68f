#include <fmt/format.h>

#include <algorithm>

#include "engine/scene/gltf_accessor.h"
#include "engine/scene/gltf_import.h"

namespace etalon::gltf {

namespace {

std::vector<dmat4> inverse_bind_of(const tinygltf::Skin& in, const AccessorReader& reader, const std::string& pointer)
{
    std::vector<dmat4> out(in.joints.size(), dmat4(1));
    if (in.inverseBindMatrices < 0) return out;
    const std::string at = pointer + "/inverseBindMatrices";
    if (const std::size_t count = reader.count(in.inverseBindMatrices); count < out.size())
        throw fault(at, fmt::format("{} matrices for {} joints [INVALID_IBM_ACCESSOR_COUNT]", count, out.size()));
    const Doubles matrices = reader.doubles(in.inverseBindMatrices, {16}, at);
    for (std::size_t i = 0; i < out.size(); ++i)
        for (int column = 0; column < 4; ++column)
            // The last row is 0 0 0 1 by the specification; what exporters leave of their rounding there is dropped.
            for (int row = 0; row < 3; ++row)
                out[i][column][row] = matrices.at(i, static_cast<std::size_t>(4 * column + row));
    return out;
}

// One more than the largest joint that a vertex of the mesh names.
std::size_t joints_named(const Mesh& mesh)
{
    std::size_t out = 0;
    for (const Primitive& primitive : mesh.primitives)
        for (const Influence& influence : primitive.influences)
            out = std::max(out, static_cast<std::size_t>(influence.joint) + 1);
    return out;
}

}  // namespace

void import_skins(const Source& source, Scene& scene)
{
    const AccessorReader reader(source);
    for (std::size_t i = 0; i < source.model.skins.size(); ++i) {
        const tinygltf::Skin& in = source.model.skins[i];
        const std::string pointer = fmt::format("/skins/{}", i);
        Skin out;
        out.name = in.name;
        for (const int joint : in.joints) out.joints.push_back(static_cast<Index>(joint));
        out.inverse_bind = inverse_bind_of(in, reader, pointer);
        scene.skins.push_back(std::move(out));
    }
    std::vector<std::size_t> named(scene.meshes.size());
    std::transform(scene.meshes.begin(), scene.meshes.end(), named.begin(), joints_named);
    for (std::size_t i = 0; i < scene.nodes.size(); ++i) {
        const Node& node = scene.nodes[i];
        if (node.skin == kNone || node.mesh == kNone) continue;
        const std::size_t joints = scene.skins[node.skin].joints.size();
        if (named[node.mesh] > joints)
            throw fault(fmt::format("/nodes/{}/skin", i),
                        fmt::format("mesh {} names joint {}, but skin {} has {} [ACCESSOR_JOINTS_INDEX_OOB]", node.mesh,
                                    named[node.mesh] - 1, node.skin, joints));
    }
}

}  // namespace etalon::gltf
