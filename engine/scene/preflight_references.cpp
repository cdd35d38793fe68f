#include <fmt/format.h>

#include <array>

#include "engine/scene/preflight_parts.h"

namespace etalon::document {

namespace {

// Which collection each index in the document points into; * stands for every element or member.
struct Reference {
    std::string_view from;
    std::string_view into;
};
constexpr std::string_view kVariants = "/extensions/KHR_materials_variants/variants";
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
    Reference{"/meshes/*/primitives/*/extensions/KHR_draco_mesh_compression/bufferView", "/bufferViews"},
    Reference{"/meshes/*/primitives/*/extensions/KHR_materials_variants/mappings/*/material", "/materials"},
    Reference{"/meshes/*/primitives/*/extensions/KHR_materials_variants/mappings/*/variants/*", kVariants},
    Reference{"/accessors/*/bufferView", "/bufferViews"},
    Reference{"/accessors/*/sparse/indices/bufferView", "/bufferViews"},
    Reference{"/accessors/*/sparse/values/bufferView", "/bufferViews"},
    Reference{"/bufferViews/*/buffer", "/buffers"},
    Reference{"/bufferViews/*/extensions/EXT_meshopt_compression/buffer", "/buffers"},
    Reference{"/bufferViews/*/extensions/KHR_meshopt_compression/buffer", "/buffers"},
    Reference{"/images/*/bufferView", "/bufferViews"},
    Reference{"/textures/*/source", "/images"},
    Reference{"/textures/*/sampler", "/samplers"},
    Reference{"/textures/*/extensions/EXT_texture_webp/source", "/images"},
    Reference{"/textures/*/extensions/KHR_texture_basisu/source", "/images"},
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

// Arrays of objects, where present.
constexpr std::array<std::string_view, 15> kCollections = {
    "/scenes",   "/nodes",     "/meshes",  "/accessors", "/bufferViews", "/buffers", "/images", "/textures",
    "/samplers", "/materials", "/cameras", "/skins",     "/animations",  kLights,    kVariants};

}  // namespace

void check_collections(const json& document)
{
    for (const std::string_view path : kCollections) {
        for_each(document, path, [](const json& value, const Place& place) {
            if (!value.is_array()) refuse_kind(value, place, "an array");
            for (std::size_t i = 0; i < value.size(); ++i)
                if (!value[i].is_object()) refuse_kind(value[i], Place{.parent = &place, .element = i}, "an object");
        });
    }
}

std::vector<bool> used_accessors(const json& document)
{
    std::vector<bool> out(collection(document, "/accessors").size());
    for (const Reference& row : kReferences)
        if (row.into == "/accessors")
            for_each(document, row.from, [&](const json& value, const Place&) { out[value.get<Unsigned>()] = true; });
    return out;
}

void check_references(const json& document)
{
    for (const Reference& row : kReferences) {
        const std::size_t size = collection(document, row.into).size();
        for_each(document, row.from, [&](const json& value, const Place& place) {
            if (!value.is_number_unsigned())
                throw fault(place.pointer(),
                            fmt::format("{} is not an index [{}]", brief(value),
                                        value.is_number_integer() ? "INVALID_INDEX" : "TYPE_MISMATCH"));
            if (value.get<Unsigned>() >= size)
                throw fault(place.pointer(), fmt::format("{} is out of range: {} has {} [UNRESOLVED_REFERENCE]",
                                                         value.get<Unsigned>(), row.into, size));
        });
    }
}

}  // namespace etalon::document
