#pragma once
#include <vector>

#include "engine/math/types.h"

namespace etalon::reference {

/// What transmitting surfaces show: the picture of what is opaque, premultiplied, with levels that are area averages
/// of the one above (TX-4), (SH-65).
class PictureBehind {
 public:
    /// `pixels`: row by row, without the background.
    PictureBehind(ivec2 size, std::vector<dvec4> pixels);
    /// At a film position in pixels: bilinear in each level, clamped at the border, linear between levels.
    dvec4 at(const dvec2& film, double level) const;

 private:
    struct Level {
        ivec2 size{0};
        std::vector<dvec4> texels;
        dvec4 bilinear(const dvec2& uv) const;
    };
    std::vector<Level> levels_;
};

}  // namespace etalon::reference
