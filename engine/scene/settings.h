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
    int msaa = 4;          ///< samples per pixel of the rasterizer: 1 or 4
    bool mipmaps = true;   ///< rasterizer: false reads level 0 alone
    bool aovs = false;     ///< also fill Film::aovs
    unsigned threads = 0;  ///< CPU threads; 0: one per core. Never changes a bit of the picture.
};

}  // namespace etalon
