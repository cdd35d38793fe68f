#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/scene/validate.h"

namespace etalon::document {

namespace {

constexpr Unsigned kVertexTarget = 34962;  // ARRAY_BUFFER

const json& element(const json& document, std::string_view path, std::size_t index)
{
    return collection(document, path)[index];
}

bool has_stride(const json& document, const json& object)
{
    const auto view = index_at(object, "bufferView");
    return view && member(element(document, "/bufferViews", *view), "byteStride") != nullptr;
}

void check_views(const json& document, Findings& findings)
{
    visit(document, "/bufferViews/*", [&](const json& view, const Place& place) {
        if (index_at(view, "byteLength") == 0u)
            findings.add(place.pointer() + "/byteLength", "0 bytes", "VALUE_NOT_IN_RANGE");
        const auto target = index_at(view, "target");
        if (target && *target != kVertexTarget && member(view, "byteStride") != nullptr)
            findings.add(place.pointer() + "/byteStride", "only vertices have a stride",
                         "BUFFER_VIEW_INVALID_BYTE_STRIDE");
    });
    const auto no_stride = [&](std::string_view objects, std::string_view code) {
        visit(document, objects, [&, code = code](const json& object, const Place& place) {
            if (has_stride(document, object))
                findings.add(place.pointer() + "/bufferView", "only vertices have a stride", code);
        });
    };
    no_stride("/images/*", "IMAGE_BUFFER_VIEW_WITH_BYTESTRIDE");
    no_stride("/accessors/*/sparse/indices", "BUFFER_VIEW_INVALID_BYTE_STRIDE");
    no_stride("/accessors/*/sparse/values", "BUFFER_VIEW_INVALID_BYTE_STRIDE");
    const auto packed = [&](std::string_view accessors, std::string_view code) {
        visit(document, accessors, [&, code = code](const json& accessor, const Place& place) {
            if (has_stride(document, element(document, "/accessors", accessor.get<std::size_t>())))
                findings.add(place.pointer(), "only vertices have a stride", code);
        });
    };
    packed("/meshes/*/primitives/*/indices", "MESH_PRIMITIVE_INDICES_ACCESSOR_WITH_BYTESTRIDE");
    packed("/animations/*/samplers/*/input", "ANIMATION_SAMPLER_ACCESSOR_WITH_BYTESTRIDE");
    packed("/animations/*/samplers/*/output", "ANIMATION_SAMPLER_ACCESSOR_WITH_BYTESTRIDE");
    packed("/skins/*/inverseBindMatrices", "SKIN_IBM_ACCESSOR_WITH_BYTESTRIDE");
}

void check_cameras(const json& document, Findings& findings)
{
    visit(document, "/cameras/*", [&](const json& camera, const Place& place) {
        if (member(camera, "perspective") != nullptr && member(camera, "orthographic") != nullptr)
            findings.add(place.pointer(), "both a perspective and an orthographic camera", "ONE_OF_MISMATCH");
        for (const std::string_view kind : {"perspective", "orthographic"})
            if (const json* lens = member(camera, kind))
                if (number_at(*lens, "zfar", HUGE_VAL) <= number_at(*lens, "znear", 0))
                    findings.add(fmt::format("{}/{}", place.pointer(), kind), "zfar is not beyond znear",
                                 "CAMERA_ZFAR_LEQUAL_ZNEAR");
    });
}

std::vector<bool> find_skinned_meshes(const json& document)
{
    std::vector<bool> out;
    for (const json& mesh : collection(document, "/meshes")) {
        out.push_back(false);
        visit(mesh, "/primitives/*/attributes/JOINTS_0", [&](const json&, const Place&) { out.back() = true; });
    }
    return out;
}

void check_nodes(const json& document, Findings& findings)
{
    const std::vector<bool> is_skinned = find_skinned_meshes(document);
    visit(document, "/nodes/*", [&](const json& node, const Place& place) {
        const bool has_parts = member(node, "translation") != nullptr || member(node, "rotation") != nullptr ||
                               member(node, "scale") != nullptr;
        if (member(node, "matrix") != nullptr && has_parts)
            findings.add(place.pointer() + "/matrix", "both a matrix and its parts", "NODE_MATRIX_TRS");
        double squares = 0;
        visit(node, "/rotation/*", [&](const json& q, const Place&) {
            if (q.is_number()) squares += q.get<double>() * q.get<double>();
        });
        if (member(node, "rotation") != nullptr && std::fabs(std::sqrt(squares) - 1) > kUnitQuaternion)
            findings.add(place.pointer() + "/rotation", fmt::format("a quaternion of length {}", std::sqrt(squares)),
                         "ROTATION_NON_UNIT");
        const auto mesh = index_at(node, "mesh");
        if (!mesh || !index_at(node, "skin")) return;
        if (!is_skinned[*mesh])
            findings.add(place.pointer(), fmt::format("mesh {} has no joints for the node's skin", *mesh),
                         "NODE_SKIN_WITH_NON_SKINNED_MESH");
    });
}

/// Of each node: the root above it. Nodes are a forest.
std::vector<std::size_t> roots_of(const json& document)
{
    const json& nodes = collection(document, "/nodes");
    std::vector<std::size_t> root(nodes.size());
    std::vector<bool> is_child(nodes.size());
    visit(nodes, "/*/children/*", [&](const json& child, const Place&) { is_child[child.get<std::size_t>()] = true; });
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        if (is_child[i]) continue;
        for (std::vector<std::size_t> open{i}; !open.empty();) {
            const std::size_t node = open.back();
            open.pop_back();
            root[node] = i;
            visit(nodes[node], "/children/*",
                  [&](const json& child, const Place&) { open.push_back(child.get<std::size_t>()); });
        }
    }
    return root;
}

void check_skins(const json& document, Findings& findings)
{
    const json& skins = collection(document, "/skins");
    if (skins.empty()) return;
    const std::vector<std::size_t> root = roots_of(document);
    const auto roots_of_joints = [&](const json& skin) {
        std::vector<std::size_t> roots;
        visit(skin, "/joints/*",
              [&](const json& joint, const Place&) { roots.push_back(root[joint.get<std::size_t>()]); });
        return roots;
    };
    std::vector<std::vector<std::size_t>> joint_roots;
    for (std::size_t i = 0; i < skins.size(); ++i) {
        joint_roots.push_back(roots_of_joints(skins[i]));
        std::vector<std::size_t>& roots = joint_roots.back();
        std::ranges::sort(roots);
        roots.erase(std::unique(roots.begin(), roots.end()), roots.end());
        if (roots.size() > 1)
            findings.add(fmt::format("/skins/{}/joints", i), "joints below different roots", "SKIN_NO_COMMON_ROOT");
    }
    std::vector<std::vector<std::size_t>> scenes_of(root.size());  // of a root
    std::size_t scene_number = 0;
    for (const json& scene : collection(document, "/scenes")) {
        visit(scene, "/nodes/*",
              [&](const json& node, const Place&) { scenes_of[node.get<std::size_t>()].push_back(scene_number); });
        ++scene_number;
    }
    std::size_t budget = 100'000'000;  // steps: nodes times scenes times roots may be any number
    visit(document, "/nodes/*", [&](const json& node, const Place& place) {
        const auto skin = index_at(node, "skin");
        if (!skin || !index_at(node, "mesh")) return;
        const std::vector<std::size_t>& own = scenes_of[root[place.element]];
        for (const std::size_t joint : joint_roots[*skin]) {
            const std::size_t steps = 1 + own.size() + scenes_of[joint].size();
            if (steps > budget) return;
            budget -= steps;
            if (!std::ranges::includes(scenes_of[joint], own))
                return findings.add(place.pointer(), "it is shown in a scene without the joints of its skin",
                                    "NODE_SKIN_NO_SCENE");
        }
    });
}

}  // namespace

void validate_objects(const json& document, Findings& findings)
{
    check_views(document, findings);
    check_cameras(document, findings);
    check_nodes(document, findings);
    check_skins(document, findings);
}

}  // namespace etalon::document
