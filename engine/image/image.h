#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "engine/math/types.h"

namespace etalon {

/// A picture of `channels` interleaved float32 values a pixel, row 0 at the top.
struct Image {
    int width = 0;
    int height = 0;
    int channels = 0;
    std::vector<float> values;  ///< width * height * channels

    Image() = default;
    Image(int w, int h, int c)
        : width(w), height(h), channels(c), values(std::size_t(w) * std::size_t(h) * std::size_t(c))
    {}
    std::size_t pixel_count() const { return std::size_t(width) * std::size_t(height); }
    float& at(int x, int y, int c)
    {
        return values[(std::size_t(y) * std::size_t(width) + std::size_t(x)) * std::size_t(channels) + std::size_t(c)];
    }
    float at(int x, int y, int c) const { return const_cast<Image&>(*this).at(x, y, c); }
};

/// 8-bit or 16-bit or float texels as a file holds them, not yet decoded to linear light; row 0 at the top.
/// Textures keep 8 bits where the file has 8: their decoding belongs to the renderer that filters them.
struct Texels {
    int width = 0;
    int height = 0;
    bool is_8_bit = true;             ///< else values are in `wide`
    std::vector<std::uint8_t> bytes;  ///< RGBA, 4 a texel, when is_8_bit
    std::vector<float> wide;          ///< RGBA, 4 a texel, as coded (16-bit codes / 65535) otherwise
};

}  // namespace etalon
