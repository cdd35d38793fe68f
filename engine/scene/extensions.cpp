#include "engine/scene/extensions.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "engine/base/error.h"

namespace etalon {

namespace {

constexpr std::array<std::string_view, 26> kSupported = {
    "KHR_lights_punctual", "KHR_texture_transform", "KHR_materials_unlit", "KHR_materials_emissive_strength",
    "KHR_materials_ior", "KHR_materials_specular", "KHR_materials_clearcoat", "KHR_materials_sheen",
    "KHR_materials_transmission", "KHR_materials_volume", "KHR_materials_iridescence", "KHR_materials_anisotropy",
    "KHR_materials_dispersion", "KHR_materials_diffuse_transmission", "KHR_materials_pbrSpecularGlossiness",
    "KHR_node_visibility", "KHR_mesh_quantization", "EXT_mesh_gpu_instancing", "EXT_texture_webp",
    "KHR_materials_variants", "KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_meshopt_compression",
    "KHR_animation_pointer", "KHR_accessor_float64",
    // Metadata alone.
    "KHR_xmp_json_ld"};

struct Mend {
    std::string_view name;
    std::string_view mend;
};
constexpr std::array<Mend, 3> kMends = {{
    {"KHR_texture_basisu", "use PNG or JPEG textures: gltf-transform ktxdecompress in.glb out.glb"},
    {"EXT_texture_avif", "use PNG, JPEG or WebP textures: gltf-transform png in.glb out.glb"},
    {"MSFT_texture_dds", "use PNG, JPEG or WebP textures"},
}};

}  // namespace

bool is_supported_extension(std::string_view name)
{
    return std::find(kSupported.begin(), kSupported.end(), name) != kSupported.end();
}

std::string mend_for_extension(std::string_view name)
{
    const auto row = std::find_if(kMends.begin(), kMends.end(), [&](const Mend& m) { return m.name == name; });
    return std::string(
        row != kMends.end() ? row->mend : "export again without it, or make it optional if the scene can do without");
}

void check_required_extensions(std::span<const std::string> required)
{
    for (const std::string& name : required)
        if (!is_supported_extension(name))
            throw Error(Blame::input,
                        fmt::format("the file requires the extension {}, which Etalon does not read", name),
                        mend_for_extension(name))
                .at("/extensionsRequired");
}

std::vector<std::string> warnings_for_extensions(std::span<const std::string> used)
{
    std::vector<std::string> out;
    for (const std::string& name : used)
        if (!is_supported_extension(name))
            out.push_back(
                fmt::format("/extensionsUsed: {} is ignored: the picture is that of a reader without it", name));
    return out;
}

}  // namespace etalon
