#pragma once
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/math/types.h"

namespace etalon {

/// What the primary ray through a pixel's centre meets. Where it meets nothing: depth +Inf, ids 0, the rest 0.
struct Aovs {
    std::vector<float> depth;                ///< metres along the viewing axis (camera -Z), > 0
    std::vector<vec3> normal;                ///< world space shading normal turned towards the viewer, unit
    std::vector<vec3> albedo;                ///< linear base colour
    std::vector<vec3> emission;              ///< radiance that the surface emits, nit
    std::vector<std::uint32_t> object_id;    ///< PosedScene draw or sphere index + 1: draws first, then spheres
    std::vector<std::uint32_t> material_id;  ///< Scene material index + 1
    std::vector<vec2> uv;                    ///< TEXCOORD_0

    bool empty() const { return depth.empty(); }
};

/// What a renderer measures: linear radiance per pixel with how uncertain it is. Row 0 is the top.
struct Film {
    int width = 0;
    int height = 0;
    std::vector<vec3> mean;      ///< nit, linear Rec.709; where alpha < 1, premultiplied (the environment not included
                                 ///< when the background is transparent)
    std::vector<vec3> variance;  ///< variance of the mean per channel, nit^2; empty: error not measured
    std::vector<float> alpha;    ///< coverage by the scene, 0 … 1
    std::uint64_t samples = 0;   ///< per pixel; their mean, rounded, where `counts` says that pixels differ
    std::vector<std::uint32_t> counts;  ///< samples of each pixel; empty: all have the same
    /// Independent parts of a pixel's samples, whose means' scatter is its variance (MC-10); 0: the samples themselves.
    std::uint32_t replicates = 0;
    std::uint64_t nonfinite = 0;                  ///< samples that were NaN or Inf: counted and left out of the mean
    std::uint64_t truncated = 0;                  ///< paths ended by the depth limit while they still carried light
    Aovs aovs;                                    ///< empty unless asked for
    std::map<std::string, std::string> metadata;  ///< scene, settings, seed, version, device …; written into files

    std::size_t pixel_count() const { return std::size_t(width) * std::size_t(height); }
    /// Of a pixel's variance.
    double degrees_of_freedom(std::size_t pixel) const
    {
        if (replicates > 0) return double(replicates) - 1;
        return double(counts.empty() ? samples : counts[pixel]) - 1;
    }
};

/// Relative standard error of the whole picture: sqrt(mean of variance) / mean of radiance over all pixels and
/// channels, with a 95% interval from the scatter of the variance over 16x16 tiles (smaller ones where that gives fewer
/// than 30), by Student's t on the logarithm. A lone pixel has the interval 0 … Inf. Values that are not finite are
/// left out. Nothing where error was not measured, and for a picture with variance but without radiance.
struct ErrorEstimate {
    double relative = 0;
    double low = 0;
    double high = 0;
};
std::optional<ErrorEstimate> estimate_error(const Film& film);

/// Samples of one pixel, added up.
struct PixelSums {
    dvec3 mean{0};
    dvec3 m2{0};  ///< of squared deviations from it
    double alpha = 0;
    std::uint64_t count = 0;
};

/// Adds up samples of a film in blocks, in double: blocks of mean and M2 (sum of squared deviations) as a device or a
/// thread makes them are merged by Chan et al. 1979 in the order given. Promises M1-M3, docs/numerics.md.
class FilmSum {
 public:
    FilmSum(int width, int height);
    /// One block of `count` samples in every pixel: their mean and M2, 3 channels interleaved, and mean alpha.
    void add_block(std::span<const float> mean, std::span<const float> m2, std::span<const float> alpha,
                   std::uint64_t count);
    std::uint64_t samples() const { return samples_; }
    /// All that it holds, to the last bit: means, M2, alphas, 7 numbers a pixel in all.
    std::vector<double> state() const;
    /// Goes on from what another one's state() was after so many samples. Error(input) when it is of another size.
    void restore(std::span<const double> state, std::uint64_t samples);
    /// Mean, variance of the mean (empty under 2 samples), alpha and count.
    Film film() const;
    int width() const { return width_; }
    int height() const { return height_; }
    PixelSums pixel(std::size_t i) const;

 private:
    int width_;
    int height_;
    std::uint64_t samples_ = 0;
    std::vector<double> mean_;
    std::vector<double> m2_;
    std::vector<double> alpha_;
};

/// What is suspicious in a film at a glance.
struct FilmCheck {
    std::uint64_t nan_pixels = 0;
    std::uint64_t inf_pixels = 0;
    bool single_colour = false;  ///< every pixel has the same value
};
FilmCheck check(const Film& film);

}  // namespace etalon
