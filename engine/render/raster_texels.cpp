#include "engine/render/raster_texels.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/base/error.h"
#include "engine/base/parallel.h"
#include "engine/image/develop.h"
#include "engine/render/resample.h"

namespace etalon {
namespace {

/// RGBA in linear light.
struct Plane {
    int width = 0;
    int height = 0;
    std::vector<float> values;
};

std::uint16_t quantized(double value)
{
    // The comparison is false for NaN, which becomes 0.
    return value > 0 ? static_cast<std::uint16_t>(std::min(value, 1.0) * 65535 + 0.5) : std::uint16_t{0};
}

double decoded(double code, Coding coding)
{
    return coding == Coding::srgb ? linear_from_srgb(code) : code;
}

Plane decode(const Texels& texels, Coding coding, unsigned threads)
{
    Plane plane{texels.width, texels.height, {}};
    const std::size_t row = static_cast<std::size_t>(texels.width) * 4;
    plane.values.resize(row * static_cast<std::size_t>(texels.height));
    std::array<float, 256> color{}, linear{};
    for (std::size_t code = 0; code < 256; ++code) {
        linear[code] = static_cast<float>(static_cast<double>(code) / 255);
        color[code] = static_cast<float>(decoded(static_cast<double>(code) / 255, coding));
    }
    parallel_for(
        static_cast<std::size_t>(texels.height),
        [&](std::size_t y) {
            for (std::size_t i = y * row; i < (y + 1) * row; ++i) {
                const bool is_alpha = i % 4 == 3;
                if (texels.is_8_bit)
                    plane.values[i] = (is_alpha ? linear : color)[texels.bytes[i]];
                else
                    plane.values[i] = static_cast<float>(is_alpha ? texels.wide[i] : decoded(texels.wide[i], coding));
            }
        },
        threads);
    return plane;
}

/// The next level: half the size, rounded down, at least 1.
Plane halved(const Plane& above, unsigned threads)
{
    Plane plane{std::max(1, above.width / 2), std::max(1, above.height / 2), {}};
    plane.values.resize(static_cast<std::size_t>(plane.width) * static_cast<std::size_t>(plane.height) * 4);
    const std::vector<Coverage> columns = coverages(above.width, plane.width);
    const std::vector<Coverage> rows = coverages(above.height, plane.height);
    const std::size_t above_row = static_cast<std::size_t>(above.width) * 4;
    parallel_for(
        static_cast<std::size_t>(plane.height),
        [&](std::size_t y) {
            float* out = plane.values.data() + y * static_cast<std::size_t>(plane.width) * 4;
            for (const Coverage& column : columns) {
                std::array<double, 4> sum{};
                for (std::size_t j = 0; j < rows[y].weights.size(); ++j) {
                    const float* in = above.values.data() + (static_cast<std::size_t>(rows[y].first) + j) * above_row +
                                      static_cast<std::size_t>(column.first) * 4;
                    for (const double weight : column.weights)
                        for (double& channel : sum) channel += rows[y].weights[j] * weight * static_cast<double>(*in++);
                }
                for (const double channel : sum) *out++ = static_cast<float>(channel);
            }
        },
        threads);
    return plane;
}

MipChain::Level quantize(const Plane& plane, unsigned threads)
{
    MipChain::Level level{plane.width, plane.height, std::vector<std::uint16_t>(plane.values.size())};
    const std::size_t row = static_cast<std::size_t>(plane.width) * 4;
    parallel_for(
        static_cast<std::size_t>(plane.height),
        [&](std::size_t y) {
            for (std::size_t i = y * row; i < (y + 1) * row; ++i)
                level.values[i] = quantized(static_cast<double>(plane.values[i]));
        },
        threads);
    return level;
}

}  // namespace

MipChain decode_mips(const Texels& texels, Coding coding, bool all_levels, unsigned threads)
{
    assume(texels.width > 0 && texels.height > 0);
    MipChain chain;
    Plane plane = decode(texels, coding, threads);
    chain.levels.push_back(quantize(plane, threads));
    while (all_levels && (plane.width > 1 || plane.height > 1)) {
        plane = halved(plane, threads);
        chain.levels.push_back(quantize(plane, threads));
    }
    return chain;
}

}  // namespace etalon
