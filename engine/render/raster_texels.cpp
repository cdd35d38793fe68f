#include "engine/render/raster_texels.h"

#include <algorithm>
#include <cmath>

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

/// Every texel's vector 2 rgb - 1.
void make_unit(Image& image)
{
    for (std::size_t i = 0; i < image.pixel_count(); ++i) {
        float* rgb = image.values.data() + 4 * i;
        const dvec3 n = 2.0 * dvec3(vec3(rgb[0], rgb[1], rgb[2])) - 1.0;
        const double size = length(n);
        if (!(size > 0) || !std::isfinite(size)) continue;
        for (int c = 0; c < 3; ++c) rgb[c] = static_cast<float>(0.5 + 0.5 * n[c] / size);
    }
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
    if (coding == Coding::normal) make_unit(level0);
    if (!all_levels) {
        chain.levels.push_back(quantize(level0, threads));
        return chain;
    }
    for (const Image& level : mip_chain(std::move(level0), threads)) chain.levels.push_back(quantize(level, threads));
    return chain;
}

}  // namespace etalon
