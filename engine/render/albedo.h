#pragma once
#include <vector>

#include "engine/math/types.h"

namespace etalon {

/// E of (SH-53): what of a white furnace's light a GGX surface of F = 1 reflects towards a viewer at `cosine` (0 … 1,
/// above 0) without scattering between its facets. `alpha` 0.001 … 1. By quadrature over the visible normals; error
/// under 3·10⁻⁴.
double ggx_albedo(double cosine, double alpha);

/// w̄ of (SH-34): the mean of Schlick's weight (1 - wo·h)⁵ over what a GGX surface reflects towards `cosine`, so that of
/// F = F0 + (F90 - F0) (1 - wo·h)⁵ it reflects E (F0 + (F90 - F0) w̄). Error under 3·10⁻⁴.
double schlick_share(double cosine, double alpha);

/// E_s of (SH-61): of a white sheen layer; may exceed 1 at grazing angles, as the model does. `roughness` is √α_s,
/// 0.07 … 1. By quadrature; error under 5·10⁻⁴ where cosine ≥ 10⁻⁴.
double sheen_albedo(double cosine, double roughness);

/// Cells of shaders/shared/albedo.h; with interpolation exact to 10⁻³ (of the value, where that is above 1). The second
/// table only where asked for: without it those cells are missing.
std::vector<vec4> make_albedo_cells(bool with_sheen, unsigned threads);

/// The same with the cells of w̄, which rasterizers read; those of sheen are 0 where they were not asked for.
std::vector<vec4> make_raster_albedo_cells(bool with_sheen, unsigned threads);

}  // namespace etalon
