#pragma once
#include <cstdint>
#include <string_view>

#include "engine/math/types.h"

namespace etalon {

enum class Renderer { raster, path, reference_raster, reference };
/// "path", as --renderer takes it, and "Vulkan path tracer", as people say it.
std::string_view name(Renderer renderer);
std::string_view label(Renderer renderer);

enum class Shading { automatic, blinn_phong, pbr };  ///< automatic: pbr

/// Where a camera ray meets nothing.
enum class Background { environment, transparent, colour };

/// How the samples of a supersampled picture are weighed into pixels (AA-2).
enum class PixelFilter { box, tent, gaussian, blackman_harris };

/// How textures are filtered: as the file's samplers say, or all alike.
enum class TextureFilter { file, nearest, bilinear, trilinear };

/// What the rasterizers compare: reversed with an infinite far plane, or forward from near to the scene's far end.
enum class DepthKind { reversed_32, forward_32, forward_24, forward_16 };

/// Of punctual lights, in rasterizers: none, by shadow maps, or by rays.
enum class Shadows { none, map, ray };

/// How next-event estimation chooses among emitters: by what each could send to the point, or by power alone.
enum class LightSelection { tree, power };

/// Where the random numbers of paths come from (docs/equations.md, MC-8).
enum class Sequence { pcg, sobol };
/// "sobol", as --sampler takes it.
std::string_view name(Sequence sequence);

/// One of several parts of a picture that are rendered apart: `number` of `count`, from 1. Part i has the rows from
/// height (i - 1) / count to height i / count, rounded down.
struct Shard {
    unsigned number = 1;
    unsigned count = 1;

    bool whole() const { return count == 1; }
    int first_row(int height) const { return static_cast<int>(std::int64_t{height} * (number - 1) / count); }
    int end_row(int height) const { return static_cast<int>(std::int64_t{height} * number / count); }
};

/// Everything that decides a picture besides the scene and its pose. Every field that trades speed for accuracy has a
/// row in the knob table (engine/scene/knobs.h).
struct RenderSettings {
    Renderer renderer = Renderer::raster;
    Shading shading = Shading::automatic;
    Background background = Background::environment;
    dvec3 background_color{0};  ///< linear, nit, for Background::colour
    std::uint64_t spp = 64;     ///< samples per pixel (path and reference)
    std::uint64_t seed = 0;
    int max_depth = 8;  ///< most segments of a path from camera to light (1: emission alone)
    bool russian_roulette = true;
    LightSelection light_selection = LightSelection::tree;
    Sequence sampler = Sequence::sobol;
    bool glass_shadows = false;  ///< shadow rays go straight through surfaces that transmit (SH-70)
    Shard shard;                 ///< path tracers: the rows that the film has
    int msaa = 4;                ///< coverage samples per drawn pixel of the rasterizers: 1, 2, 4, 8 or 16
    int ssaa = 1;                ///< rasterizers: drawn pixels along each side of a pixel
    PixelFilter pixel_filter = PixelFilter::box;  ///< rasterizers: over drawn pixels
    bool mipmaps = true;                          ///< rasterizer: false reads level 0 alone
    TextureFilter texture_filter = TextureFilter::file;
    int anisotropy = 1;  ///< rasterizers: most probes along the longer side of a texture's footprint, 1 to 16
    DepthKind depth = DepthKind::reversed_32;
    int point_size = 1;  ///< rasterizers: of points, pixels
    int line_width = 1;  ///< rasterizers: of lines, pixels
    Shadows shadows = Shadows::none;
    int ambient_rays = 0;  ///< rasterizer: paths a drawn pixel that find what the scene itself does to light (SH-44)
    bool aovs = false;     ///< also fill Film::aovs
    unsigned threads = 0;  ///< CPU threads; 0: one per core. Never changes a bit of the picture.
};

}  // namespace etalon
