#include "engine/render/raster_texels.h"

#include <algorithm>

#include "engine/base/error.h"
#include "engine/base/parallel.h"
#include "engine/image/mips.h"

namespace etalon {
namespace {

std::uint16_t quantized(float value)
{
    // The comparison is false for NaN, which becomes 0.
    return value > 0 ? static_cast<std::uint16_t>(std::min(double{value}, 1.0) * 65535 + 0.5) : std::uint16_t{0};
}

MipChain::Level quantize(const Image& image, unsigned threads)
{
    MipChain::Level level{image.width, image.height, std::vector<std::uint16_t>(image.values.size())};
    const std::size_t row = static_cast<std::size_t>(image.width) * 4;
    parallel_for(
        static_cast<std::size_t>(image.height),
        [&](std::size_t y) {
            for (std::size_t i = y * row; i < (y + 1) * row; ++i) level.values[i] = quantized(image.values[i]);
        },
        threads);
    return level;
}

}  // namespace

MipChain decode_mips(const Texels& texels, Coding coding, bool all_levels, unsigned threads)
{
    assume(texels.width > 0 && texels.height > 0);
    MipChain chain;
    Image level0 = linear_image(texels, coding == Coding::srgb);
    if (!all_levels) {
        chain.levels.push_back(quantize(level0, threads));
        return chain;
    }
    for (const Image& level : mip_chain(std::move(level0), threads)) chain.levels.push_back(quantize(level, threads));
    return chain;
}

}  // namespace etalon
