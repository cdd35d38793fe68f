#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/progress.h"
#include "engine/image/develop.h"
#include "engine/image/film.h"
#include "engine/scene/pose.h"
#include "engine/scene/settings.h"

namespace etalon {

/// Some pixels of a picture, drawn at random without replacement, and what light really reaches them. The picture is
/// cut into cells_x × cells_y rectangles; each has about as many of the pixels, so that the error can also be drawn as
/// a coarse map. Pixels of a cell follow one another; cells are in rows from the top.
struct PixelProbe {
    int width = 0, height = 0;  ///< of the picture
    int cells_x = 0, cells_y = 0;
    std::vector<std::uint32_t> pixels;  ///< y * width + x
    std::vector<std::size_t> ends;      ///< of each cell's pixels in the list
    Film truth;                         ///< one row: pixel k is that of pixels[k]; with variance
    RenderSettings settings;            ///< how it was traced
    bool cut = false;                   ///< time ended it before all asked samples

    /// Share of the picture that a cell is.
    double weight(std::size_t cell) const;
};

/// About `count` pixels of a picture; `truth` is empty yet. Deterministic. Error(input) when there is no pixel.
PixelProbe choose_pixels(int width, int height, std::size_t count, std::uint64_t seed);

/// How many pixels are traced, how well, and for how long at most.
struct ProbeSettings {
    std::size_t pixels = 2048;
    std::uint64_t samples = 128;  ///< a pixel: the probe's noise is taken off, more samples narrow the interval
    int depth = 64;               ///< segments of a path, so that what a depth limit costs is part of the error
    std::uint64_t seed = 0x70726f6265;
    double seconds = 5;
};

/// The settings with which single pixels are traced for a picture of `settings`: same scene, light and background.
RenderSettings probe_settings(const RenderSettings& settings, const ProbeSettings& how);

/// Chooses pixels of the posed picture and traces them with the reference (engine/reference/reference.h), which shares
/// no shading code with the device. Cut short by how.seconds or when `progress` says stop; with fewer than 2 samples
/// there is nothing to measure by.
PixelProbe trace_probe(const PosedScene& posed, const RenderSettings& settings, const ProbeSettings& how,
                       const Progress& progress);

/// A value with its 95% interval.
struct Estimate {
    double value = 0;
    double low = 0;
    double high = 0;
};

/// How far a picture is from the light that really reaches its pixels. Noise of the probe's own estimate is taken off:
/// a perfect picture has 0 within its interval, however noisy the probe. Root mean squares are over pixels and
/// channels; intervals hold for the whole picture, by the scatter over pixels within cells (stratified sampling, logs,
/// Student's t), which says nothing of a rare event that no probed pixel has met.
struct PictureError {
    Estimate rmse;                       ///< nit
    Estimate relative;                   ///< rmse / mean radiance of the truth
    Estimate relmse;                     ///< mean of (a - b)² / (b² + 0.01 mean(b)²), b the truth
    Estimate display;                    ///< root mean square difference of the developed pictures, in steps of 1/255
    Estimate brightness;                 ///< mean of (a - b) / mean of b; may be negative
    std::optional<Estimate> systematic;  ///< of a picture with variance: `relative` without its own noise, which is
                                         ///< what a limit on depth or the like costs
    double mean = 0;                     ///< of the truth, nit
    int cells_x = 0, cells_y = 0;
    std::vector<double> map;     ///< `relative` of each cell, in rows from the top; 0 where noise hides it
    std::size_t pixels = 0;      ///< that were probed
    std::uint64_t samples = 0;   ///< a pixel
    int depth = 0;               ///< segments of a path at most
    std::uint64_t left_out = 0;  ///< probed pixels that are not finite in the picture
    bool cut = false;            ///< time ended the probe before all its samples
};

/// Measures `film` at the pixels of `probe`. Throws Error(input) when their sizes differ or the probe has no truth.
PictureError measure_picture(const Film& film, const PixelProbe& probe, const DevelopSettings& develop);

/// "12.3% (95% interval 11.8% to 12.9%), 9.1 of 255 display steps".
std::string describe(const PictureError& error);
/// schema "etalon-picture-error/1".
std::string picture_error_json(const PictureError& error);
/// What a picture file says of it: "error.relative" → "0.123 0.118 0.129", "error.map" → "16x8 0.01 …".
std::vector<std::pair<std::string, std::string>> picture_error_texts(const PictureError& error);
/// The map in the colours of engine/image/metrics.h, one pixel a cell, logarithmic from 10⁻³ (black) to 1 (white).
Image picture_error_map(const PictureError& error);

}  // namespace etalon
