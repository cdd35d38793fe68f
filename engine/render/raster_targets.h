#pragma once
#include <array>

#include "engine/gpu/image.h"
#include "engine/image/film.h"
#include "engine/render/raster_pipelines.h"

namespace etalon {

/// What the rasterizer draws into.
struct RasterTargets {
    gpu::Image color;  ///< multisampled; empty where one sample is drawn
    gpu::Image resolved;
    gpu::Image depth;
    gpu::Image levels;  ///< of what is behind transmitting surfaces (levels.glsl); empty unless something transmits
    std::array<gpu::Image, kRasterAovTargets> aovs;  ///< empty unless asked for
    gpu::Image aov_depth;

    bool has_aovs() const { return static_cast<bool>(aov_depth); }
    bool is_multisampled() const { return static_cast<bool>(color); }
};

/// `samples`: 1 or 4. `levels`: for transmitting surfaces.
RasterTargets make_targets(gpu::Device& device, ivec2 size, std::uint32_t samples, bool aovs, bool levels);

/// Texels of RasterTargets::levels for a picture of this size.
uvec2 size_of_levels(ivec2 picture);

/// The resolved picture and the AOVs, once they are drawn; values that are not finite are kept and counted.
/// Film::samples and metadata are the caller's.
Film read_targets(gpu::Device& device, RasterTargets& targets);

/// A picture of three or four channels as RGBA float32 on the device; one black texel for an empty one.
gpu::Image upload_picture(gpu::Device& device, const Image& picture, const char* name);

}  // namespace etalon
