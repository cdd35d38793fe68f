#include "engine/scene/preflight.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include "engine/base/error.h"
#include "engine/scene/extensions.h"
#include "engine/scene/forest.h"
#include "engine/scene/glb.h"
#include "engine/scene/json_check.h"
#include "engine/scene/resources.h"

namespace etalon {

namespace {

using nlohmann::json;
using Unsigned = std::uint64_t;

Error fault(const std::string& pointer, std::string what, std::string mend = "export again, or repair the file by hand")
{
    Error error(Blame::input, std::move(what), std::move(mend));
    error.at(pointer.empty() ? "/" : pointer);
    return error;
}

std::string brief(const json& value)
{
    if (value.is_structured()) return value.is_array() ? "an array" : "an object";
    std::string text = value.dump(-1, ' ', false, json::error_handler_t::replace);
    if (text.size() > 60) text = text.substr(0, 60) + "…";
    return text;
}

json parse(std::string_view text, const GltfLimits& limits)
{
    while (text.ends_with('\0')) text.remove_suffix(1);  // some writers pad the JSON chunk with zeros instead of spaces
    // Two passes, not one with a callback: nlohmann's callback parser takes time quadratic in the elements of an array.
    check_json(text, limits);
    return json::parse(text.begin(), text.end());
}

// Which collection each index in the document points into; * stands for every element or member.
struct Reference {
    std::string_view from;
    std::string_view into;
};
constexpr std::string_view kLights = "/extensions/KHR_lights_punctual/lights";
constexpr std::array kReferences = {
    Reference{"/scene", "/scenes"},
    Reference{"/scenes/*/nodes/*", "/nodes"},
    Reference{"/nodes/*/children/*", "/nodes"},
    Reference{"/nodes/*/mesh", "/meshes"},
    Reference{"/nodes/*/camera", "/cameras"},
    Reference{"/nodes/*/skin", "/skins"},
    Reference{"/nodes/*/extensions/KHR_lights_punctual/light", kLights},
    Reference{"/nodes/*/extensions/EXT_mesh_gpu_instancing/attributes/*", "/accessors"},
    Reference{"/meshes/*/primitives/*/attributes/*", "/accessors"},
    Reference{"/meshes/*/primitives/*/indices", "/accessors"},
    Reference{"/meshes/*/primitives/*/material", "/materials"},
    Reference{"/meshes/*/primitives/*/targets/*/*", "/accessors"},
    Reference{"/accessors/*/bufferView", "/bufferViews"},
    Reference{"/accessors/*/sparse/indices/bufferView", "/bufferViews"},
    Reference{"/accessors/*/sparse/values/bufferView", "/bufferViews"},
    Reference{"/bufferViews/*/buffer", "/buffers"},
    Reference{"/images/*/bufferView", "/bufferViews"},
    Reference{"/textures/*/source", "/images"},
    Reference{"/textures/*/sampler", "/samplers"},
    Reference{"/textures/*/extensions/EXT_texture_webp/source", "/images"},
    Reference{"/materials/*/pbrMetallicRoughness/baseColorTexture/index", "/textures"},
    Reference{"/materials/*/pbrMetallicRoughness/metallicRoughnessTexture/index", "/textures"},
    Reference{"/materials/*/normalTexture/index", "/textures"},
    Reference{"/materials/*/occlusionTexture/index", "/textures"},
    Reference{"/materials/*/emissiveTexture/index", "/textures"},
    Reference{"/materials/*/extensions/KHR_materials_specular/specularTexture/index", "/textures"},
    Reference{"/materials/*/extensions/KHR_materials_specular/specularColorTexture/index", "/textures"},
    Reference{"/materials/*/extensions/KHR_materials_clearcoat/clearcoatTexture/index", "/textures"},
    Reference{"/materials/*/extensions/KHR_materials_clearcoat/clearcoatRoughnessTexture/index", "/textures"},
    Reference{"/materials/*/extensions/KHR_materials_clearcoat/clearcoatNormalTexture/index", "/textures"},
    Reference{"/materials/*/extensions/KHR_materials_sheen/sheenColorTexture/index", "/textures"},
    Reference{"/materials/*/extensions/KHR_materials_sheen/sheenRoughnessTexture/index", "/textures"},
    Reference{"/materials/*/extensions/KHR_materials_transmission/transmissionTexture/index", "/textures"},
    Reference{"/materials/*/extensions/KHR_materials_volume/thicknessTexture/index", "/textures"},
    Reference{"/materials/*/extensions/KHR_materials_iridescence/iridescenceTexture/index", "/textures"},
    Reference{"/materials/*/extensions/KHR_materials_iridescence/iridescenceThicknessTexture/index", "/textures"},
    Reference{"/materials/*/extensions/KHR_materials_anisotropy/anisotropyTexture/index", "/textures"},
    Reference{"/materials/*/extensions/KHR_materials_diffuse_transmission/diffuseTransmissionTexture/index",
              "/textures"},
    Reference{"/materials/*/extensions/KHR_materials_diffuse_transmission/diffuseTransmissionColorTexture/index",
              "/textures"},
    Reference{"/materials/*/extensions/KHR_materials_pbrSpecularGlossiness/diffuseTexture/index", "/textures"},
    Reference{"/materials/*/extensions/KHR_materials_pbrSpecularGlossiness/specularGlossinessTexture/index",
              "/textures"},
    Reference{"/skins/*/joints/*", "/nodes"},
    Reference{"/skins/*/skeleton", "/nodes"},
    Reference{"/skins/*/inverseBindMatrices", "/accessors"},
    Reference{"/animations/*/samplers/*/input", "/accessors"},
    Reference{"/animations/*/samplers/*/output", "/accessors"},
    Reference{"/animations/*/channels/*/target/node", "/nodes"},
};

std::string escaped(std::string_view key)
{
    std::string out;
    for (const char c : key) out += c == '~' ? std::string("~0") : c == '/' ? std::string("~1") : std::string(1, c);
    return out;
}

// Calls `with(value, pointer)` for everything in `at` that `pattern` names. Members that are absent are passed over.
template <typename Function>
void for_each(const json& at, std::string_view pattern, const std::string& pointer, const Function& with)
{
    if (pattern.empty()) return with(at, pointer);
    const std::size_t slash = std::min(pattern.find('/', 1), pattern.size());
    const std::string_view key = pattern.substr(1, slash - 1);
    const std::string_view rest = pattern.substr(slash);
    if (key == "*") {
        if (!at.is_structured())
            throw fault(pointer, fmt::format("{} instead of an array or object [TYPE_MISMATCH]", brief(at)));
        std::size_t i = 0;
        if (at.is_array())
            for (const json& element : at) for_each(element, rest, fmt::format("{}/{}", pointer, i++), with);
        else
            for (const auto& [name, member] : at.items()) for_each(member, rest, pointer + "/" + escaped(name), with);
        return;
    }
    if (!at.is_object()) throw fault(pointer, fmt::format("{} instead of an object [TYPE_MISMATCH]", brief(at)));
    if (const auto member = at.find(key); member != at.end())
        for_each(*member, rest, fmt::format("{}/{}", pointer, key), with);
}

struct View {
    Unsigned length = 0;
    Unsigned stride = 0;  // 0: packed
    Unsigned buffer = 0;
    Unsigned offset = 0;
};

class Check {
 public:
    Check(json document, const GltfParts& parts, const std::filesystem::path& folder, const GltfLimits& limits)
        : document_(std::move(document)), parts_(parts), folder_(folder), limits_(limits)
    {
        if (!document_.is_object()) throw fault("", "the document is no JSON object [TYPE_MISMATCH]");
        version();
        required_extensions();
        collections();
        references();
        buffers();
        buffer_views();
        accessors();
        images();
        forest();
    }

