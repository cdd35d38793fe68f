#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <initializer_list>

#include "engine/scene/validate.h"

namespace etalon::document {

namespace {

struct Required {
    std::string_view objects;
    std::vector<std::string_view> properties;  // owned: an initializer_list of a table would dangle
};

// What a reader cannot do without and the other checks do not miss.
const std::array kRequired = {
    Required{"/animations/*", {"channels", "samplers"}},
    Required{"/animations/*/channels/*", {"sampler", "target"}},
    Required{"/animations/*/channels/*/target", {"path"}},
    Required{"/animations/*/samplers/*", {"input", "output"}},
    Required{"/cameras/*", {"type"}},
    Required{"/cameras/*/perspective", {"yfov", "znear"}},
    Required{"/cameras/*/orthographic", {"xmag", "ymag", "zfar", "znear"}},
    Required{"/meshes/*", {"primitives"}},
    Required{"/meshes/*/primitives/*", {"attributes"}},
    Required{"/skins/*", {"joints"}},
    Required{"/extensions/KHR_lights_punctual/lights/*", {"type"}},
};

constexpr std::string_view kVariantMappings = "/meshes/*/primitives/*/extensions/KHR_materials_variants";

constexpr std::array kNotEmpty = {
    std::string_view("/accessors"),
    std::string_view("/animations"),
    std::string_view("/buffers"),
    std::string_view("/bufferViews"),
    std::string_view("/cameras"),
    std::string_view("/images"),
    std::string_view("/materials"),
    std::string_view("/meshes"),
    std::string_view("/nodes"),
    std::string_view("/samplers"),
    std::string_view("/scenes"),
    std::string_view("/skins"),
    std::string_view("/textures"),
    std::string_view("/extensionsUsed"),
    std::string_view("/extensionsRequired"),
    std::string_view("/animations/*/channels"),
    std::string_view("/animations/*/samplers"),
    std::string_view("/meshes/*/primitives"),
    std::string_view("/meshes/*/weights"),
    std::string_view("/meshes/*/primitives/*/attributes"),
    std::string_view("/meshes/*/primitives/*/targets"),
    std::string_view("/nodes/*/children"),
    std::string_view("/nodes/*/weights"),
    std::string_view("/scenes/*/nodes"),
    std::string_view("/skins/*/joints"),
    std::string_view("/extensions/KHR_lights_punctual/lights"),
    std::string_view("/extensions/KHR_materials_variants/variants"),
    std::string_view("/meshes/*/primitives/*/extensions/KHR_materials_variants/mappings"),
    std::string_view("/meshes/*/primitives/*/extensions/KHR_materials_variants/mappings/*/variants"),
};

// Where an extension's object may stand; Texture: in what refers to a texture.
struct Owners {
    std::string_view extension;
    std::vector<std::string_view> places;
};
constexpr std::string_view kMaterial = "/materials/*";
constexpr std::string_view kTextureInfo = "Texture";
const std::array kOwners = {
    Owners{"KHR_lights_punctual", {"", "/nodes/*"}},
    Owners{"KHR_materials_anisotropy", {kMaterial}},
    Owners{"KHR_materials_clearcoat", {kMaterial}},
    Owners{"KHR_materials_diffuse_transmission", {kMaterial}},
    Owners{"KHR_materials_dispersion", {kMaterial}},
    Owners{"KHR_materials_emissive_strength", {kMaterial}},
    Owners{"KHR_materials_ior", {kMaterial}},
    Owners{"KHR_materials_iridescence", {kMaterial}},
    Owners{"KHR_materials_pbrSpecularGlossiness", {kMaterial}},
    Owners{"KHR_materials_sheen", {kMaterial}},
    Owners{"KHR_materials_specular", {kMaterial}},
    Owners{"KHR_materials_transmission", {kMaterial}},
    Owners{"KHR_materials_unlit", {kMaterial}},
    Owners{"KHR_materials_volume", {kMaterial}},
    Owners{"KHR_materials_variants", {"", "/meshes/*/primitives/*"}},
    Owners{"KHR_mesh_quantization", {}},
    Owners{"KHR_texture_transform", {kTextureInfo}},
    Owners{"KHR_texture_basisu", {"/textures/*"}},
    Owners{"EXT_texture_webp", {"/textures/*"}},
    Owners{"KHR_animation_pointer", {"/animations/*/channels/*/target"}},
    Owners{"KHR_node_visibility", {"/nodes/*"}},
    Owners{"EXT_mesh_gpu_instancing", {"/nodes/*"}},
    Owners{"KHR_draco_mesh_compression", {"/meshes/*/primitives/*"}},
};

/// The place with * for every number: "/materials/*".
std::string pattern_of(const Place& place)
{
    if (place.parent == nullptr) return {};
    return pattern_of(*place.parent) + "/" + (place.key.data() == nullptr ? "*" : std::string(place.key));
}

bool may_own(const Owners& owners, const std::string& pattern)
{
    return std::ranges::any_of(owners.places, [&](std::string_view allowed) {
        return allowed == kTextureInfo ? pattern.starts_with(kMaterial) && pattern.ends_with(kTextureInfo)
                                       : pattern == allowed;
    });
}

class Extensions {
 public:
    Extensions(const json& document, Findings& findings) : findings_(findings)
    {
        visit(document, "/extensionsUsed/*", [&](const json& name, const Place&) {
            if (name.is_string()) used_.emplace_back(name.get_ref<const std::string&>());
        });
        std::ranges::sort(used_);
        walk(document, {});
    }

