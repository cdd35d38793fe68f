#pragma once
#include <vector>

#include "engine/image/image.h"

namespace etalon {

/// How many levels a full chain has: 1 + floor(log2(max(width, height))). Level i is max(1, size >> i) a side, as in
/// Vulkan.
int mip_levels(int width, int height);

/// `image` at a smaller (or equal) size: each value is the exact area average of the texels that it covers, partly
/// covered ones by their share (SH-41, TX-4). The mean of the picture is kept to rounding, whatever the sizes (T8).
Image shrink(const Image& image, int width, int height, unsigned threads = 0);

/// Level 0 and all smaller ones, each the exact average of the one above. For odd sizes these are the polyphase weights
/// of NVIDIA 2005: no column is dropped (T8).
std::vector<Image> mip_chain(Image level0, unsigned threads = 0);

/// RGBA values in linear light of texels of either kind; `srgb`: colour, not alpha, is sRGB-coded.
Image linear_image(const Texels& texels, bool srgb);

}  // namespace etalon