    CheckedGltf result() &&
    {
        document_.erase("buffers");
        document_.erase("images");
        out_.json = document_.dump();
        return std::move(out_);
    }

 private:
    // The unsigned integer `key` of `object`; `standard` when absent; fault when it is anything else.
    static Unsigned unsigned_at(const json& object, const char* key, const std::string& pointer,
                                std::optional<Unsigned> standard)
    {
        const auto found = object.find(key);
        if (found == object.end()) {
            if (standard) return *standard;
            throw fault(pointer, fmt::format("{} is missing [UNDEFINED_PROPERTY]", key));
        }
        if (!found->is_number_unsigned())
            throw fault(fmt::format("{}/{}", pointer, key),
                        fmt::format("{} is not a whole number [TYPE_MISMATCH]", brief(*found)));
        return found->get<Unsigned>();
    }

    const json& collection(std::string_view path) const
    {
        static const json kEmpty = json::array();
        const json::json_pointer pointer{std::string(path)};
        return document_.contains(pointer) ? document_.at(pointer) : kEmpty;
    }

    void version() const
    {
        const auto asset = document_.find("asset");
        if (asset == document_.end() || !asset->is_object() || !asset->contains("version") ||
            !asset->at("version").is_string())
            throw fault("/asset/version", "the file does not say which glTF it is [UNDEFINED_PROPERTY]",
                        "a glTF 2.0 file holds {\"asset\": {\"version\": \"2.0\"}}");
        const auto& version = asset->at("version").get_ref<const std::string&>();
        if (!version.starts_with("2."))
            throw fault("/asset/version", fmt::format("version \"{}\" [UNKNOWN_ASSET_MAJOR_VERSION]", version),
                        "export as glTF 2.0");
        const auto least = asset->find("minVersion");
        if (least != asset->end() && *least != "2.0")
            throw fault("/asset/minVersion",
                        fmt::format("the file needs at least glTF {} [UNKNOWN_ASSET_MINOR_VERSION]", brief(*least)),
                        "export as glTF 2.0");
    }

