#pragma once
#include "engine/math/types.h"

namespace etalon::reference {

/// A frame about a unit vector, which is its +Z.
struct ShadingFrame {
    explicit ShadingFrame(const dvec3& normal);
    ShadingFrame(const dvec3& tangent, const dvec3& normal);  ///< unit, at right angles
    dvec3 local(const dvec3& w) const { return {dot(w, t), dot(w, b), dot(w, n)}; }
    dvec3 world(const dvec3& l) const { return l.x * t + l.y * b + l.z * n; }
    dvec3 t, b, n;
};

/// (SH-52) GGX with one alpha along x and one along y; the normal is +Z.
double ggx_d(const dvec3& h, const dvec2& alpha);
/// (SH-52) V of directions with z > 0.
double ggx_v(const dvec3& wo, const dvec3& wi, const dvec2& alpha);
/// Smith's G₁ of `w`, z > 0.
double ggx_g1(const dvec3& w, const dvec2& alpha);
/// (MC-6) A normal visible from `wo`.
dvec3 sample_visible_normal(const dvec3& wo, const dvec2& alpha, const dvec2& u);

/// (SH-61) Sheen's D of the unit half vector.
double sheen_d(const dvec3& h, double alpha);
/// (SH-61) Sheen's V of cosines above 0.
double sheen_v(double cos_o, double cos_i, double alpha);

}  // namespace etalon::reference
