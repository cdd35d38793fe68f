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
    gpu::Image filtered_rows;  ///< half done: as wide as the picture, as high as what is drawn; empty unless filtered
    gpu::Image filtered;

    bool has_aovs() const { return static_cast<bool>(aov_depth); }
    bool is_multisampled() const { return static_cast<bool>(color); }
    /// What all this is for: one value a pixel.
    gpu::Image& picture() { return filtered ? filtered : resolved; }
};

struct RasterTargetSpec {
    ivec2 size{0};              ///< of the picture, pixels
    int per_side = 1;           ///< drawn pixels along a side of a pixel
    bool filtered = false;      ///< the picture is made of what is drawn by RasterFilter
    std::uint32_t samples = 1;  ///< of a drawn pixel
    VkFormat depth = kRasterDepth;
    bool aovs = false;
    bool levels = false;  ///< for transmitting surfaces
};
/// Throws Error(machine) where the device has no images so large.
RasterTargets make_targets(gpu::Device& device, const RasterTargetSpec& spec);

/// Texels of RasterTargets::levels for a picture of this size.
uvec2 size_of_levels(ivec2 picture);

/// The picture and the AOVs, once they are drawn; values that are not finite are kept and counted.
/// Film::samples and metadata are the caller's.
Film read_targets(gpu::Device& device, RasterTargets& targets);

/// A picture of three or four channels as RGBA float32 on the device; one black texel for an empty one.
gpu::Image upload_picture(gpu::Device& device, const Image& picture, const char* name);

}  // namespace etalon