    void required_extensions() const
    {
        std::vector<std::string> names;
        for_each(document_, "/extensionsRequired/*", "", [&](const json& name, const std::string& pointer) {
            if (!name.is_string())
                throw fault(pointer, fmt::format("{} is no extension name [TYPE_MISMATCH]", brief(name)));
            names.push_back(name);
        });
        check_required_extensions(names);
    }

    void collections() const
    {
        for (const char* path :
             {"/scenes", "/nodes", "/meshes", "/accessors", "/bufferViews", "/buffers", "/images", "/textures",
              "/samplers", "/materials", "/cameras", "/skins", "/animations", kLights.data()})
            for_each(document_, path, "", [](const json& value, const std::string& pointer) {
                if (!value.is_array())
                    throw fault(pointer, fmt::format("{} instead of an array [TYPE_MISMATCH]", brief(value)));
                for (std::size_t i = 0; i < value.size(); ++i)
                    if (!value[i].is_object())
                        throw fault(fmt::format("{}/{}", pointer, i),
                                    fmt::format("{} instead of an object [TYPE_MISMATCH]", brief(value[i])));
            });
    }

    void references() const
    {
        for (const Reference& row : kReferences) {
            const std::size_t size = collection(row.into).size();
            for_each(document_, row.from, "", [&](const json& value, const std::string& pointer) {
                if (!value.is_number_unsigned())
                    throw fault(pointer, fmt::format("{} is not an index [TYPE_MISMATCH]", brief(value)));
                if (value.get<Unsigned>() >= size)
                    throw fault(pointer, fmt::format("{} is out of range: {} has {} [UNRESOLVED_REFERENCE]",
                                                     value.get<Unsigned>(), row.into, size));
            });
        }
    }

    void buffers()
    {
        std::size_t i = 0;
        for (const json& buffer : collection("/buffers")) {
            const std::string pointer = fmt::format("/buffers/{}", i);
            const Unsigned declared = unsigned_at(buffer, "byteLength", pointer, {});
            GltfBuffer out;
            const auto uri = buffer.find("uri");
            if (uri != buffer.end()) {
                if (!uri->is_string())
                    throw fault(pointer + "/uri", fmt::format("{} is no URI [TYPE_MISMATCH]", brief(*uri)));
                try {
                    out.owned = read_uri(uri->get_ref<const std::string&>(), folder_, limits_.resource_bytes);
                } catch (Error& error) {
                    throw error.at(pointer + "/uri");
                }
                out.bytes = out.owned;
            } else if (i == 0 && parts_.binary) {
                out.bytes = *parts_.binary;
            }
            const bool has_data = uri != buffer.end() || (i == 0 && parts_.binary);
            if (has_data && out.bytes.size() < declared)
                throw fault(pointer + "/byteLength",
                            fmt::format("buffer of {} bytes has only {} [BUFFER_BYTE_LENGTH_MISMATCH]", declared,
                                        out.bytes.size()));
            out.bytes = out.bytes.first(has_data ? declared : 0);
            declared_.push_back(declared);
            out_.buffers.push_back(std::move(out));
            ++i;
        }
    }

