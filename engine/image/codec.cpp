#include "engine/image/codec.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <new>
#include <optional>
#include <stdexcept>
#include <string_view>

#include "engine/base/error.h"
#include "engine/image/claims.h"
#include "engine/image/picture_library.h"

namespace etalon::codec {
namespace {

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
void check_header(const Header& header, Format format, std::size_t file_bytes, const Limits& limits,
                  const std::string& name)
{
    if (header.width < 1 || header.height < 1 || header.depth > 1 || header.channels.empty())
        throw bad(name, fmt::format("it claims {}x{} pixels", header.width, header.height));
    check_claims({.width = std::uint64_t(header.width),
                  .height = std::uint64_t(header.height),
                  .channels = header.channels.size(),
                  .pixel_bytes = header.pixel_bytes},
                 file_bytes, limits, name);
    if (format != Format::exr) return;
    if (header.deep) throw bad(name, "it is a deep EXR", "flatten it first");
    if (header.windows_differ)
        throw bad(name, "its data window is not its display window", "pad or crop it to the display window");
    // OpenEXR wrote past its buffer for partial edge tiles (CVE-2026-63422); the distribution's package is not mended.
    if (header.tile_width > 0 && (header.width % header.tile_width != 0 || header.height % header.tile_height != 0))
        throw bad(name, "its tiles do not fill the picture", "save it with scan lines instead of tiles");
}

Picture decode_guarded(std::span<const std::byte> bytes, Format format, const Limits& limits, const std::string& name)
{
    return picture_library().decode(
        bytes, format, [&](const Header& header) { check_header(header, format, bytes.size(), limits, name); });
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

std::vector<std::byte> encode(const Sheet& sheet)
{
    try {
        return picture_library().encode(sheet);
    } catch (const std::runtime_error& error) {
        throw Error(Blame::machine, fmt::format("cannot encode {}x{} pixels as {}: {}", sheet.width, sheet.height,
                                                display_name(sheet.format), error.what()));
    } catch (const std::logic_error& error) {
        throw Error(Blame::machine, error.what());
    }
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
    } catch (const std::logic_error& error) {
        throw Error(Blame::machine, error.what());
    } catch (const std::exception& exception) {
        throw bad(name, exception.what());
    }
}

std::vector<std::byte> encode_exr(int width, int height, std::span<const Channel> channels,
                                  const std::map<std::string, std::string>& text)
{
    Sheet sheet{.format = Format::exr, .width = width, .height = height, .text = &text};
    for (const Channel& channel : channels) {
        sheet.channels.push_back(channel.name);
        const bool is_float = std::holds_alternative<const float*>(channel.first);
        sheet.types.push_back(is_float ? ChannelType::float32 : ChannelType::uint32);
    }
    const std::size_t pixels = std::size_t(width) * std::size_t(height);
    std::vector<std::uint32_t> words(pixels * channels.size());
    for (std::size_t c = 0; c < channels.size(); ++c)
        std::visit(
            [&](const auto* first) {
                for (std::size_t i = 0; i < pixels; ++i)
                    std::memcpy(&words[i * channels.size() + c], first + i * channels[c].step, sizeof(std::uint32_t));
            },
            channels[c].first);
    sheet.data = words.data();
    return encode(sheet);
}

std::vector<std::byte> encode_png(int width, int height, int channels, std::span<const std::uint8_t> codes,
                                  const std::map<std::string, std::string>& text)
{
    assume((channels == 3 || channels == 4) && width > 0 && height > 0 &&
           codes.size() == std::size_t(width) * std::size_t(height) * std::size_t(channels));
    return encode({.format = Format::png,
                   .width = width,
                   .height = height,
                   .channels = std::vector<std::string>(static_cast<std::size_t>(channels)),
                   .types = std::vector(static_cast<std::size_t>(channels), ChannelType::code8),
                   .data = codes.data(),
                   .text = &text});
}

}  // namespace etalon::codec
