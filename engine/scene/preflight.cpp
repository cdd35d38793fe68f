#include "engine/scene/preflight.h"

#include <fmt/format.h>

#include "engine/scene/extensions.h"
#include "engine/scene/forest.h"
#include "engine/scene/preflight_parts.h"
#include "engine/scene/validate.h"

namespace etalon {

namespace document {

namespace {

void check_version(const json& document)
{
    const json* asset = member(document, "asset");
    const json* version = asset == nullptr ? nullptr : member(*asset, "version");
    if (version == nullptr || !version->is_string())
        throw fault(asset == nullptr     ? ""
                    : version == nullptr ? "/asset"
                                         : "/asset/version",
                    "the file does not say which glTF it is [UNDEFINED_PROPERTY]",
                    "a glTF 2.0 file holds {\"asset\": {\"version\": \"2.0\"}}");
    if (!version->get_ref<const std::string&>().starts_with("2."))
        throw fault("/asset/version", fmt::format("version {} [UNKNOWN_ASSET_MAJOR_VERSION]", brief(*version)),
                    "export as glTF 2.0");
    const json* least = member(*asset, "minVersion");
    if (least != nullptr && *least != "2.0")
        throw fault("/asset/minVersion",
                    fmt::format("the file needs at least glTF {} [UNKNOWN_ASSET_MINOR_VERSION]", brief(*least)),
                    "export as glTF 2.0");
}

void check_extensions(const json& document)
{
    std::vector<std::string> names;
    for_each(document, "/extensionsRequired/*", [&](const json& name, const Place& place) {
        if (!name.is_string()) refuse_kind(name, place, "an extension name");
        names.push_back(name);
    });
    check_required_extensions(names);
}

std::vector<std::size_t> indices_of(const json& object, std::string_view key)
{
    std::vector<std::size_t> out;
    if (const json* list = member(object, key))
        for (const json& index : *list) out.push_back(index.get<std::size_t>());
    return out;
}

void check_nodes(const json& document, const Limits& limits)
{
    std::vector<std::vector<std::size_t>> children;
    for (const json& node : collection(document, "/nodes")) children.push_back(indices_of(node, "children"));
    std::vector<std::vector<std::size_t>> scenes;
    for (const json& scene : collection(document, "/scenes")) scenes.push_back(indices_of(scene, "nodes"));
    check_forest(children, scenes, limits.node_depth);
}

void check_most(Unsigned count, Unsigned limit, const std::string& pointer, std::string_view what)
{
    if (count > limit)
        throw fault(pointer, fmt::format("{} {}; the limit is {}", count, what, limit),
                    "split the file, or lift the limits with --limits none");
}

// Things that a few bytes of JSON multiply, since many may share an accessor.
void check_counts(const json& document, const Limits& limits)
{
    const json& accessors = collection(document, "/accessors");
    const auto count_of = [&](const json& index) {
        return accessors[index.get<std::size_t>()]["count"].get<Unsigned>();
    };
    Unsigned sum = 0;
    const auto add = [&](const json& accessor, const Place& place, Unsigned limit, std::string_view what) {
        if (__builtin_add_overflow(sum, count_of(accessor), &sum)) sum = ~Unsigned{0};
        check_most(sum, limit, place.pointer(), what);
    };
    for_each(document, "/nodes/*/extensions/EXT_mesh_gpu_instancing/attributes/*",
             [&](const json& accessor, const Place& place) { add(accessor, place, limits.instances, "instances"); });
    sum = 0;
    for_each(document, "/animations/*/samplers/*/input", [&](const json& accessor, const Place& place) {
        add(accessor, place, limits.keyframes, "keyframes in all");
    });
    for_each(document, "/meshes/*/primitives/*/targets", [&](const json& targets, const Place& place) {
        check_most(targets.size(), limits.morph_targets, place.pointer(), "morph targets");
    });
    for_each(document, "/skins/*/joints", [&](const json& joints, const Place& place) {
        check_most(joints.size(), limits.joints, place.pointer(), "joints");
    });
}

// The parser wants a node in every target; those of KHR_animation_pointer have none.
void name_target_nodes(json& document)
{
    if (!document.contains("animations")) return;
    for (json& animation : document["animations"]) {
        const auto channels = animation.find("channels");
        if (channels == animation.end() || !channels->is_array()) continue;
        for (json& channel : *channels)
            if (channel.is_object() && channel.contains("target") && channel["target"].is_object() &&
                !channel["target"].contains("node"))
                channel["target"]["node"] = -1;
    }
}

// The parser wants a bufferView behind every index; what Draco fills has none. What is decoded goes before it.
void name_draco_views(json& document)
{
    for_each(document, "/meshes/*/primitives/*", [&](const json& primitive, const Place& place) {
        const json* extensions = member(primitive, "extensions");
        const json* extension = extensions == nullptr ? nullptr : member(*extensions, "KHR_draco_mesh_compression");
        const json* indices = member(primitive, "indices");
        if (extension == nullptr || indices == nullptr) return;
        json& accessor = document["accessors"][indices->get<std::size_t>()];
        if (!accessor.contains("bufferView"))
            accessor["bufferView"] = unsigned_at(*extension, "bufferView", place.pointer());
    });
}

}  // namespace

}  // namespace document

CheckedGltf preflight(std::span<const std::byte> bytes, const std::filesystem::path& folder, const Limits& limits)
{
    using namespace document;
    const GltfParts parts = split_gltf(bytes);
    if (parts.json.size() > limits.json_bytes)
        throw Error(Blame::input,
                    fmt::format("{} bytes of JSON; the limit is {}", parts.json.size(), limits.json_bytes));
    const LiftedText text(parts.json);
    json document = parse(text, limits);
    if (!document.is_object()) throw fault("", "the document is no JSON object [TYPE_MISMATCH]");
    check_version(document);
    check_extensions(document);
    check_collections(document);
    check_required(document);
    check_references(document);
    check_nodes(document, limits);

    CheckedGltf out;
    out.warnings = parts.warnings;
    set_aside_unknown(document, out.warnings);
    out.buffers = read_buffers(document, parts, text, folder, limits);
    std::vector<View> views = read_views(document, out.buffers);
    check_compressed_views(document, views, out.buffers);
    check_accessors(document, views, out.buffers, limits);
    warn_of_missing_data(document, views, out.buffers, out.warnings);
    check_counts(document, limits);
    out.images = read_images(document, text, views, out.buffers);
    out.broken_rules = validate(document, views, out.buffers);
    document.erase("buffers");
    document.erase("images");
    name_target_nodes(document);
    name_draco_views(document);
    out.json = document.dump();
    return out;
}

}  // namespace etalon
