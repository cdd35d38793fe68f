#pragma once
#include <cstdint>
#include <vector>

#include "engine/image/image.h"

namespace etalon {

/// One level of an 8-bit texture: RGBA, row 0 at the top.
struct Level8 {
    int width = 0;
    int height = 0;
    std::vector<std::uint8_t> bytes;  ///< 4 a texel
};

/// How many levels a full chain has: 1 + floor(log2(max(width, height))). Level i is max(1, size >> i) a side, as in
/// Vulkan.
int mip_levels(int width, int height);

/// `image` at a smaller (or equal) size: each value is the exact area average of the texels that it covers, partly
/// covered ones by their share (SH-41, TX-4). The mean of the picture is kept to rounding, whatever the sizes (T8).
Image shrink(const Image& image, int width, int height, unsigned threads = 0);

/// Level 0 and all smaller ones, each the exact average of the one above. For odd sizes these are the polyphase weights
/// of NVIDIA 2005: no column is dropped (T8).
std::vector<Image> mip_chain(Image level0, unsigned threads = 0);

/// The same for 8-bit texels: level 0 keeps its codes; the others are averaged as floats, in linear light where `srgb`
/// says that colour is sRGB-coded (alpha never is), and coded again with rounding to nearest (T9, T11).
std::vector<Level8> mip_chain_8(const Texels& texels, bool srgb, unsigned threads = 0);

/// RGBA values in linear light of texels of either kind; `srgb`: colour, not alpha, is sRGB-coded.
Image linear_image(const Texels& texels, bool srgb);

}  // namespace etalon
