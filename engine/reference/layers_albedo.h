#pragma once
#include <vector>

#include "engine/math/types.h"

namespace etalon::reference {

/// (SH-53) E: the share of the light of a white furnace that one bounce off GGX's microfacets gives back towards
/// `cosine` (n·wo), F = 1, height-correlated Smith. By quadrature, within 3·10⁻⁴.
double ggx_share(double cosine, double alpha);
/// (SH-34) w̄: the mean of Schlick's weight (1 - wo·h)⁵ over the light of E. By quadrature, within 3·10⁻⁴.
double ggx_schlick_share(double cosine, double alpha);
/// (SH-61) E_s likewise, of sheen; above 1 at grazing angles of small roughness. By quadrature, within 10⁻³; as at
/// 10⁻⁴ for cosines below that.
double sheen_share(double cosine, double alpha);

/// A function of a cosine and an alpha that is worth a table.
struct Tabulated {
    double (*function)(double cosine, double alpha);
    double lowest_alpha;           ///< the table ends here and at 1
    double (*knee)(double alpha);  ///< the cosine below which the function is steep
};
extern const Tabulated kGgxShare, kSheenShare;

/// Such a function over cosines 0 … 1, interpolated by cubics: within 10⁻³ of the true one
/// (2·10⁻³ for cosines below 10⁻³). Empty: 1 everywhere.
class ShareTable {
 public:
    ShareTable() = default;
    /// For alphas in `used` (lowest, highest) only.
    ShareTable(const Tabulated& what, const dvec2& used);
    double operator()(double cosine, double alpha) const;

 private:
    static constexpr int kSide = 48;  // nodes of cosine, and of ln alpha from the lowest to 1
    double row_of(double alpha) const;
    double alpha_of(int row) const;
    double at(int row, double position) const;

    Tabulated what_{};
    int first_row_ = 0;  // rows are kept for the alphas used, and what their interpolation reads
    std::vector<double> values_;
};

}  // namespace etalon::reference
