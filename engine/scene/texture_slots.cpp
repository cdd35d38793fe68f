#include "engine/scene/texture_slots.h"

#include <array>

namespace etalon {

std::span<const TextureSlot> texture_slots()
{
    using M = Material;
    using L = MaterialLayers;
    static constexpr std::array kSlots = {
        TextureSlot{"pbrMetallicRoughness/baseColorTexture", &M::base_color_texture},
        TextureSlot{"pbrMetallicRoughness/metallicRoughnessTexture", &M::metallic_roughness_texture},
        TextureSlot{"normalTexture", &M::normal_texture},
        TextureSlot{"occlusionTexture", &M::occlusion_texture},
        TextureSlot{"emissiveTexture", &M::emissive_texture},
        TextureSlot{"extensions/KHR_materials_specular/specularTexture", nullptr, &L::specular_texture},
        TextureSlot{"extensions/KHR_materials_specular/specularColorTexture", nullptr, &L::specular_color_texture},
        TextureSlot{"extensions/KHR_materials_clearcoat/clearcoatTexture", nullptr, &L::clearcoat_texture},
        TextureSlot{"extensions/KHR_materials_clearcoat/clearcoatRoughnessTexture", nullptr,
                    &L::clearcoat_roughness_texture},
        TextureSlot{"extensions/KHR_materials_clearcoat/clearcoatNormalTexture", nullptr, &L::clearcoat_normal_texture},
        TextureSlot{"extensions/KHR_materials_sheen/sheenColorTexture", nullptr, &L::sheen_color_texture},
        TextureSlot{"extensions/KHR_materials_sheen/sheenRoughnessTexture", nullptr, &L::sheen_roughness_texture},
        TextureSlot{"extensions/KHR_materials_transmission/transmissionTexture", nullptr, &L::transmission_texture},
        TextureSlot{"extensions/KHR_materials_volume/thicknessTexture", nullptr, &L::thickness_texture},
        TextureSlot{"extensions/KHR_materials_iridescence/iridescenceTexture", nullptr, &L::iridescence_texture},
        TextureSlot{"extensions/KHR_materials_iridescence/iridescenceThicknessTexture", nullptr,
                    &L::iridescence_thickness_texture},
        TextureSlot{"extensions/KHR_materials_anisotropy/anisotropyTexture", nullptr, &L::anisotropy_texture},
        TextureSlot{"extensions/KHR_materials_diffuse_transmission/diffuseTransmissionTexture", nullptr,
                    &L::diffuse_transmission_texture},
        TextureSlot{"extensions/KHR_materials_diffuse_transmission/diffuseTransmissionColorTexture", nullptr,
                    &L::diffuse_transmission_color_texture}};
    return kSlots;
}

}  // namespace etalon
