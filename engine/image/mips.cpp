#include "engine/image/mips.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "engine/base/error.h"
#include "engine/base/parallel.h"
#include "engine/image/develop.h"

namespace etalon {
namespace {

/// The source texels that one target texel covers along one axis, with their shares of it (which sum to 1).
struct Taps {
    int first = 0;
    std::vector<double> weights;
};

/// In units of 1/target of a texel the bounds are whole numbers: source j covers [j·target, (j+1)·target), target i
/// covers [i·source, (i+1)·source). So the weights are exact but for one division.
std::vector<Taps> taps_along(int source, int target)
{
    std::vector<Taps> all(static_cast<std::size_t>(target));
    for (int i = 0; i < target; ++i) {
        const std::int64_t begin = std::int64_t(i) * source;
        const std::int64_t end = begin + source;
        Taps& taps = all[std::size_t(i)];
        taps.first = int(begin / target);
        for (std::int64_t j = taps.first; j * target < end; ++j) {
            const std::int64_t covered = std::min((j + 1) * target, end) - std::max(j * target, begin);
            taps.weights.push_back(double(covered) / double(source));
        }
    }
    return all;
}

std::array<double, 256> decoding_table(bool srgb)
{
    std::array<double, 256> table{};
    for (std::size_t code = 0; code < 256; ++code) {
        const double coded = double(code) / 255;
        table[code] = srgb ? linear_from_srgb(coded) : coded;
    }
    return table;
}

int half(int size)
{
    return std::max(1, size / 2);
}

}  // namespace

int mip_levels(int width, int height)
{
    assume(width > 0 && height > 0);
    return int(std::bit_width(unsigned(std::max(width, height))));
}

Image shrink(const Image& image, int width, int height, unsigned threads)
{
    assume(width > 0 && height > 0 && !image.values.empty());
    Image target(width, height, image.channels);
    const std::vector<Taps> across = taps_along(image.width, width);
    const std::vector<Taps> down = taps_along(image.height, height);
    const auto channels = std::size_t(image.channels);
    const std::size_t row_size = std::size_t(image.width) * channels;
    const auto average_row = [&](std::size_t y) {
        std::vector<double> column(row_size, 0.0);
        for (std::size_t k = 0; k < down[y].weights.size(); ++k) {
            const float* row = &image.values[(std::size_t(down[y].first) + k) * row_size];
            for (std::size_t i = 0; i < row_size; ++i) column[i] += down[y].weights[k] * double(row[i]);
        }
        float* out = &target.values[y * std::size_t(width) * channels];
        for (const Taps& taps : across)
            for (std::size_t c = 0; c < channels; ++c) {
                double sum = 0;
                for (std::size_t k = 0; k < taps.weights.size(); ++k)
                    sum += taps.weights[k] * column[(std::size_t(taps.first) + k) * channels + c];
                *out++ = float(sum);
            }
    };
    // Threads cost more than they save on small levels.
    parallel_for(std::size_t(height), average_row, image.values.size() < 65536 ? 1 : threads);
    return target;
}

std::vector<Image> mip_chain(Image level0, unsigned threads)
{
    std::vector<Image> chain;
    chain.reserve(std::size_t(mip_levels(level0.width, level0.height)));
    chain.push_back(std::move(level0));
    while (chain.back().width > 1 || chain.back().height > 1)
        chain.push_back(shrink(chain.back(), half(chain.back().width), half(chain.back().height), threads));
    return chain;
}

Image linear_image(const Texels& texels, bool srgb)
{
    Image image(texels.width, texels.height, 4);
    const std::array<double, 256> color = decoding_table(srgb);
    const std::array<double, 256> alpha = decoding_table(false);
    for (std::size_t i = 0; i < image.values.size(); ++i) {
        const bool is_alpha = i % 4 == 3;
        if (texels.is_8_bit)
            image.values[i] = float((is_alpha ? alpha : color)[texels.bytes[i]]);
        else
            image.values[i] = srgb && !is_alpha ? float(linear_from_srgb(double(texels.wide[i]))) : texels.wide[i];
    }
    return image;
}

}  // namespace etalon
