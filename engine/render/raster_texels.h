#pragma once
#include <cstdint>
#include <vector>

#include "engine/image/image.h"

namespace etalon {

/// How the colour channels of a texture are coded; alpha is linear always. normal: a unit vector, which is made one
/// before it is filtered (TX-7).
enum class Coding { linear, srgb, normal };

/// A texture in linear light, RGBA, 16 bits a channel (value × 65535, rounded), from level 0 down to 1×1.
struct MipChain {
    struct Level {
        int width = 0;
        int height = 0;
        std::vector<std::uint16_t> values;  ///< 4 a texel
    };
    std::vector<Level> levels;
};

/// Decodes a texture for a device, with all its mip levels or with level 0 alone (TX-4), (TX-5), T10. 16 bits of linear
/// light, because devices need not decode sRGB exactly (lavapipe's fit is off by up to 0.4% of mid grey) and filter
/// 8-bit texels with 8-bit sums; what is left is at most 2⁻¹⁷ of full scale, once per level. Values are clamped to [0,
/// 1].
MipChain decode_mips(const Texels& texels, Coding coding, bool all_levels, unsigned threads = 0);

}  // namespace etalon