    void buffer_views()
    {
        std::size_t i = 0;
        for (const json& view : collection("/bufferViews")) {
            const std::string pointer = fmt::format("/bufferViews/{}", i++);
            View out;
            out.buffer = unsigned_at(view, "buffer", pointer, {});
            out.offset = unsigned_at(view, "byteOffset", pointer, 0);
            out.length = unsigned_at(view, "byteLength", pointer, {});
            out.stride = unsigned_at(view, "byteStride", pointer, 0);
            const Unsigned have = declared_[out.buffer];
            if (out.offset > have || out.length > have - out.offset)
                throw fault(
                    pointer,
                    fmt::format("{} bytes from byte {} do not fit in buffer {} of {} bytes [BUFFER_VIEW_TOO_LONG]",
                                out.length, out.offset, out.buffer, have));
            if (view.contains("byteStride") && (out.stride < 4 || out.stride > 252 || out.stride % 4 != 0))
                throw fault(
                    pointer + "/byteStride",
                    fmt::format("{}: a stride is a multiple of 4 from 4 to 252 [VALUE_NOT_IN_RANGE]", out.stride));
            views_.push_back(out);
        }
    }

    // Room for `count` elements of `size` bytes from `offset` in view `index`.
    void check_room(const std::string& pointer, Unsigned index, Unsigned offset, Unsigned count, Unsigned size,
                    Unsigned stride) const
    {
        const View& view = views_[index];
        Unsigned end = 0;
        if (__builtin_mul_overflow(count - 1, stride, &end) || __builtin_add_overflow(end, size, &end) ||
            __builtin_add_overflow(end, offset, &end) || end > view.length)
            throw fault(
                pointer,
                fmt::format("{} elements of {} bytes from byte {}, stride {}, do not fit in bufferView {} of {} bytes "
                            "[ACCESSOR_TOO_LONG]",
                            count, size, offset, stride, index, view.length));
    }

    // Bytes of one component, or 0 for a type that glTF does not know.
    static Unsigned component_size(Unsigned type)
    {
        switch (type) {
            case 5120:
            case 5121:
                return 1;
            case 5122:
            case 5123:
                return 2;
            case 5125:
            case 5126:
                return 4;
            default:
                return 0;
        }
    }

    // Columns of small matrices begin at multiples of four bytes.
    static Unsigned element_size(const std::string& type, Unsigned component)
    {
        if (type == "SCALAR") return component;
        if (type == "VEC2") return 2 * component;
        if (type == "VEC3") return 3 * component;
        if (type == "VEC4") return 4 * component;
        const auto padded = [](Unsigned bytes) { return (bytes + 3) / 4 * 4; };
        if (type == "MAT2") return padded(2 * component) + 2 * component;
        if (type == "MAT3") return 2 * padded(3 * component) + 3 * component;
        if (type == "MAT4") return 16 * component;
        return 0;
    }

    void accessors()
    {
        Unsigned zero_filled = 0;
        std::size_t i = 0;
        for (const json& accessor : collection("/accessors")) {
            const std::string pointer = fmt::format("/accessors/{}", i++);
            const Unsigned component_type = unsigned_at(accessor, "componentType", pointer, {});
            const auto type = accessor.find("type");
            if (type == accessor.end() || !type->is_string())
                throw fault(pointer, "type is missing [UNDEFINED_PROPERTY]");
            const Unsigned size = element_size(type->get_ref<const std::string&>(), component_size(component_type));
            if (size == 0)
                throw fault(pointer, fmt::format("type {} of component type {} does not exist [VALUE_NOT_IN_LIST]",
                                                 brief(*type), component_type));
            const Unsigned count = unsigned_at(accessor, "count", pointer, {});
            if (count == 0)
                throw fault(pointer + "/count", "0: an accessor has at least one element [VALUE_NOT_IN_RANGE]");
            const Unsigned offset = unsigned_at(accessor, "byteOffset", pointer, 0);
            if (accessor.contains("bufferView")) {
                const Unsigned view = accessor["bufferView"].get<Unsigned>();
                const Unsigned stride = views_[view].stride == 0 ? size : views_[view].stride;
                if (stride < size)
                    throw fault(pointer, fmt::format("elements of {} bytes do not fit in stride {} of bufferView {} "
                                                     "[ACCESSOR_TOTAL_OFFSET_ALIGNMENT]",
                                                     size, stride, view));
                check_room(pointer, view, offset, count, size, stride);
            } else if (__builtin_add_overflow(zero_filled, saturating_product(count, size), &zero_filled) ||
                       zero_filled > limits_.zero_filled_bytes) {
                throw fault(pointer + "/count", fmt::format("{} elements without data: the limit is {} bytes in all",
                                                            count, limits_.zero_filled_bytes));
            }
            if (accessor.contains("sparse")) sparse(accessor["sparse"], pointer + "/sparse", count, size);
        }
    }

