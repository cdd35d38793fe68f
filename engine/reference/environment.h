#pragma once
#include <array>
#include <vector>

#include "engine/math/types.h"
#include "engine/scene/scene.h"

namespace etalon::reference {

/// (SH-40) Radiance from infinitely far in world direction `d` (unit), nit.
dvec3 environment_radiance(const Environment& environment, const dvec3& d);

/// (SH-40) Texture coordinates of a direction in the map's own frame (after the turn by -rotation), u in [0, 1).
dvec2 map_from_direction(const dvec3& d);
dvec3 direction_from_map(const dvec2& uv);

/// Draws directions of a map about in proportion to its radiance. A constant environment is not sampled: its rays are
/// found by the BSDF alone, without noise.
class EnvironmentSampler {
 public:
    explicit EnvironmentSampler(const Environment& environment);

    bool empty() const { return rows_.empty(); }
    struct Sample {
        dvec3 direction;  ///< world, unit
        double pdf;       ///< per steradian, > 0
    };
    Sample sample(const dvec2& u) const;
    double pdf(const dvec3& direction) const;  ///< per steradian; 0 where it never samples

 private:
    double pdf_of_texel(int row, int column, double sin_theta) const;

    double rotation_ = 0;
    int width_ = 0, height_ = 0;
    std::vector<double> rows_;     ///< running sum over rows, the last is 1
    std::vector<double> columns_;  ///< running sum within each row, the last of a row is 1 (or 0 in a black row)
};

/// (SH-41) The map at another size, linear radiance × scale in its own frame; a constant environment is 1×1.
struct RadianceMap {
    int width = 0, height = 0;
    std::vector<dvec3> texels;
    dvec3 bilinear(const dvec2& uv) const;  ///< u wraps, v clamps
};
RadianceMap area_average(const Environment& environment, int width, int height);

/// What rasterizers know of an environment. (SH-33), (SH-35)
class EnvironmentTables {
 public:
    EnvironmentTables(const Environment& environment, unsigned threads);
    dvec3 irradiance(const dvec3& n) const;                     ///< E(n)
    dvec3 prefiltered(const dvec3& r, double roughness) const;  ///< P(r, roughness)

 private:
    bool constant_ = false;
    dvec3 radiance_{0};
    double rotation_ = 0;
    std::array<RadianceMap, 6> tables_;  ///< roughness 0, 0.2 … 1
    RadianceMap cosine_;                 ///< E/π
};

/// (SH-34) The direction whose P a rough surface shows: between n and the mirror direction. Unit `n`, `wo`.
dvec3 dominant_reflection(const dvec3& wo, const dvec3& n, double roughness);

}  // namespace etalon::reference