 private:
    // The document is no deeper than limits.json_depth.
    void walk(const json& value, const Place& place)
    {
        if (value.is_array())
            for (std::size_t i = 0; i < value.size(); ++i) {
                if (!value[i].is_structured()) break;  // numbers, as a rule
                walk(value[i], Place{.parent = &place, .element = i});
            }
        if (!value.is_object()) return;
        for (auto i = value.begin(); i != value.end(); ++i) {
            const Place below{.parent = &place, .key = i.key()};
            if (i.key() == "extras" || !i->is_structured()) continue;
            if (i.key() == "extensions")
                for (auto e = i->begin(); i->is_object() && e != i->end(); ++e)
                    check(e.key(), *e, Place{.parent = &below, .key = e.key()}, place);
            walk(*i, below);
        }
    }

    void check(const std::string& name, const json& value, const Place& place, const Place& owner)
    {
        if (!value.is_object())
            findings_.add(place.pointer(), fmt::format("{} instead of an object", brief(value)), "TYPE_MISMATCH");
        if (!std::ranges::binary_search(used_, name))
            findings_.add(place.pointer(), "the extension is not in extensionsUsed", "UNDECLARED_EXTENSION");
        const auto known = std::ranges::find(kOwners, name, &Owners::extension);
        if (known != kOwners.end() && !may_own(*known, pattern_of(owner)))
            findings_.add(place.pointer(), "the extension means nothing here", "UNEXPECTED_EXTENSION_OBJECT");
    }

