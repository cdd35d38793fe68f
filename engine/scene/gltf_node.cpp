#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/math/transform.h"
#include "engine/scene/gltf_accessor.h"
#include "engine/scene/gltf_import.h"

namespace etalon::gltf {

namespace {

// Sets parent_from_node and what it is made of.
void read_transform(const tinygltf::Node& in, const std::string& pointer, Node& node)
{
    const auto check = [&](const std::vector<double>& values, std::size_t size, const char* name) {
        if (!values.empty() && values.size() != size)
            throw fault(fmt::format("{}/{}", pointer, name),
                        fmt::format("{} numbers instead of {} [ARRAY_LENGTH_NOT_IN_LIST]", values.size(), size));
    };
    check(in.matrix, 16, "matrix");
    check(in.translation, 3, "translation");
    check(in.rotation, 4, "rotation");
    check(in.scale, 3, "scale");
    if (!in.matrix.empty()) {
        dmat4 out;
        for (int column = 0; column < 4; ++column)
            for (int row = 0; row < 4; ++row) out[column][row] = in.matrix[static_cast<std::size_t>(4 * column + row)];
        if (out[0].w != 0 || out[1].w != 0 || out[2].w != 0 || out[3].w != 1)
            throw fault(pointer + "/matrix", "the last row is not 0 0 0 1 [NODE_MATRIX_NON_TRS]",
                        "projections are for cameras");
        node.parent_from_node = out;
        return;
    }
    Trs trs;
    if (!in.translation.empty()) trs.translation = dvec3(in.translation[0], in.translation[1], in.translation[2]);
    if (!in.rotation.empty()) trs.rotation = dquat(in.rotation[3], in.rotation[0], in.rotation[1], in.rotation[2]);
    if (!in.scale.empty()) trs.scale = dvec3(in.scale[0], in.scale[1], in.scale[2]);
    node.parent_from_node = compose(trs.translation, trs.rotation, trs.scale);
    node.trs = trs;
}

double positive(double value, const std::string& pointer)
{
    if (!(value > 0) || !std::isfinite(value))
        throw fault(pointer, fmt::format("{} is not above 0 [VALUE_NOT_IN_RANGE]", value));
    return value;
}

Camera camera_of(const tinygltf::Camera& in, const std::string& pointer)
{
    Camera out;
    out.name = in.name;
    if (in.type == "orthographic") {
        out.orthographic = true;
        // Negative extents mirror in some readers; the specification calls them invalid. The size is what is meant.
        out.xmag = positive(std::abs(in.orthographic.xmag), pointer + "/orthographic/xmag");
        out.ymag = positive(std::abs(in.orthographic.ymag), pointer + "/orthographic/ymag");
        out.znear = in.orthographic.znear;
    } else {
        out.yfov = positive(in.perspective.yfov, pointer + "/perspective/yfov");
        if (out.yfov >= kPi)
            throw fault(pointer + "/perspective/yfov",
                        fmt::format("{} is not below pi [VALUE_NOT_IN_RANGE]", out.yfov));
        out.znear = positive(in.perspective.znear, pointer + "/perspective/znear");
        if (in.perspective.aspectRatio > 0) out.aspect = in.perspective.aspectRatio;
    }
    out.lens = lens_extras(in.extras, pointer);
    return out;
}

Light light_of(const tinygltf::Light& in, const std::string& pointer, Scene& scene)
{
    Light out;
    out.name = in.name;
    if (in.type == "spot")
        out.type = LightType::spot;
    else if (in.type == "directional")
        out.type = LightType::directional;
    else if (in.type != "point") {
        scene.warnings.push_back(fmt::format("{}/type: \"{}\" is not known [VALUE_NOT_IN_LIST]: the light is ignored",
                                             pointer, in.type.substr(0, 60)));
        out.intensity = 0;
        return out;
    }
    if (in.color.size() == 3) out.color = dvec3(in.color[0], in.color[1], in.color[2]);
    out.intensity = in.intensity;
    out.range = in.range;
    if (out.intensity < 0 || out.range < 0 || out.color.x < 0 || out.color.y < 0 || out.color.z < 0)
        throw fault(pointer, "color, intensity and range are not negative [VALUE_NOT_IN_RANGE]");
    if (out.type == LightType::spot) {
        out.inner_cone = in.spot.innerConeAngle;
        out.outer_cone = in.spot.outerConeAngle;
        if (!(out.inner_cone >= 0 && out.inner_cone < out.outer_cone && out.outer_cone <= kPi / 2 + 1e-6))
            throw fault(pointer + "/spot/outerConeAngle",
                        fmt::format("cones of {} and {} radians [KHR_LIGHTS_PUNCTUAL_LIGHT_SPOT_ANGLES]",
                                    out.inner_cone, out.outer_cone),
                        "0 <= inner < outer <= pi/2");
    }
    return out;
}

std::vector<dmat4> instances_of(const Value& extension, AccessorReader& reader, const std::string& pointer)
{
    const Value* attributes = member(extension, "attributes");
    if (attributes == nullptr) return {};
    std::size_t count = 0;
    const auto read = [&](const char* name, std::size_t components) -> Floats {
        const Value* index = member(*attributes, name);
        if (index == nullptr) return {};
        const std::string at = fmt::format("{}/attributes/{}", pointer, name);
        const std::size_t own = reader.count(index->GetNumberAsInt());
        if (count != 0 && own != count)
            throw fault(at, fmt::format("{} elements, but another attribute has {}", own, count));
        count = own;
        return reader.floats(index->GetNumberAsInt(), {components}, at);
    };
    const Floats translation = read("TRANSLATION", 3);
    const Floats rotation = read("ROTATION", 4);
    const Floats scale = read("SCALE", 3);
    std::vector<dmat4> out;
    out.reserve(count);
    const auto vector = [](const Floats& in, std::size_t i, double standard) {
        return in.count == 0 ? dvec3(standard) : dvec3(in.at(i, 0), in.at(i, 1), in.at(i, 2));
    };
    for (std::size_t i = 0; i < count; ++i) {
        const dquat turn = rotation.count == 0
                               ? dquat(1, 0, 0, 0)
                               : dquat(rotation.at(i, 3), rotation.at(i, 0), rotation.at(i, 1), rotation.at(i, 2));
        out.push_back(compose(vector(translation, i, 0), turn, vector(scale, i, 1)));
    }
    return out;
}

Index index_of(int value)
{
    return value < 0 ? kNone : static_cast<Index>(value);
}

Node node_of(const tinygltf::Node& in, const std::string& pointer, AccessorReader& reader, std::size_t materials)
{
    Node out;
    out.name = in.name;
    read_transform(in, pointer, out);
    for (const int child : in.children) out.children.push_back(index_of(child));
    out.mesh = index_of(in.mesh);
    out.skin = index_of(in.skin);
    out.weights = in.weights;
    out.camera = index_of(in.camera);
    if (const Value* light = member(in.extensions, "KHR_lights_punctual"))
        if (const Value* index = member(*light, "light")) out.light = index_of(index->GetNumberAsInt());
    if (const Value* visibility = member(in.extensions, "KHR_node_visibility"))
        if (const Value* visible = member(*visibility, "visible"); visible != nullptr && visible->IsBool())
            out.visible = visible->Get<bool>();
    if (const Value* instancing = member(in.extensions, "EXT_mesh_gpu_instancing"))
        out.instances = instances_of(*instancing, reader, pointer + "/extensions/EXT_mesh_gpu_instancing");
    out.sphere = sphere_extras(in.extras, pointer, materials);
    return out;
}

void import_roots(const Source& source, Scene& scene)
{
    const auto& scenes = source.model.scenes;
    for (std::size_t i = 0; i < scenes.size(); ++i) {
        SceneRoot root;
        root.name = scenes[i].name;
        for (const int node : scenes[i].nodes) root.nodes.push_back(index_of(node));
        apply_scene_extras(scenes[i].extras, fmt::format("/scenes/{}", i), source.folder, root);
        scene.roots.push_back(std::move(root));
    }
    if (scene.roots.empty()) {
        // A library of nodes: all of it is shown.
        std::vector<bool> is_child(scene.nodes.size());
        for (const Node& node : scene.nodes)
            for (const Index child : node.children) is_child[child] = true;
        SceneRoot root;
        for (Index i = 0; i < scene.nodes.size(); ++i)
            if (!is_child[i]) root.nodes.push_back(i);
        scene.roots.push_back(std::move(root));
    }
    if (source.model.defaultScene >= 0) scene.default_root = static_cast<Index>(source.model.defaultScene);
}

}  // namespace

void import_nodes(const Source& source, Scene& scene)
{
    const Model& model = source.model;
    for (std::size_t i = 0; i < model.cameras.size(); ++i)
        scene.cameras.push_back(camera_of(model.cameras[i], fmt::format("/cameras/{}", i)));
    for (std::size_t i = 0; i < model.lights.size(); ++i)
        scene.lights.push_back(
            light_of(model.lights[i], fmt::format("/extensions/KHR_lights_punctual/lights/{}", i), scene));
    AccessorReader reader(source);
    for (std::size_t i = 0; i < model.nodes.size(); ++i)
        scene.nodes.push_back(node_of(model.nodes[i], fmt::format("/nodes/{}", i), reader, model.materials.size()));
    import_roots(source, scene);
}

}  // namespace etalon::gltf
