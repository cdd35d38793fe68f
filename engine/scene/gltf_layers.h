#pragma once
#include <optional>
#include <string>

#include "engine/scene/gltf_texture.h"

// What Khronos' material extensions say beyond glTF's metallic-roughness model. Values out of range are drawn as the
// nearest one within it, with a warning; values of the wrong type throw.
namespace etalon::gltf {

/// KHR_materials_pbrSpecularGlossiness, which then is the whole of the base: `out` changes its model. False where the
/// material has none.
bool apply_specular_glossiness(const tinygltf::Material& in, const std::string& pointer, Textures& textures,
                               Scene& scene, Material& out);

/// The layers of a metallic-roughness material `base`; nothing where no extension changes the picture. Textures of
/// layers that show nothing are not asked for, except where the material is animated: they may show later.
std::optional<MaterialLayers> read_layers(const tinygltf::Material& in, const std::string& pointer,
                                          const Material& base, bool animated, Textures& textures, Scene& scene);

/// Extensions that the file gives to a material that must not have them: one warning each.
void warn_of_excluded_layers(const tinygltf::Material& in, const std::string& pointer, Scene& scene);

}  // namespace etalon::gltf
