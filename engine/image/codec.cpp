// The one includer of OpenImageIO.
#include "engine/image/codec.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <memory>
#include <new>
#include <optional>
#include <string_view>

#include "engine/base/error.h"
#include "engine/image/claims.h"

namespace etalon::codec {
namespace {

const char* plugin(Format format)
{
    switch (format) {
        case Format::png:
            return "png";
        case Format::jpeg:
            return "jpeg";
        case Format::webp:
            return "webp";
        case Format::hdr:
            return "hdr";
        case Format::exr:
            return "openexr";
    }
    return "";
}

const char* display_name(Format format)
{
    constexpr std::array kNames{"PNG", "JPEG", "WebP", "Radiance HDR", "OpenEXR"};
    return kNames[static_cast<std::size_t>(format)];
}

std::optional<Format> recognise(std::span<const std::byte> bytes)
{
    const std::string_view head(reinterpret_cast<const char*>(bytes.data()), std::min<std::size_t>(bytes.size(), 16));
    using namespace std::string_view_literals;
    if (head.starts_with("\x89PNG\r\n\x1a\n"sv)) return Format::png;
    if (head.starts_with("\xff\xd8\xff"sv)) return Format::jpeg;
    if (head.starts_with("RIFF"sv) && head.size() >= 12 && head.substr(8, 4) == "WEBP"sv) return Format::webp;
    if (head.starts_with("#?RADIANCE"sv) || head.starts_with("#?RGBE"sv)) return Format::hdr;
    if (head.starts_with("\x76\x2f\x31\x01"sv)) return Format::exr;
    return std::nullopt;
}

// The name of a format that glTF files may carry by extension and that is not decoded here; empty: not one of those.
std::string_view unread_format(std::span<const std::byte> bytes)
{
    const std::string_view head(reinterpret_cast<const char*>(bytes.data()), std::min<std::size_t>(bytes.size(), 16));
    using namespace std::string_view_literals;
    if (head.starts_with("\xabKTX 20\xbb\r\n\x1a\n"sv)) return "KTX 2";
    if (head.starts_with("DDS "sv)) return "DDS";
    if (head.size() >= 12 && (head.substr(4, 8) == "ftypavif"sv || head.substr(4, 8) == "ftypavis"sv)) return "AVIF";
    return {};
}

Error bad(const std::string& name, const std::string& why, const std::string& mend = {})
{
    return Error(Blame::input, fmt::format("cannot decode {}: {}", name, why), mend);
}

Format require_format(std::span<const std::byte> bytes, std::span<const Format> accepted, const std::string& name)
{
    if (bytes.empty()) throw bad(name, "it is empty");
    const std::optional<Format> format = recognise(bytes);
    if (format && std::ranges::find(accepted, *format) != accepted.end()) return *format;
    std::string list;
    for (const Format f : accepted) list += (list.empty() ? "" : ", ") + std::string(display_name(f));
    const std::string_view unread = unread_format(bytes);
    throw bad(name,
              format           ? fmt::format("{} is not accepted here", display_name(*format))
              : unread.empty() ? "its first bytes are of no format we know"
                               : fmt::format("it is {}, which Etalon does not read", unread),
              "convert it to one of: " + list);
}

/// What the library found in the header, which is what it will ask memory for.
void check_spec(const OIIO::ImageSpec& spec, Format format, std::size_t file_bytes, const Limits& limits,
                const std::string& name)
{
    if (spec.width < 1 || spec.height < 1 || spec.depth > 1 || spec.nchannels < 1)
        throw bad(name, fmt::format("it claims {}x{} pixels", spec.width, spec.height));
    check_claims({.width = std::uint64_t(spec.width),
                  .height = std::uint64_t(spec.height),
                  .channels = std::uint64_t(spec.nchannels),
                  .pixel_bytes = spec.pixel_bytes(true)},
                 file_bytes, limits, name);
    if (format != Format::exr) return;
    if (spec.deep) throw bad(name, "it is a deep EXR", "flatten it first");
    if (spec.x != spec.full_x || spec.y != spec.full_y || spec.width != spec.full_width ||
        spec.height != spec.full_height)
        throw bad(name, "its data window is not its display window", "pad or crop it to the display window");
    // OpenEXR wrote past its buffer for partial edge tiles (CVE-2026-63422); the distribution's package is not mended.
    if (spec.tile_width > 0 && (spec.width % spec.tile_width != 0 || spec.height % spec.tile_height != 0))
        throw bad(name, "its tiles do not fill the picture", "save it with scan lines instead of tiles");
}

template <typename T>
void read_values(OIIO::ImageInput& input, int first, int end, OIIO::TypeDesc type, std::vector<T>& out,
                 const std::string& name)
{
    const OIIO::ImageSpec& spec = input.spec();
    out.resize(std::size_t(spec.width) * std::size_t(spec.height) * std::size_t(end - first));
    if (!input.read_image(0, 0, first, end, type, out.data())) throw bad(name, input.geterror());
}

void read_pixels(OIIO::ImageInput& input, Picture& picture, const std::string& name)
{
    const OIIO::ImageSpec spec = input.spec();
    const int channels = spec.nchannels;
    if (picture.format == Format::exr || picture.format == Format::hdr) {
        read_values(input, 0, channels, OIIO::TypeFloat, picture.values, name);
        for (int c = 0; c < channels; ++c)
            if (spec.channelformat(c) == OIIO::TypeUInt32)
                read_values(input, c, c + 1, OIIO::TypeUInt32, picture.integers[spec.channel_name(c)], name);
    } else if (spec.format == OIIO::TypeUInt8) {
        read_values(input, 0, channels, OIIO::TypeUInt8, picture.codes8, name);
    } else {
        read_values(input, 0, channels, OIIO::TypeUInt16, picture.codes16, name);
    }
}

Picture decode_guarded(std::span<const std::byte> bytes, Format format, const Limits& limits, const std::string& name)
{
    OIIO::Filesystem::IOMemReader memory(bytes.data(), bytes.size());
    const std::unique_ptr<OIIO::ImageInput> input = OIIO::ImageInput::create(plugin(format));
    if (!input)
        throw Error(Blame::machine,
                    fmt::format("OpenImageIO here cannot read {}: {}", display_name(format), OIIO::geterror()));
    if (!input->set_ioproxy(&memory))
        throw Error(Blame::machine, fmt::format("OpenImageIO here cannot read {} from memory", display_name(format)));
    OIIO::ImageSpec config;
    config.attribute("oiio:UnassociatedAlpha", 1);
    OIIO::ImageSpec spec;
    // A name of ours, never the file's: OpenImageIO reads meaning into names. The content comes from `memory`.
    if (!input->open(fmt::format("memory.{}", plugin(format)), spec, config)) throw bad(name, input->geterror());
    check_spec(spec, format, bytes.size(), limits, name);

    Picture picture;
    picture.format = format;
    picture.width = spec.width;
    picture.height = spec.height;
    picture.channels = spec.channelnames;
    for (const OIIO::ParamValue& value : spec.extra_attribs)
        if (value.type() == OIIO::TypeString) picture.text[value.name().string()] = value.get_string();
    read_pixels(*input, picture, name);
    input->close();
    return picture;
}

/// Replaces the premultiplied colour of a WebP picture by the file's own.
void restore_color(Picture& picture, std::span<const std::byte> bytes, const Limits& limits, const std::string& name)
{
    const Picture color = decode_guarded(webp_without_alpha(bytes), Format::webp, limits, name);
    if (color.channels.size() != 3 || color.width != picture.width || color.height != picture.height)
        throw bad(name, "its alpha cannot be told from its colour");
    for (std::size_t i = 0; 4 * i < picture.codes8.size(); ++i)
        std::copy_n(&color.codes8[3 * i], 3, &picture.codes8[4 * i]);
}

/// Writes one picture into memory with the plugin of `format`; `data` is laid out as `spec` says.
std::vector<std::byte> encode(Format format, const OIIO::ImageSpec& spec, const void* data)
{
    const auto failed = [&](const std::string& why) {
        return Error(Blame::machine, fmt::format("cannot encode {}x{} pixels as {}: {}", spec.width, spec.height,
                                                 display_name(format), why));
    };
    OIIO::Filesystem::IOVecOutput memory;
    const std::unique_ptr<OIIO::ImageOutput> output = OIIO::ImageOutput::create(plugin(format));
    if (!output) throw failed(OIIO::geterror());
    if (!output->set_ioproxy(&memory)) throw failed("its writer cannot write to memory");
    // UNKNOWN: the data are in the file's own types already, channel by channel.
    if (!output->open(fmt::format("memory.{}", plugin(format)), spec) ||
        !output->write_image(OIIO::TypeUnknown, data) || !output->close())
        throw failed(output->geterror());
    const std::span<const std::byte> bytes = std::as_bytes(std::span(memory.buffer()));
    return {bytes.begin(), bytes.end()};
}

}  // namespace

Picture decode(std::span<const std::byte> bytes, std::span<const Format> accepted, const Limits& limits,
               const std::string& name)
{
    const Format format = require_format(bytes, accepted, name);
    if (!is_whole(bytes, format)) throw bad(name, "the file ends early");
    if (const std::optional<Claims> claims = read_claims(bytes, format, name))
        check_claims(*claims, bytes.size(), limits, name);
    try {
        const std::vector<std::byte> picture_alone = bare(bytes, format);
        Picture picture = decode_guarded(picture_alone, format, limits, name);
        if (format == Format::webp && picture.channels.size() == 4) restore_color(picture, picture_alone, limits, name);
        return picture;
    } catch (const Error&) {
        throw;
    } catch (const std::bad_alloc&) {
        throw Error(Blame::machine, fmt::format("cannot decode {}: no memory for its pixels", name), "resize it");
    } catch (const std::exception& exception) {
        throw bad(name, exception.what());
    }
}

std::vector<std::byte> encode_exr(int width, int height, std::span<const Channel> channels,
                                  const std::map<std::string, std::string>& text)
{
    OIIO::ImageSpec spec(width, height, static_cast<int>(channels.size()), OIIO::TypeFloat);
    spec.channelnames.clear();
    for (const Channel& channel : channels) {
        spec.channelnames.push_back(channel.name);
        const bool is_float = std::holds_alternative<const float*>(channel.first);
        spec.channelformats.push_back(is_float ? OIIO::TypeFloat : OIIO::TypeUInt32);
        if (channel.name == "A") spec.alpha_channel = static_cast<int>(spec.channelnames.size()) - 1;
    }
    spec.attribute("compression", "zip");
    spec.attribute("DateTime", "");  // else the writer says when it ran, and equal films differ in bytes
    for (const auto& [key, value] : text) spec.attribute(key, value);

    const std::size_t pixels = std::size_t(width) * std::size_t(height);
    std::vector<std::uint32_t> words(pixels * channels.size());
    for (std::size_t c = 0; c < channels.size(); ++c)
        std::visit(
            [&](const auto* first) {
                for (std::size_t i = 0; i < pixels; ++i)
                    std::memcpy(&words[i * channels.size() + c], first + i * channels[c].step, sizeof(std::uint32_t));
            },
            channels[c].first);
    return encode(Format::exr, spec, words.data());
}

std::vector<std::byte> encode_png(int width, int height, int channels, std::span<const std::uint8_t> codes,
                                  const std::map<std::string, std::string>& text)
{
    assume((channels == 3 || channels == 4) && width > 0 && height > 0 &&
           codes.size() == std::size_t(width) * std::size_t(height) * std::size_t(channels));
    OIIO::ImageSpec spec(width, height, channels, OIIO::TypeUInt8);
    spec.attribute("oiio:UnassociatedAlpha", 1);
    spec.attribute("oiio:ColorSpace", "sRGB");
    for (const auto& [key, value] : text) spec.attribute(key, value);
    return encode(Format::png, spec, codes.data());
}

}  // namespace etalon::codec
