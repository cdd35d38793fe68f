#include "engine/image/mips.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <span>

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

/// Averages `rows`, a function that writes source row y as `channels` doubles a texel, down to the size of `target`.
template <typename Rows>
void shrink_rows(const Rows& rows, int source_width, int source_height, Image& target, unsigned threads)
{
    const std::vector<Taps> across = taps_along(source_width, target.width);
    const std::vector<Taps> down = taps_along(source_height, target.height);
    const auto channels = std::size_t(target.channels);
    const auto row_values = [&](std::size_t y) {
        std::vector<double> column(std::size_t(source_width) * channels, 0.0);
        std::vector<double> row(column.size());
        for (std::size_t k = 0; k < down[y].weights.size(); ++k) {
            rows(down[y].first + int(k), row.data());
            for (std::size_t i = 0; i < row.size(); ++i) column[i] += down[y].weights[k] * row[i];
        }
        float* out = &target.values[y * std::size_t(target.width) * channels];
        for (const Taps& taps : across)
            for (std::size_t c = 0; c < channels; ++c) {
                double sum = 0;
                for (std::size_t k = 0; k < taps.weights.size(); ++k)
                    sum += taps.weights[k] * column[(std::size_t(taps.first) + k) * channels + c];
                *out++ = float(sum);
            }
    };
    // Threads cost more than they save on small levels.
    parallel_for(std::size_t(target.height), row_values, target.values.size() < 65536 ? 1 : threads);
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

/// sRGB codes of linear values without a power for each: the code is the number of rounding thresholds at or below it.
class Encoder {
 public:
    Encoder()
    {
        for (std::size_t code = 1; code < 256; ++code)
            thresholds_[code - 1] = linear_from_srgb((double(code) - 0.5) / 255);
        for (std::size_t i = 0; i < kBuckets; ++i) {
            const auto above = std::ranges::upper_bound(thresholds_, double(i) / kBuckets);
            first_[i] = std::uint8_t(above - thresholds_.begin());
        }
    }
    std::uint8_t operator()(float linear) const
    {
        if (!(linear > 0)) return 0;
        if (linear >= 1) return 255;
        std::size_t code = first_[std::size_t(linear * kBuckets)];
        while (code < 255 && thresholds_[code] <= double(linear)) ++code;
        return std::uint8_t(code);
    }

 private:
    static constexpr std::size_t kBuckets = 4096;
    std::array<double, 255> thresholds_{};
    std::array<std::uint8_t, kBuckets> first_{};
};

std::uint8_t code_of(float value)
{
    if (!(value > 0)) return 0;
    return value >= 1 ? 255 : std::uint8_t(std::floor(255 * double(value) + 0.5));
}

Level8 encode_level(const Image& level, const Encoder* srgb)
{
    Level8 out{level.width, level.height, std::vector<std::uint8_t>(level.values.size())};
    for (std::size_t i = 0; i < level.values.size(); ++i)
        out.bytes[i] = srgb != nullptr && i % 4 != 3 ? (*srgb)(level.values[i]) : code_of(level.values[i]);
    return out;
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
    assume(width > 0 && height > 0 && width <= image.width && height <= image.height);
    Image target(width, height, image.channels);
    const std::size_t row_size = std::size_t(image.width) * std::size_t(image.channels);
    const auto rows = [&](int y, double* out) { std::copy_n(&image.values[std::size_t(y) * row_size], row_size, out); };
    shrink_rows(rows, image.width, image.height, target, threads);
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

std::vector<Level8> mip_chain_8(const Texels& texels, bool srgb, unsigned threads)
{
    assume(texels.is_8_bit && texels.bytes.size() == 4 * std::size_t(texels.width) * std::size_t(texels.height));
    std::vector<Level8> chain{{texels.width, texels.height, texels.bytes}};
    if (texels.width == 1 && texels.height == 1) return chain;

    const std::array<double, 256> color = decoding_table(srgb);
    const std::array<double, 256> alpha = decoding_table(false);
    const auto rows = [&](int y, double* out) {
        const std::uint8_t* row = &texels.bytes[4 * std::size_t(y) * std::size_t(texels.width)];
        for (std::size_t i = 0; i < 4 * std::size_t(texels.width); ++i) out[i] = (i % 4 == 3 ? alpha : color)[row[i]];
    };
    Image level(half(texels.width), half(texels.height), 4);
    shrink_rows(rows, texels.width, texels.height, level, threads);
    const Encoder encoder;
    for (;;) {
        chain.push_back(encode_level(level, srgb ? &encoder : nullptr));
        if (level.width == 1 && level.height == 1) return chain;
        level = shrink(level, half(level.width), half(level.height), threads);
    }
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
