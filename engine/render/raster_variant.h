#pragma once
#include <array>
#include <compare>
#include <cstdint>
#include <string>

#include "engine/scene/pose.h"
#include "engine/scene/requirements.h"
#include "engine/scene/settings.h"

namespace etalon {

/// The specialization constants of shaders/raster/features.glsl; the value is the constant's id.
enum class RasterConstant : unsigned {
    model,
    base_color_texture,
    metallic_roughness_texture,
    normal_texture,
    occlusion_texture,
    emissive_texture,
    texture_transform,
    normals,
    uv1,
    vertex_colors,
    alpha_mask,
    alpha_blend,
    lit,
    punctual_lights,
    environment,
    blinn_phong,
    emission,
    orthographic,
    samples,
    triangles,
    cull_back,
    emitters,
    specular_layer,
    clearcoat,
    sheen,
    transmission,
    volume,
    iridescence,
    anisotropy,
    diffuse_transmission,
    dispersion,
    layer_textures,  ///< bit i: LayerTexture i is read
    probes,
    element,  ///< of shaders/raster/features.glsl
    depth,    ///< DepthKind
    shadows,  ///< Shadows
    gathered_light,
    count
};

/// The textures of MaterialLayers, in the order of LayerRecord and of shaders/raster/layers.glsl.
enum class LayerTexture : unsigned {
    specular,
    specular_color,
    clearcoat,
    clearcoat_roughness,
    clearcoat_normal,
    sheen_color,
    sheen_roughness,
    transmission,
    thickness,
    iridescence,
    iridescence_thickness,
    anisotropy,
    diffuse_transmission,
    diffuse_transmission_color,
    count
};
inline constexpr std::size_t kLayerTextures = static_cast<std::size_t>(LayerTexture::count);
const TextureUse& layer_texture(const MaterialLayers& layers, LayerTexture texture);

enum class RasterShape { mesh, sphere, background };
/// Pictures, their AOVs, and depth as seen by lights that shine from a point or in one direction.
enum class RasterTarget { color, aovs, shadow, parallel_shadow };

/// Which code draws something: everything that tells one pipeline of the rasterizer from another.
struct RasterVariant {
    RasterShape shape = RasterShape::mesh;
    RasterTarget target = RasterTarget::color;
    Topology topology = Topology::triangles;
    std::array<std::uint32_t, static_cast<std::size_t>(RasterConstant::count)> constants{};

    std::uint32_t get(RasterConstant constant) const { return constants[static_cast<std::size_t>(constant)]; }
    bool reads(LayerTexture texture) const
    {
        return (get(RasterConstant::layer_textures) >> static_cast<unsigned>(texture) & 1) != 0;
    }
    void set(RasterConstant constant, std::uint32_t value) { constants[static_cast<std::size_t>(constant)] = value; }
    auto operator<=>(const RasterVariant&) const = default;
};

/// The variants of one picture, as its requirements allow: a feature whose bit is not set is left out, whatever the
/// scene says. Throws Error(input) where a material's model, or an orthographic camera, is not among the requirements.
class RasterVariants {
 public:
    RasterVariants(const PosedScene& posed, const Requirements& required, const RenderSettings& settings);

    RasterVariant of(const Draw& draw, RasterTarget target) const;
    RasterVariant of(const PosedSphere& sphere, RasterTarget target) const;
    /// The environment behind everything, or (false) RasterFrame::background.
    RasterVariant background(bool environment) const;

    /// Samples a pixel.
    std::uint32_t samples() const { return samples_; }
    /// How punctual lights cast shadows here: Shadows::none where there are no lights.
    Shadows shadows() const { return shadows_; }
    /// Light but that of punctual lights comes by rays (SH-44); not of Blinn and Phong.
    bool gathers_light() const { return gathered_light_; }
    /// True where faces are culled by their side: every single-sided material but the dielectrics (SH-32).
    bool culls_back(const Material& material) const;
    /// glTF's own models under their own shading: energy of rough reflection (SH-53), layers.
    bool has_layers(const Material& material) const;
    /// One of the exact models that reflects the environment by (SH-34).
    bool is_glossy(const Material& material) const;

 private:
    void set_frame(RasterVariant& variant) const;
    void set_material(RasterVariant& variant, const Material& material) const;
    void set_layers(RasterVariant& variant, const MaterialLayers& layers) const;
    void set_layer(RasterVariant& variant, RasterConstant constant, Feature feature, const MaterialLayers& layers,
                   std::initializer_list<LayerTexture> textures) const;
    bool uses(RasterVariant& variant, Feature feature, const TextureUse& use) const;
    void use_texture(RasterVariant& variant, RasterConstant constant, Feature feature, const TextureUse& use) const;

    const PosedScene& posed_;
    const Requirements& required_;
    bool blinn_phong_;
    Shadows shadows_;
    bool gathered_light_;
    std::uint32_t samples_;
    DepthKind depth_;
    std::uint32_t probes_;       // of an anisotropic look-up
    std::uint32_t environment_;  // kEnvironmentNone, … of features.glsl
};

}  // namespace etalon