    Findings& findings_;
    std::vector<std::string> used_;
};

void check_dependencies(const json& document, Findings& findings)
{
    struct Dependency {
        std::string_view objects, property, needs;
    };
    for (const auto& [objects, property, needs] :
         {Dependency{"/accessors/*", "byteOffset", "bufferView"}, Dependency{"/images/*", "bufferView", "mimeType"},
          Dependency{"/nodes/*", "skin", "mesh"}})
        visit(document, objects, [&, property = property, needs = needs](const json& object, const Place& place) {
            if (member(object, property) != nullptr && member(object, needs) == nullptr)
                findings.add(fmt::format("{}/{}", place.pointer(), property),
                             fmt::format("needs a {} beside it", needs), "UNSATISFIED_DEPENDENCY");
        });
}

void check_uris(const json& document, Findings& findings)
{
    const auto check = [&](std::string_view objects, std::initializer_list<std::string_view> media) {
        visit(document, objects, [&](const json& uri, const Place& place) {
            if (!uri.is_string()) return;
            std::string_view text = uri.get_ref<const std::string&>();
            bool is_good = !text.starts_with(':');
            if (text.starts_with("data:")) {
                text = text.substr(5, text.find(',') == std::string_view::npos ? 0 : text.find(',') - 5);
                is_good = text.find(";;") == std::string_view::npos &&
                          std::ranges::any_of(media, [&](std::string_view type) { return text.starts_with(type); });
            }
            if (!is_good) findings.add(place.pointer(), "no URI of this kind of data", "INVALID_URI");
        });
    };
    check("/buffers/*/uri", {"application/octet-stream", "application/gltf-buffer"});
    check("/images/*/uri", {"image/png", "image/jpeg", "image/webp", "image/ktx2"});
}

void check_variants(const json& document, Findings& findings)
{
    visit(document, kVariantMappings, [&](const json& extension, const Place& place) {
        if (member(extension, "mappings") == nullptr)
            findings.add(place.pointer(), "mappings is missing", "UNDEFINED_PROPERTY");
    });
    visit(document, "/extensions/KHR_materials_variants/variants/*/name", [&](const json& name, const Place& place) {
        if (!name.is_string())
            findings.add(place.pointer(), fmt::format("{} is no name", brief(name)), "TYPE_MISMATCH");
    });
}

}  // namespace

void Findings::add(const std::string& pointer, std::string_view what, std::string_view code)
{
    constexpr std::size_t kMost = 100;
    if (lines_.size() < kMost)
        lines_.push_back(fmt::format("{}: {} [{}]", pointer, what, code));
    else
        ++more_;
}

std::vector<std::string> Findings::lines() &&
{
    if (more_ > 0) lines_.push_back(fmt::format("{} more rules of glTF are broken", more_));
    return std::move(lines_);
}

void check_required(const json& document)
{
    for (const Required& row : kRequired)
        visit(document, row.objects, [&](const json& object, const Place& place) {
            if (!object.is_object()) return;
            for (const std::string_view property : row.properties)
                if (member(object, property) == nullptr)
                    throw fault(place.pointer(), fmt::format("{} is missing [UNDEFINED_PROPERTY]", property));
        });
    const auto needs_part = [](const json& object, const Place& place, std::string_view part) {
        if (text_at(object, "type") == part && member(object, part) == nullptr)
            throw fault(place.pointer(), fmt::format("{} is missing [UNDEFINED_PROPERTY]", part));
    };
    visit(document, "/cameras/*", [&](const json& camera, const Place& place) {
        needs_part(camera, place, "perspective");
        needs_part(camera, place, "orthographic");
    });
    visit(document, "/extensions/KHR_lights_punctual/lights/*",
          [&](const json& light, const Place& place) { needs_part(light, place, "spot"); });
    const auto needs_root = [&](std::string_view objects, std::string_view reference, std::string_view root) {
        bool is_there = false;
        visit(document, root, [&](const json&, const Place&) { is_there = true; });
        if (is_there) return;
        visit(document, objects, [&](const json& object, const Place& place) {
            if (member(object, reference) != nullptr)
                throw fault(place.pointer(), fmt::format("needs {} [UNSATISFIED_DEPENDENCY]", root));
        });
    };
    needs_root("/nodes/*/extensions/KHR_lights_punctual", "light", "/extensions/KHR_lights_punctual");
    needs_root("/meshes/*/primitives/*/extensions/KHR_materials_variants/mappings/*", "variants",
               "/extensions/KHR_materials_variants");
}

std::vector<std::string> validate(const json& document, std::span<const View> views,
                                  std::span<const GltfBuffer> buffers)
{
    Findings findings;
    validate_properties(document, findings);
    validate_objects(document, findings);
    validate_meshes(document, findings);
    validate_animations(document, findings);
    validate_values(document, views, buffers, findings);
    return std::move(findings).lines();
}

void validate_properties(const json& document, Findings& findings)
{
    for (const std::string_view pattern : kNotEmpty)
        visit(document, pattern, [&](const json& value, const Place& place) {
            if (value.is_structured() && value.empty()) findings.add(place.pointer(), "is empty", "EMPTY_ENTITY");
        });
    check_dependencies(document, findings);
    check_uris(document, findings);
    check_variants(document, findings);
    visit(document, "/nodes/*/extensions/KHR_lights_punctual", [&](const json& extension, const Place& place) {
        if (member(extension, "light") == nullptr)
            findings.add(place.pointer(), "light is missing", "UNDEFINED_PROPERTY");
    });
    const Extensions extensions(document, findings);
}

}  // namespace etalon::document
