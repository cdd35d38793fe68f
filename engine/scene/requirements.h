#pragma once
#include <array>
#include <bitset>
#include <string>
#include <string_view>
#include <vector>

#include "engine/scene/pose.h"
#include "engine/scene/settings.h"

namespace etalon {

/// What a picture of a scene needs of a renderer. Everything after this (vertex attributes, textures, descriptors,
/// specialization constants, passes, memory) is built from these bits. Neutral: a bit too many changes no pixel.
/// Necessary: clear a set bit, and the picture changes or the call refuses (tests/agree).
enum class Feature : unsigned {
    triangles,
    lines,
    points,
    spheres,
    normals,  ///< interpolated vertex normals (else flat: from the face)
    tangents,
    uv0,
    uv1,
    vertex_colors,
    base_color_texture,
    metallic_roughness_texture,
    normal_texture,
    occlusion_texture,
    emissive_texture,
    texture_transform,
    mipmaps,
    alpha_mask,
    alpha_blend,
    double_sided,
    metallic_roughness,
    unlit,
    lambert,
    mirror,
    rough_conductor,
    dielectric,
    rough_dielectric,
    specular_glossiness,
    specular,  ///< an index of refraction or KHR_materials_specular other than glTF's standard
    clearcoat,
    sheen,
    transmission,
    volume,  ///< bodies that refract and absorb
    iridescence,
    anisotropy,
    dispersion,
    diffuse_transmission,
    layer_textures,
    blinn_phong,
    emission,  ///< some visible surface emits
    punctual_lights,
    environment_constant,
    environment_map,
    visible_background,  ///< the environment is drawn behind the scene
    thin_lens,
    orthographic,
    equirectangular,
    msaa,
    aovs,
    count
};
inline constexpr std::size_t kFeatureCount = static_cast<std::size_t>(Feature::count);

std::string_view name(Feature feature);

/// The feature that a material of this model asks for.
Feature feature_of(BsdfModel model);

struct Requirements {
    std::bitset<kFeatureCount> bits;
    std::array<std::string, kFeatureCount>
        cause;                        ///< for each set bit, the first object that asked: "material 3 (glass)"
    std::vector<bool> texture_used;   ///< per Scene::textures
    std::vector<bool> material_used;  ///< per Scene::materials

    bool has(Feature feature) const { return bits[static_cast<std::size_t>(feature)]; }
    void set(Feature feature, std::string because);
};

/// Pure: the same answer for the same scene and settings, no device asked.
Requirements require(const PosedScene& posed, const RenderSettings& settings);
/// The same as if nothing needed this feature, nor any texture for its sake: to measure what it costs.
Requirements require_without(const PosedScene& posed, const RenderSettings& settings, Feature feature);

}  // namespace etalon
