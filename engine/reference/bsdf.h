#pragma once
#include <optional>

#include "engine/math/types.h"
#include "engine/reference/layers_albedo.h"
#include "engine/scene/scene.h"

namespace etalon::reference {

inline constexpr double kSmallestMicrofacetAlpha = 1e-3;  ///< of glTF's models (SH-14)

/// How a point of a surface scatters. Directions are unit, in the frame whose +Z is the shading normal on the viewer's
/// side; `wo` (to the viewer) has z > 0. docs/shading.md §2.
struct Bsdf {
    BsdfModel model = BsdfModel::lambert;
    dvec3 color{0};                      ///< c_diff; ρ of lambert; reflectance of mirror
    dvec3 f0{0};                         ///< metallic_roughness
    double alpha = 1;                    ///< GGX
    dvec3 eta{1};                        ///< rough_conductor, per channel
    dvec3 k{0};                          ///< rough_conductor, per channel
    double ior = 1;                      ///< dielectrics: index on the far side / index on wo's side
    const ShareTable* energy = nullptr;  ///< metallic_roughness: E of (SH-53); null: one bounce alone, M = 1

    /// Reflects or transmits into single directions: `evaluate` and `pdf` are 0, samples alone carry light.
    bool is_delta() const;
    /// Absorbs everything.
    bool is_black() const;
};

/// f(wo, wi) |cosθ_wi| per channel: light that arrives from wi, as seen from wo. 0 for delta lobes.
dvec3 evaluate(const Bsdf& bsdf, const dvec3& wo, const dvec3& wi);

/// Density per steradian with which `sample` chooses wi. 0 for delta lobes.
double pdf(const Bsdf& bsdf, const dvec3& wo, const dvec3& wi);

struct BsdfSample {
    dvec3 wi{0};
    dvec3 weight{0};  ///< f |cosθ| / pdf, finite where pdf itself is huge (promise S16)
    double pdf = 0;   ///< per steradian; of no meaning for delta
    bool delta = false;
};

/// Draws wi from three uniform numbers in [0, 1); nothing where the draw carries no light.
std::optional<BsdfSample> sample(const Bsdf& bsdf, const dvec3& wo, const dvec3& u);

/// (SH-11) GGX's D of the half vector `h` (z > 0 side), sr⁻¹.
double ggx_d(const dvec3& h, double alpha);
/// Smith's G₁ of GGX at cosθ = `cosine` > 0.
double ggx_g1(double cosine, double alpha);
/// (SH-12) V: the height-correlated masking over 4 n·wi n·wo.
double ggx_v(double cos_o, double cos_i, double alpha);
/// (MC-6) A normal visible from `wo`, by Heitz 2018.
dvec3 sample_visible_normal(const dvec3& wo, double alpha, const dvec2& u);
/// (MC-5) cosine-weighted direction, z > 0.
dvec3 sample_cosine(const dvec2& u);

/// (SH-53) M: what `share` = E leaves out of a reflectance of `head_on` is given back.
dvec3 energy_compensation(const dvec3& head_on, double share);

/// (SH-13)
dvec3 fresnel_schlick(const dvec3& f0, double cosine);
/// Unpolarized reflectance of a dielectric, `ior` = index beyond / index on this side; 1 beyond the critical angle.
double fresnel_dielectric(double cosine, double ior);
/// Unpolarized reflectance of η + ik against 1.
double fresnel_conductor(double cosine, double eta, double k);
/// `wo` refracted at normal `h` (wo·h > 0); nothing beyond the critical angle, exactly where fresnel_dielectric is 1
/// for it (S11).
std::optional<dvec3> refract(const dvec3& wo, const dvec3& h, double ior);

}  // namespace etalon::reference
