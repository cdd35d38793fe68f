#pragma once
#include "engine/reference/layers.h"
#include "engine/reference/layers_lobes.h"
#include "engine/reference/surface.h"

namespace etalon::reference {

/// The numbers of a material's layers at one point: factors times textures. docs/shading.md §2b names the channels.
struct LayerPoint {
    double specular = 1;
    dvec3 specular_color{1};
    double clearcoat = 0;
    double clearcoat_roughness = 0;
    dvec3 sheen_color{0};
    double sheen_roughness = 0;
    double transmission = 0;
    double thickness = 0;  ///< metres in mesh space
    double iridescence = 0;
    double iridescence_thickness = 0;  ///< nanometres
    double anisotropy = 0;
    dvec2 anisotropy_direction{1, 0};  ///< unit, in the tangent frame: the rotation included
    double diffuse_transmission = 0;
    dvec3 diffuse_transmission_color{1};
};
LayerPoint evaluate(const MaterialLayers& layers, const TextureSet& textures, const Attributes& attributes);

/// (SH-50), (SH-51) of metallic_roughness and specular_glossiness; a default `at` where there are no layers.
BaseReflectance base_reflectance(const Material& material, const MaterialPoint& point, const LayerPoint& at);

/// (SH-52) α_t, α_b.
dvec2 anisotropic_alpha(double roughness, double anisotropy);

/// (SH-52) t', unit and at right angles to `n` (the shading normal before SH-3 turns it).
dvec3 anisotropy_tangent(const Attributes& attributes, const dvec2& direction, const dvec3& n);

/// (SH-61) α_s.
double sheen_alpha(double roughness);

/// (SH-62) n_c before SH-3 turns it; `ng` where there is nothing better.
dvec3 coat_normal(const MaterialLayers& layers, const TextureSet& textures, const Attributes& attributes,
                  const dvec3& ng);

/// (SH-62) A coat as it is seen from `wo`.
struct Coat {
    double weight = 0;  ///< K
    double alpha = 1;
    dvec3 normal{0};  ///< n_c on wo's side
};
/// `material` must have layers; `ng` as the file means it.
Coat coat_at(const Material& material, const TextureSet& textures, const Attributes& attributes, const dvec3& ng,
             const dvec3& wo);

/// Gives `surface` (a hit of a layered material, complete but for its scattering) its frame, layers and coated
/// emission.
void set_layered_bsdf(Surface& surface, const World& world, const Material& material, const dvec3& wo);

/// (SH-60) Index of refraction for each channel, none below 1 but 0: infinite.
dvec3 dispersed_ior(const MaterialLayers& layers);

/// (SH-59) What is left per channel of light that went `distance` metres through a body; infinity is fine.
dvec3 absorption(const MaterialLayers& layers, double distance);

}  // namespace etalon::reference
