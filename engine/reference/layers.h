#pragma once
#include <optional>

#include "engine/reference/bsdf.h"
#include "engine/reference/layers_fresnel.h"

namespace etalon::reference {

/// (SH-50) … (SH-64) How a point of a layered surface scatters. Directions are unit, in the frame whose +Z is the
/// shading normal on the viewer's side and whose +X is t' of (SH-52); `wo` has z > 0. Which sides of the normals wi
/// must lie on is decided here: callers need no test of their own.
struct LayeredBsdf {
    BaseReflectance reflectance;  ///< with b
    dvec2 alpha{1};               ///< α_t, α_b
    dvec3 ng{0, 0, 1};            ///< geometric normal on the viewer's side, in this frame

    double transmission = 0;          ///< t
    double diffuse_transmission = 0;  ///< g
    dvec3 diffuse_transmission_color{1};

    /// (SH-58), (SH-60)
    struct Body {
        dvec3 ior{1};         ///< per channel, the middle one is that of F; 0: infinite
        bool inside = false;  ///< wo lies in the body
    };
    std::optional<Body> body;  ///< none: thin-walled

    dvec3 sheen_color{0};
    double sheen_alpha = 1;
    double coat_weight = 0;  ///< K, seen from wo
    double coat_alpha = 1;
    dvec3 coat_normal{0, 0, 1};  ///< on the viewer's side, in this frame

    const ShareTable* ggx_share = nullptr;    ///< E; null: one bounce alone, M = 1
    const ShareTable* sheen_share = nullptr;  ///< E_s; must be there where sheen_color is not 0

    /// Index on the far side / index on wo's side, of a path that crosses; 1 unless a body.
    double relative_ior() const;
};

/// (SH-62) K: what the coat takes from all below it, seen at `cosine` = |n_c·wo|.
double coat_weight(double coat, double cosine);

/// f(wo, wi) |cosθ_wi| per channel. Without the light that goes straight through a body of index 1.
dvec3 evaluate(const LayeredBsdf& bsdf, const dvec3& wo, const dvec3& wi);

/// Density per steradian with which `sample` chooses wi, but straight through a body of index 1.
double pdf(const LayeredBsdf& bsdf, const dvec3& wo, const dvec3& wi);

/// Draws wi from three uniform numbers in [0, 1); nothing where the draw carries no light.
std::optional<BsdfSample> sample(const LayeredBsdf& bsdf, const dvec3& wo, const dvec3& u);

}  // namespace etalon::reference
