#include "engine/image/io.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>

#include "engine/base/error.h"
#include "engine/base/files.h"
#include "engine/image/codec.h"
#include "engine/image/develop.h"

namespace etalon {
namespace {

using codec::Format;
using codec::Picture;

constexpr const char* kPrefix = "etalon:";

/// Fills RGBA from 1 (grey), 2 (grey and alpha), 3 or 4 channels; `opaque` is the code of alpha 1.
template <typename From, typename To, typename Convert>
void spread_to_rgba(const std::vector<From>& from, std::size_t channels, To opaque, std::vector<To>& to,
                    const Convert& convert)
{
    const std::size_t pixels = from.size() / channels;
    to.resize(4 * pixels);
    const bool grey = channels < 3;
    const bool has_alpha = channels == 2 || channels >= 4;
    for (std::size_t i = 0; i < pixels; ++i) {
        const From* source = &from[i * channels];
        To* target = &to[4 * i];
        for (std::size_t c = 0; c < 3; ++c) target[c] = convert(source[grey ? 0 : c]);
        target[3] = has_alpha ? convert(source[grey ? 1 : 3]) : opaque;
    }
}

Image linear_from_codes(const Picture& picture, const std::string& name)
{
    const std::size_t channels = picture.channels.size();
    if (channels > 4) throw Error(Blame::input, fmt::format("cannot read {}: {} channels", name, channels));
    std::vector<float> rgba;
    if (!picture.codes8.empty())
        spread_to_rgba(picture.codes8, channels, 1.0f, rgba, [](std::uint8_t code) { return float(code) / 255.0f; });
    else
        spread_to_rgba(picture.codes16, channels, 1.0f, rgba,
                       [](std::uint16_t code) { return float(code) / 65535.0f; });
    Image image(picture.width, picture.height, channels % 2 == 0 ? 4 : 3);
    const auto kept = std::size_t(image.channels);
    for (std::size_t i = 0; i < image.pixel_count(); ++i)
        for (std::size_t c = 0; c < kept; ++c) {
            const float coded = rgba[4 * i + c];
            image.values[kept * i + c] = c < 3 ? float(linear_from_srgb(double(coded))) : coded;
        }
    return image;
}

std::optional<std::size_t> find_channel(const Picture& picture, const std::string& name)
{
    const auto found = std::ranges::find(picture.channels, name);
    if (found == picture.channels.end()) return std::nullopt;
    return std::size_t(found - picture.channels.begin());
}

/// Channels of an EXR or HDR by name; a single Y is grey.
Image linear_from_values(const Picture& picture, const std::string& name)
{
    const std::optional<std::size_t> grey = find_channel(picture, "Y");
    std::vector<std::size_t> chosen;
    for (const char* channel : {"R", "G", "B"}) {
        const std::optional<std::size_t> index = find_channel(picture, channel);
        if (!index && !grey)
            throw Error(Blame::input, fmt::format("cannot read {}: it has no channel {}", name, channel));
        chosen.push_back(index ? *index : *grey);
    }
    if (const std::optional<std::size_t> alpha = find_channel(picture, "A")) chosen.push_back(*alpha);
    Image image(picture.width, picture.height, int(chosen.size()));
    for (std::size_t i = 0; i < image.pixel_count(); ++i)
        for (std::size_t c = 0; c < chosen.size(); ++c)
            image.values[chosen.size() * i + c] = picture.values[picture.channels.size() * i + chosen[c]];
    return image;
}

/// The channels of a film that `F` walks over: one place for their names and order, for writing and reading alike.
/// `visit(name, vector of scalars or glm vectors, component names)`.
template <typename Film, typename Visit>
void for_each_channel_group(Film& film, const Visit& visit)
{
    using Names = std::vector<std::string>;
    visit(film.mean, Names{"R", "G", "B"});
    visit(film.alpha, Names{"A"});
    visit(film.variance, Names{"variance.R", "variance.G", "variance.B"});
    visit(film.counts, Names{"samples.count"});
    visit(film.aovs.depth, Names{"depth.Z"});
    visit(film.aovs.normal, Names{"normal.X", "normal.Y", "normal.Z"});
    visit(film.aovs.albedo, Names{"albedo.R", "albedo.G", "albedo.B"});
    visit(film.aovs.emission, Names{"emission.R", "emission.G", "emission.B"});
    visit(film.aovs.object_id, Names{"object.id"});
    visit(film.aovs.material_id, Names{"material.id"});
    visit(film.aovs.uv, Names{"uv.U", "uv.V"});
}

void read_group(const Picture& picture, const std::vector<std::string>& names, std::vector<std::uint32_t>& out)
{
    const auto found = picture.integers.find(names.front());
    if (found != picture.integers.end()) out = found->second;
}

template <typename T>
void read_group(const Picture& picture, const std::vector<std::string>& names, std::vector<T>& out)
{
    std::vector<std::size_t> indices;
    for (const std::string& name : names) {
        const std::optional<std::size_t> index = find_channel(picture, name);
        if (!index) return;
        indices.push_back(*index);
    }
    const std::size_t stride = picture.channels.size();
    out.resize(picture.values.size() / stride);
    auto* target = reinterpret_cast<float*>(out.data());
    for (std::size_t i = 0; i < out.size(); ++i)
        for (const std::size_t index : indices) *target++ = picture.values[i * stride + index];
}

std::uint64_t parse_count(std::map<std::string, std::string>& metadata, const std::string& key, const std::string& name)
{
    const auto node = metadata.extract(key);
    if (node.empty()) return 0;
    const std::string& text = node.mapped();
    std::uint64_t value = 0;
    const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (code != std::errc{} || end != text.data() + text.size())
        throw Error(Blame::input, fmt::format("cannot read {}: {}{} is \"{}\", not a count", name, kPrefix, key, text));
    return value;
}

std::uint8_t code_of(float value)
{
    if (!(value > 0)) return 0;
    if (value >= 1) return 255;
    return static_cast<std::uint8_t>(std::floor(255.0 * double(value) + 0.5));
}

}  // namespace

Texels decode_texels(std::span<const std::byte> bytes, const std::string& name, const Limits& limits)
{
    constexpr std::array kAccepted{Format::png, Format::jpeg, Format::webp};
    const Picture picture = codec::decode(bytes, kAccepted, limits, name);
    const std::size_t channels = picture.channels.size();
    if (channels > 4) throw Error(Blame::input, fmt::format("cannot decode {}: {} channels", name, channels));
    Texels texels;
    texels.width = picture.width;
    texels.height = picture.height;
    texels.is_8_bit = !picture.codes8.empty();
    if (texels.is_8_bit)
        spread_to_rgba(picture.codes8, channels, std::uint8_t{255}, texels.bytes,
                       [](std::uint8_t code) { return code; });
    else
        spread_to_rgba(picture.codes16, channels, 1.0f, texels.wide,
                       [](std::uint16_t code) { return float(code) / 65535.0f; });
    return texels;
}

Image read_image(const std::filesystem::path& path, const Limits& limits)
{
    constexpr std::array kAccepted{Format::exr, Format::hdr, Format::png, Format::jpeg, Format::webp};
    const Picture picture = codec::decode(read_file(path, limits.resource_bytes), kAccepted, limits, path.string());
    return picture.values.empty() ? linear_from_codes(picture, path.string())
                                  : linear_from_values(picture, path.string());
}

std::size_t replace_nonfinite(Image& image)
{
    float largest = 0;
    for (const float value : image.values)
        if (std::isfinite(value)) largest = std::max(largest, value);
    std::size_t texels = 0;
    const auto channels = std::size_t(image.channels);
    for (std::size_t i = 0; i < image.pixel_count(); ++i) {
        bool replaced = false;
        for (float& value : std::span(image.values).subspan(channels * i, channels)) {
            if (std::isfinite(value)) continue;
            value = value > 0 ? largest : 0;
            replaced = true;
        }
        texels += replaced ? 1 : 0;
    }
    return texels;
}

PictureFormat picture_format(const std::filesystem::path& path)
{
    std::string extension = path.extension().string();
    for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    if (extension == ".exr") return PictureFormat::exr;
    if (extension == ".png") return PictureFormat::png;
    throw Error(Blame::input,
                extension.empty()
                    ? fmt::format("cannot tell the format of {}: it has no extension", path.string())
                    : fmt::format("cannot write {}: no format has the extension {}", path.string(), extension),
                "use .exr (radiance, its error and metadata) or .png (for looking at)");
}

void write_film(const Film& film, const std::filesystem::path& path)
{
    if (picture_format(path) != PictureFormat::exr)
        throw Error(Blame::input, fmt::format("cannot write a film to {}", path.string()), "use the extension .exr");
    const std::size_t pixels = film.pixel_count();
    assume(film.width > 0 && film.height > 0 && film.mean.size() == pixels);
    std::vector<codec::Channel> channels;
    for_each_channel_group(film, [&](const auto& values, const std::vector<std::string>& names) {
        if (values.empty()) return;
        assume(values.size() == pixels);
        using Scalar = std::conditional_t<std::is_same_v<decltype(values), const std::vector<std::uint32_t>&>,
                                          std::uint32_t, float>;
        const auto* first = reinterpret_cast<const Scalar*>(values.data());
        for (std::size_t c = 0; c < names.size(); ++c) channels.push_back({names[c], first + c, names.size()});
    });
    std::map<std::string, std::string> text;
    for (const auto& [key, value] : film.metadata) text[kPrefix + key] = value;
    text[std::string(kPrefix) + "samples"] = std::to_string(film.samples);
    if (film.replicates > 0) text[std::string(kPrefix) + "replicates"] = std::to_string(film.replicates);
    text[std::string(kPrefix) + "nonfinite"] = std::to_string(film.nonfinite);
    text[std::string(kPrefix) + "truncated"] = std::to_string(film.truncated);
    replace_file(path, codec::encode_exr(film.width, film.height, channels, text));
}

Film read_film(const std::filesystem::path& path, const Limits& limits)
{
    constexpr std::array kAccepted{Format::exr};
    const Picture picture = codec::decode(read_file(path, limits.resource_bytes), kAccepted, limits, path.string());
    Film film;
    film.width = picture.width;
    film.height = picture.height;
    for_each_channel_group(
        film, [&](auto& values, const std::vector<std::string>& names) { read_group(picture, names, values); });
    if (film.mean.empty())
        throw Error(Blame::input, fmt::format("cannot read {}: it has no channels R, G and B", path.string()));
    if (film.alpha.empty()) film.alpha.assign(film.pixel_count(), 1.0f);
    for (const auto& [key, value] : picture.text)
        if (key.starts_with(kPrefix)) film.metadata[key.substr(std::string_view(kPrefix).size())] = value;
    film.samples = parse_count(film.metadata, "samples", path.string());
    const std::uint64_t replicates = parse_count(film.metadata, "replicates", path.string());
    film.replicates = replicates < 2 ? 0 : static_cast<std::uint32_t>(std::min(replicates, film.samples));
    film.nonfinite = parse_count(film.metadata, "nonfinite", path.string());
    film.truncated = parse_count(film.metadata, "truncated", path.string());
    return film;
}

std::vector<std::byte> encode_png(const Image& display, const std::map<std::string, std::string>& metadata)
{
    std::vector<std::uint8_t> codes(display.values.size());
    std::ranges::transform(display.values, codes.begin(), code_of);
    return codec::encode_png(display.width, display.height, display.channels, codes, metadata);
}

void write_png(const Image& display, const std::map<std::string, std::string>& metadata,
               const std::filesystem::path& path)
{
    if (picture_format(path) != PictureFormat::png)
        throw Error(Blame::input, fmt::format("cannot write a developed picture to {}", path.string()),
                    "use the extension .png");
    replace_file(path, encode_png(display, metadata));
}

}  // namespace etalon
