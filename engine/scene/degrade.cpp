#include "engine/scene/degrade.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "engine/image/develop.h"

namespace etalon {
namespace {

constexpr int kMostHalvings = 20;     // a side of 2^20 texels is one after so many
constexpr int kSmallestPicture = 16;  // pixels of its shorter side: below it there is nothing to see

/// Which images are colours, coded as sRGB but for their alpha.
std::vector<bool> colours_of(const Scene& scene)
{
    std::vector<bool> out(scene.images.size());
    const auto mark = [&](const TextureUse& use) {
        if (use.present() && scene.textures.at(use.texture).image != kNone)
            out.at(scene.textures[use.texture].image) = true;
    };
    for (const Material& material : scene.materials) {
        mark(material.base_color_texture);
        mark(material.emissive_texture);
        if (material.model == BsdfModel::specular_glossiness) mark(material.metallic_roughness_texture);
        if (!material.layers) continue;
        mark(material.layers->specular_color_texture);
        mark(material.layers->sheen_color_texture);
        mark(material.layers->diffuse_transmission_color_texture);
    }
    return out;
}

/// One side's texels [0, from) over [0, to): which of them each new texel covers, and how much of each.
struct Taps {
    int begin = 0;
    std::array<double, 4> weights{};  ///< sum 1; halving an odd side covers at most 4
};

std::vector<Taps> taps(int from, int to)
{
    std::vector<Taps> out(static_cast<std::size_t>(to));
    const double step = double(from) / to;
    for (int i = 0; i < to; ++i) {
        Taps& tap = out[static_cast<std::size_t>(i)];
        const double begin = i * step;
        const double end = i + 1 == to ? from : (i + 1) * step;
        tap.begin = static_cast<int>(begin);
        for (int k = 0; k < 4; ++k)
            tap.weights[static_cast<std::size_t>(k)] =
                std::max(0.0, std::min(end, tap.begin + k + 1.0) - std::max(begin, double(tap.begin + k))) / step;
    }
    return out;
}

/// Reads and writes texels of either kind as RGBA in linear light.
class Access {
 public:
    Access(const Texels& texels, bool is_colour) : texels_(texels), is_colour_(is_colour)
    {
        for (std::size_t i = 0; i < table_.size(); ++i)
            table_[i] = is_colour ? linear_from_srgb(double(i) / 255) : double(i) / 255;
    }

    double read(int x, int y, std::size_t channel) const
    {
        const std::size_t at = (std::size_t(y) * std::size_t(texels_.width) + std::size_t(x)) * 4 + channel;
        const bool decodes = is_colour_ && channel < 3;
        if (texels_.is_8_bit) return decodes ? table_[texels_.bytes[at]] : texels_.bytes[at] / 255.0;
        return decodes ? linear_from_srgb(double(texels_.wide[at])) : double(texels_.wide[at]);
    }

    void append(Texels& out, double value, std::size_t channel) const
    {
        const double coded = is_colour_ && channel < 3 ? srgb_from_linear(value) : value;
        if (out.is_8_bit)
            out.bytes.push_back(static_cast<std::uint8_t>(std::lround(std::clamp(coded, 0.0, 1.0) * 255)));
        else
            out.wide.push_back(static_cast<float>(coded));
    }

 private:
    const Texels& texels_;
    bool is_colour_;
    std::array<double, 256> table_{};
};

/// Sums over all RGB values of all images.
struct Change {
    double squares = 0;  ///< of the differences
    double sum = 0;      ///< of the values before
    double count = 0;
};

Texels halved(const Texels& in, bool is_colour, Change& change)
{
    Texels out{.width = std::max(1, in.width / 2), .height = std::max(1, in.height / 2), .is_8_bit = in.is_8_bit};
    const std::size_t size = std::size_t(out.width) * std::size_t(out.height) * 4;
    in.is_8_bit ? out.bytes.reserve(size) : out.wide.reserve(size);
    const Access access(in, is_colour);
    const std::vector<Taps> columns = taps(in.width, out.width);
    for (const Taps& row : taps(in.height, out.height)) {
        for (const Taps& column : columns) {
            for (std::size_t c = 0; c < 4; ++c) {
                double mean = 0, squares = 0;
                for (int j = 0; j < 4; ++j) {
                    for (int i = 0; i < 4; ++i) {
                        const double weight =
                            row.weights[static_cast<std::size_t>(j)] * column.weights[static_cast<std::size_t>(i)];
                        if (weight == 0) continue;
                        const double value = access.read(column.begin + i, row.begin + j, c);
                        mean += weight * value;
                        squares += weight * value * value;
                    }
                }
                access.append(out, mean, c);
                if (c == 3) continue;
                change.squares += std::max(0.0, squares - mean * mean);
                change.sum += mean;
                change.count += 1;
            }
        }
    }
    return out;
}

}  // namespace

ivec2 halved(ivec2 size, int times)
{
    return {std::max(1, size.x >> times), std::max(1, size.y >> times)};
}

Degradation plan_degradation(const Footprint& need, ivec2 size, std::uint64_t memory)
{
    Degradation out;
    Footprint left = need;
    while (left.total() > memory) {
        const bool is_smallest = std::min(size.x, size.y) >> out.picture <= kSmallestPicture;
        const bool textures_left = left.textures > 0 && out.textures < kMostHalvings;
        if (textures_left && (left.textures >= left.picture || is_smallest)) {
            left.textures /= 4;
            ++out.textures;
        } else if (!is_smallest) {
            left.picture /= 4;
            ++out.picture;
        } else {
            check_memory(left, memory);
        }
    }
    return out;
}

double halve_images(Scene& scene, int times)
{
    const std::vector<bool> colours = colours_of(scene);
    double squares = 0, mean = 0;
    for (int time = 0; time < times; ++time) {
        Change change;
        for (std::size_t i = 0; i < scene.images.size(); ++i) {
            Texels& image = scene.images[i];
            if (image.width > 1 || image.height > 1) image = halved(image, colours[i], change);
        }
        if (change.count == 0) break;
        // Averages of averages: the variance within the new texels adds to that within the old ones.
        squares += change.squares / change.count;
        if (time == 0) mean = change.sum / change.count;
    }
    return mean > 0 ? std::sqrt(squares) / mean : 0;
}

}  // namespace etalon
