#pragma once
#include <vector>

#include "engine/gpu/shader.h"
#include "engine/scene/requirements.h"
#include "shaders/shared/sobol.h"

namespace etalon {

/// What the path tracer's kernels are compiled for and what is uploaded: Requirements in its own terms.
struct PathFeatures {
    bool triangles = false, spheres = false;
    bool normals = false, uv = false, tangents = false, colors = false;  ///< sections of the attributes
    bool base_color_texture = false, metallic_roughness_texture = false, normal_texture = false,
         emissive_texture = false;
    bool texture_transform = false, wide_texels = false;
    bool alpha = false;
    bool metallic_roughness = false, unlit = false, lambert = false, mirror = false;
    bool rough_conductor = false, dielectric = false, rough_dielectric = false, specular_glossiness = false;
    bool specular = false, clearcoat = false, sheen = false, transmission = false, volume = false;
    bool iridescence = false, anisotropy = false, dispersion = false, diffuse_transmission = false;
    bool layer_textures = false;
    bool emission = false, punctual = false, sky = false, sky_map = false;
    bool thin_lens = false, orthographic = false, equirectangular = false;
    bool sobol = false, glass_shadows = false;  ///< of the settings
    bool chosen_pixels = false;                 ///< pictures are of lists of pixels

    bool textures() const
    {
        return base_color_texture || metallic_roughness_texture || normal_texture || emissive_texture || layer_textures;
    }
    /// Some material reads the tables of engine/render/albedo.h.
    bool albedo() const { return metallic_roughness || specular_glossiness; }
    /// Texels of a primitive in the attribute buffer.
    std::size_t attribute_stride() const { return 3u * (std::size_t(normals) + uv + tangents + colors); }
    /// Independent parts of a pixel's samples (MC-10).
    std::uint32_t replicates() const { return sobol ? shared::kSobolReplicates : 1; }
};

/// Throws Error(input) when `required` lacks the model of a material that something visible uses.
PathFeatures path_features(const PosedScene& posed, const Requirements& required, const RenderSettings& settings);

/// The same whether or not the models are among the requirements: what shaders would be, not what may be drawn.
PathFeatures path_features_unchecked(const PosedScene& posed, const Requirements& required,
                                     const RenderSettings& settings);

/// As specialization constants of shaders/path/features.glsl.
std::vector<gpu::Constant> path_constants(const PathFeatures& features);

}  // namespace etalon
