#pragma once
#include <vector>

#include "engine/scene/scene.h"

namespace etalon {

/// An environment map as the path tracer reads it: its texels, and the table by which directions are drawn.
struct PathSky {
    int width = 0, height = 0;     ///< texels of the map
    std::vector<uvec4> texels;     ///< RGB as float bits
    int cells_x = 0, cells_y = 0;  ///< cells of the table; 0: the map is black
    std::vector<uvec4> cells;      ///< kBindSkyCells of shaders/shared/path.h
};

/// Each cell is drawn in proportion to the light that comes from it: the exact mean of the bilinear map over the cell,
/// clamped at 0, times the sine of its polar angle. Sums in double (S23). Cells are texels, up to 1024 × 512 of them.
PathSky make_path_sky(const Image& map);

}  // namespace etalon
