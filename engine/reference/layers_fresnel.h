#pragma once
#include "engine/math/types.h"

namespace etalon::reference {

/// (SH-51) A film on the surface.
struct ThinFilm {
    double strength = 0;  ///< 0 … 1
    double ior = 1.3;
    double thickness = 0;  ///< nanometres
};

/// (SH-51) I: reflectance of a film of index `ior`, `thickness` nm, over a base that reflects `f0` head on, per
/// channel, 0 … 1; `cosine` in air.
dvec3 thin_film(double cosine, const dvec3& f0, double ior, double thickness);

/// (SH-50), (SH-51) How much of the light that meets a microfacet is reflected.
struct BaseReflectance {
    dvec3 color{1};  ///< b: what a metal reflects head on
    double metallic = 0;
    dvec3 f0{0.04};  ///< F0_d
    double f90 = 1;  ///< F90_d
    ThinFilm film;

    struct Value {
        dvec3 f{0};    ///< F
        dvec3 hat{0};  ///< F̂: what is lost to what lies below, 0 … 1
    };
    Value at(double cosine) const;
    /// F90: beyond the critical angle inside a body. (SH-58)
    Value total() const;
};

/// (SH-50) F0_d of an index of refraction (0: infinite) under KHR_materials_specular's factor and colour.
dvec3 dielectric_f0(double ior, double specular, const dvec3& specular_color);

}  // namespace etalon::reference
