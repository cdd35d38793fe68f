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
    count
};

enum class RasterShape { mesh, sphere, background };
enum class RasterTarget { color, aovs };

/// Which code draws something: everything that tells one pipeline of the rasterizer from another.
struct RasterVariant {
    RasterShape shape = RasterShape::mesh;
    RasterTarget target = RasterTarget::color;
    Topology topology = Topology::triangles;
    std::array<std::uint32_t, static_cast<std::size_t>(RasterConstant::count)> constants{};

    std::uint32_t get(RasterConstant constant) const { return constants[static_cast<std::size_t>(constant)]; }
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
    RasterVariant background() const;

    /// Samples a pixel: 1 or 4.
    std::uint32_t samples() const { return samples_; }
    /// True where faces are culled by their side: every single-sided material but the dielectrics (SH-32).
    bool culls_back(const Material& material) const;

 private:
    void set_frame(RasterVariant& variant) const;
    void set_material(RasterVariant& variant, const Material& material) const;
    void use_texture(RasterVariant& variant, RasterConstant constant, Feature feature, const TextureUse& use) const;

    const PosedScene& posed_;
    const Requirements& required_;
    bool blinn_phong_;
    std::uint32_t samples_;
    std::uint32_t environment_;  // kEnvironmentNone, … of features.glsl
};

}  // namespace etalon
