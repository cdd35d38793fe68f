#pragma once
#include <span>
#include <string_view>

#include "engine/scene/scene.h"

namespace etalon {

/// A place of a material where a texture may be.
struct TextureSlot {
    std::string_view where;  ///< below the material in a glTF document: "pbrMetallicRoughness/baseColorTexture"
    TextureUse Material::*own = nullptr;
    TextureUse MaterialLayers::*layer = nullptr;  ///< where `own` is null

    /// Nothing where the material has no layers.
    const TextureUse* of(const Material& material) const
    {
        if (own != nullptr) return &(material.*own);
        return material.layers ? &((*material.layers).*layer) : nullptr;
    }
    TextureUse* of(Material& material) const
    {
        if (own != nullptr) return &(material.*own);
        return material.layers ? &((*material.layers).*layer) : nullptr;
    }
};

/// All of them, in the order of Material and MaterialLayers.
std::span<const TextureSlot> texture_slots();

}  // namespace etalon
