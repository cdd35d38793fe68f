#include "engine/render/path_layers.h"

#include "engine/render/material.h"

namespace etalon {
namespace {

constexpr std::size_t kMaterialTexels = 16;
constexpr std::size_t kLayerTexels = 36;

}  // namespace

bool layered(const Material& material)
{
    return material.layers.has_value() &&
           (material.model == BsdfModel::metallic_roughness || material.model == BsdfModel::specular_glossiness);
}

std::vector<uvec4> path_materials(std::span<const Material> scene_materials)
{
    std::vector<shared::MaterialRecord> materials = pack_materials(scene_materials);
    Material bare;
    bare.layers.emplace();
    std::vector<shared::LayerRecord> layers = pack_layers(std::span(&bare, 1));
    const std::vector<shared::LayerRecord> own = pack_layers(scene_materials);
    layers.insert(layers.end(), own.begin(), own.end());
    for (std::size_t i = 0; i < materials.size(); ++i) {
        const std::size_t index = layered(scene_materials[i]) ? 1 + materials[i].layers : 0;
        materials[i].layers = static_cast<shared::uint>(kMaterialTexels * materials.size() + kLayerTexels * index);
    }
    std::vector<uvec4> out = padded<kMaterialTexels>(materials);
    const std::vector<uvec4> tail = padded<kLayerTexels>(layers);
    out.insert(out.end(), tail.begin(), tail.end());
    return out;
}

}  // namespace etalon