    static Unsigned saturating_product(Unsigned a, Unsigned b)
    {
        Unsigned out = 0;
        return __builtin_mul_overflow(a, b, &out) ? ~Unsigned{0} : out;
    }

    void sparse(const json& value, const std::string& pointer, Unsigned base_count, Unsigned size) const
    {
        for (const char* part : {"indices", "values"})
            if (!value.is_object() || !value.contains(part) || !value[part].is_object() ||
                !value[part].contains("bufferView"))
                throw fault(pointer, fmt::format("{} is missing [UNDEFINED_PROPERTY]", part));
        const Unsigned count = unsigned_at(value, "count", pointer, {});
        if (count == 0 || count > base_count)
            throw fault(pointer + "/count",
                        fmt::format("{} of {} elements [ACCESSOR_SPARSE_COUNT_OUT_OF_RANGE]", count, base_count));
        const json& indices = value["indices"];
        const Unsigned type = unsigned_at(indices, "componentType", pointer + "/indices", {});
        if (type != 5121 && type != 5123 && type != 5125)
            throw fault(pointer + "/indices/componentType", fmt::format("{} [VALUE_NOT_IN_LIST]", type));
        const Unsigned index_size = component_size(type);
        check_room(pointer + "/indices", indices["bufferView"].get<Unsigned>(),
                   unsigned_at(indices, "byteOffset", pointer, 0), count, index_size, index_size);
        const json& values = value["values"];
        check_room(pointer + "/values", values["bufferView"].get<Unsigned>(),
                   unsigned_at(values, "byteOffset", pointer, 0), count, size, size);
    }

    void images()
    {
        std::size_t i = 0;
        for (const json& image : collection("/images")) {
            const std::string pointer = fmt::format("/images/{}", i++);
            GltfImage out;
            if (image.contains("name") && image["name"].is_string()) out.name = image["name"];
            if (image.contains("bufferView")) {
                const Unsigned index = image["bufferView"].get<Unsigned>();
                const View& view = views_[index];
                if (view.length == 0) throw fault(pointer, fmt::format("bufferView {} is empty", index));
                check_room(pointer, index, 0, 1, view.length, view.length);
                const auto& data = out_.buffers[view.buffer].bytes;
                // Without data: empty, and an error only for who needs it.
                out.bytes = data.empty() ? data : data.subspan(view.offset, view.length);
            } else if (image.contains("uri") && image["uri"].is_string()) {
                out.uri = image["uri"];
            } else {
                throw fault(pointer, "an image needs a uri or a bufferView [ONE_OF_MISMATCH]");
            }
            if (out.name.empty()) out.name = out.bytes ? pointer : out.uri.substr(0, 80);
            out_.images.push_back(std::move(out));
        }
    }

    void forest() const
    {
        std::vector<std::vector<std::size_t>> children(collection("/nodes").size());
        std::size_t n = 0;
        for (const json& node : collection("/nodes")) {
            if (node.contains("children"))
                for (const json& child : node["children"]) children[n].push_back(child.get<std::size_t>());
            ++n;
        }
        std::vector<std::vector<std::size_t>> scenes;
        for (const json& scene : collection("/scenes")) {
            scenes.emplace_back();
            if (scene.contains("nodes"))
                for (const json& node : scene["nodes"]) scenes.back().push_back(node.get<std::size_t>());
        }
        check_forest(children, scenes);
    }

    json document_;
    const GltfParts& parts_;
    const std::filesystem::path& folder_;
    const GltfLimits& limits_;
    std::vector<Unsigned> declared_;  // byteLength of each buffer
    std::vector<View> views_;
    CheckedGltf out_;
};

}  // namespace

CheckedGltf preflight(std::span<const std::byte> bytes, const std::filesystem::path& folder, const GltfLimits& limits)
{
    const GltfParts parts = split_gltf(bytes);
    return Check(parse(parts.json, limits), parts, folder, limits).result();
}

}  // namespace etalon
