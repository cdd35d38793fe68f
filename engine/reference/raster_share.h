#pragma once
#include <vector>

#include "engine/math/types.h"

namespace etalon::reference {

/// E, w̄ and E_s (SH-53, SH-34, SH-61) as both rasterizers read them: bilinear between the nodes that (SH-65) names, so
/// that two rasterizers differ by the error of their nodes alone.
class RasterShares {
 public:
    /// `ggx`, `sheen`: which of the two will be asked for.
    RasterShares(bool ggx, bool sheen, unsigned threads);
    double ggx(double cosine, double alpha) const;
    double schlick(double cosine, double roughness) const;  ///< w̄ (SH-34)
    dvec2 specular(double cosine, double roughness) const;  ///< [A, B] of (SH-34)
    double sheen(double cosine, double roughness) const;    ///< roughness is √α_s, 0.07 … 1

 private:
    struct Grid {
        int columns = 0, rows = 0;  ///< of nodes
        std::vector<double> nodes;
        double at(double x, double y) const;  ///< 0 … 1 each
    };
    Grid ggx_, schlick_, sheen_;
};

}  // namespace etalon::reference
