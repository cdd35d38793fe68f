#include "engine/image/claims.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <string_view>

#include "engine/base/error.h"

namespace etalon::codec {
namespace {

using Bytes = std::span<const std::byte>;

/// Small pictures may be out of proportion to their files, since a flat WebP of any size takes a few dozen bytes.
constexpr std::uint64_t kHarmlessBytes = std::uint64_t{64} << 20;

Error bad(const std::string& name, const std::string& why, const std::string& mend = {})
{
    return Error(Blame::input, fmt::format("cannot decode {}: {}", name, why), mend);
}

std::uint64_t byte_at(Bytes bytes, std::size_t at)
{
    return std::to_integer<std::uint64_t>(bytes[at]);
}

std::uint64_t big_endian(Bytes bytes, std::size_t at, std::size_t size)
{
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < size; ++i) value = value << 8 | byte_at(bytes, at + i);
    return value;
}

std::uint64_t little_endian(Bytes bytes, std::size_t at, std::size_t size)
{
    std::uint64_t value = 0;
    for (std::size_t i = size; i-- > 0;) value = value << 8 | byte_at(bytes, at + i);
    return value;
}

std::string_view text_at(Bytes bytes, std::size_t at, std::size_t size)
{
    return {reinterpret_cast<const char*>(bytes.data()) + at, size};
}

// PNG: 8 bytes of signature, then chunks of length, name, data and checksum (ISO/IEC 15948).

std::optional<Claims> png_claims(Bytes bytes)
{
    constexpr std::size_t kHeader = 8 + 8 + 13;
    if (bytes.size() < kHeader || text_at(bytes, 12, 4) != "IHDR") return std::nullopt;
    constexpr std::array<std::uint64_t, 7> kChannels{1, 0, 3, 4, 2, 0, 4};  // by colour type; a palette may hold alpha
    const std::uint64_t depth = byte_at(bytes, 24), color = byte_at(bytes, 25);
    const std::uint64_t channels = color < kChannels.size() ? kChannels[color] : 0;
    return Claims{big_endian(bytes, 16, 4), big_endian(bytes, 20, 4), channels, channels * (depth == 16 ? 2 : 1)};
}

/// Calls `with(name, begin, end)` for each whole chunk up to IEND; whether it came to IEND.
template <typename With>
bool for_each_png_chunk(Bytes bytes, const With& with)
{
    for (std::size_t i = 8; i + 12 <= bytes.size();) {
        const std::size_t size = big_endian(bytes, i, 4);
        if (size > bytes.size() - i - 12) return false;
        const std::string_view kind = text_at(bytes, i + 4, 4);
        with(kind, i, i + 12 + size);
        if (kind == "IEND") return true;
        i += 12 + size;
    }
    return false;
}

std::vector<std::byte> bare_png(Bytes bytes)
{
    std::vector<std::byte> out(bytes.begin(), bytes.begin() + 8);
    out.reserve(bytes.size());
    for_each_png_chunk(bytes, [&](std::string_view kind, std::size_t begin, std::size_t end) {
        constexpr std::array<std::string_view, 5> kPicture{"IHDR", "PLTE", "tRNS", "IDAT", "IEND"};
        if (std::ranges::find(kPicture, kind) == kPicture.end()) return;
        out.insert(out.end(), bytes.begin() + std::ptrdiff_t(begin), bytes.begin() + std::ptrdiff_t(end));
    });
    return out;
}

// JPEG: segments of 0xff, marker, and mostly a length that counts itself (ITU T.81, annex B).

struct Segment {
    unsigned marker = 0;
    std::size_t begin = 0;  ///< of its 0xff
    std::size_t data = 0;   ///< after the marker
    std::size_t end = 0;
};

constexpr unsigned kStartOfScan = 0xda;

/// The next segment from byte `i`, found as libjpeg does: past whatever is no marker.
std::optional<Segment> next_segment(Bytes bytes, std::size_t i)
{
    for (; i + 4 <= bytes.size(); ++i) {
        const auto marker = static_cast<unsigned>(byte_at(bytes, i + 1));
        if (byte_at(bytes, i) != 0xff || marker == 0 || marker == 0xff) continue;
        const bool alone = marker == 0x01 || (marker >= 0xd0 && marker <= 0xd9);
        const std::size_t size = alone ? 0 : big_endian(bytes, i + 2, 2);
        return Segment{marker, i, i + 2, std::min(i + 2 + size, bytes.size())};
    }
    return std::nullopt;
}

std::optional<Claims> jpeg_claims(Bytes bytes)
{
    for (auto segment = next_segment(bytes, 2); segment; segment = next_segment(bytes, segment->end)) {
        const unsigned m = segment->marker;
        if (m == kStartOfScan) return std::nullopt;
        if (m < 0xc0 || m > 0xcf || m == 0xc4 || m == 0xc8 || m == 0xcc) continue;  // no frame
        if (segment->end - segment->data < 8) return std::nullopt;
        const std::uint64_t channels = byte_at(bytes, segment->data + 7);
        return Claims{big_endian(bytes, segment->data + 5, 2), big_endian(bytes, segment->data + 3, 2), channels,
                      channels};
    }
    return std::nullopt;
}

/// libjpeg fills what is missing of a cut file with grey and succeeds. In the coded data 0xff is followed by 0 or a
/// restart marker alone, so that the first end marker after the start of the scan is the end.
bool jpeg_is_whole(Bytes bytes)
{
    auto segment = next_segment(bytes, 2);
    while (segment && segment->marker != kStartOfScan) segment = next_segment(bytes, segment->end);
    for (std::size_t i = segment ? segment->begin : bytes.size(); i + 2 <= bytes.size(); ++i)
        if (big_endian(bytes, i, 2) == 0xffd9) return true;
    return false;
}

std::vector<std::byte> bare_jpeg(Bytes bytes)
{
    std::vector<std::byte> out(bytes.begin(), bytes.begin() + 2);
    out.reserve(bytes.size());
    std::size_t done = 2;
    const auto keep_to = [&](std::size_t end) {
        out.insert(out.end(), bytes.begin() + std::ptrdiff_t(done), bytes.begin() + std::ptrdiff_t(end));
        done = end;
    };
    for (auto segment = next_segment(bytes, 2); segment && segment->marker != kStartOfScan;
         segment = next_segment(bytes, segment->end)) {
        const unsigned m = segment->marker;
        const bool picture = m < 0xe0 || m == 0xe0 || m == 0xee;  // JFIF and Adobe say how colour is coded
        keep_to(picture ? segment->end : segment->begin);
        done = segment->end;
    }
    keep_to(bytes.size());
    return out;
}

// WebP: RIFF of chunks of name, length and data, padded to even (developers.google.com/speed/webp/docs/riff_container).

std::optional<Claims> webp_claims(Bytes bytes)
{
    if (bytes.size() < 30) return std::nullopt;
    const std::string_view kind = text_at(bytes, 12, 4);
    if (kind == "VP8X") return Claims{little_endian(bytes, 24, 3) + 1, little_endian(bytes, 27, 3) + 1, 4, 4};
    if (kind == "VP8L") {
        const std::uint64_t word = little_endian(bytes, 21, 4);
        return Claims{(word & 0x3fff) + 1, (word >> 14 & 0x3fff) + 1, 4, 4};
    }
    if (kind == "VP8 ") return Claims{little_endian(bytes, 26, 2) & 0x3fff, little_endian(bytes, 28, 2) & 0x3fff, 4, 4};
    return std::nullopt;
}

/// Calls `with(name, data)` for each chunk of a copy, to change it.
template <typename With>
std::vector<std::byte> with_webp_chunks(Bytes bytes, const With& with)
{
    std::vector<std::byte> out(bytes.begin(), bytes.end());
    for (std::size_t i = 12; i + 8 < out.size();) {
        const std::size_t size = little_endian(out, i + 4, 4);
        with(std::span(out).subspan(i, 4), std::span(out).subspan(i + 8));
        i += 8 + size + size % 2;
    }
    return out;
}

bool is(std::span<std::byte> kind, std::string_view name)
{
    return std::memcmp(kind.data(), name.data(), 4) == 0;
}

void make_unknown(std::span<std::byte> kind)
{
    kind[0] = std::byte{'_'};  // readers pass over chunks they do not know
}

std::vector<std::byte> bare_webp(Bytes bytes)
{
    return with_webp_chunks(bytes, [](std::span<std::byte> kind, std::span<std::byte> data) {
        if (is(kind, "VP8X")) data[0] &= ~std::byte{0x2c};  // profile, EXIF, XMP
        if (is(kind, "ICCP") || is(kind, "EXIF") || is(kind, "XMP ")) make_unknown(kind);
    });
}

// EXR: 8 bytes of magic and version, then headers of attributes: name, type, length, data (openexr.com, file layout).

struct ExrHeader {
    std::int64_t width = 0;
    std::int64_t height = 0;
    std::uint64_t channels = 0;
    std::uint64_t tile_width = 0;  ///< 0: scan lines
    std::uint64_t tile_height = 0;
    std::uint64_t compression = 0;
};

std::int64_t signed_at(Bytes bytes, std::size_t at)
{
    return static_cast<std::int32_t>(static_cast<std::uint32_t>(little_endian(bytes, at, 4)));
}

void read_attribute(std::string_view name, Bytes data, ExrHeader& header)
{
    if (name == "dataWindow" && data.size() == 16) {
        header.width = signed_at(data, 8) - signed_at(data, 0) + 1;
        header.height = signed_at(data, 12) - signed_at(data, 4) + 1;
    }
    if (name == "tiles" && data.size() == 9) {
        header.tile_width = little_endian(data, 0, 4);
        header.tile_height = little_endian(data, 4, 4);
    }
    if (name == "compression" && data.size() == 1) header.compression = byte_at(data, 0);
    if (name == "channels")
        for (std::size_t i = 0; i < data.size() && data[i] != std::byte{0}; ++header.channels) {
            while (i < data.size() && data[i] != std::byte{0}) ++i;
            i += 1 + 16;  // type, linearity, sampling
        }
}

/// Reads one header from byte `i` and moves `i` past it; nothing when it is not within the file.
std::optional<ExrHeader> read_exr_header(Bytes bytes, std::size_t& i)
{
    ExrHeader header;
    const std::string_view text = text_at(bytes, 0, bytes.size());
    while (i < text.size() && text[i] != '\0') {
        const std::size_t name_end = text.find('\0', i);
        const std::size_t type_end =
            name_end == std::string_view::npos ? std::string_view::npos : text.find('\0', name_end + 1);
        if (type_end == std::string_view::npos || text.size() - type_end - 1 < 4) return std::nullopt;
        const std::size_t size = little_endian(bytes, type_end + 1, 4), data = type_end + 5;
        if (size > text.size() - data) return std::nullopt;
        read_attribute(text.substr(i, name_end - i), bytes.subspan(data, size), header);
        i = data + size;
    }
    if (i++ >= text.size()) return std::nullopt;
    return header;
}

std::uint64_t exr_chunks(const ExrHeader& header)
{
    const auto parts = [](std::uint64_t whole, std::uint64_t part) { return (whole + part - 1) / part; };
    const auto width = std::uint64_t(header.width), height = std::uint64_t(header.height);
    if (header.tile_width > 0 && header.tile_height > 0)
        return parts(width, header.tile_width) * parts(height, header.tile_height);
    constexpr std::array<std::uint64_t, 10> kLines{1, 1, 1, 16, 32, 16, 32, 32, 32, 256};  // by compression
    return parts(height, kLines[std::min<std::uint64_t>(header.compression, kLines.size() - 1)]);
}

/// The claims of the largest part. OpenEXR reserves gigabytes on the word of an attribute or of a table of chunks.
std::optional<Claims> exr_claims(Bytes bytes, const std::string& name)
{
    constexpr unsigned kDeep = 0x08, kMultiPart = 0x10;  // in the second byte of the version
    const Error early = bad(name, "the file ends early");
    if (bytes.size() < 9) throw early;
    if ((byte_at(bytes, 5) & kDeep) != 0) throw bad(name, "it is a deep EXR", "flatten it first");
    std::optional<Claims> claims;
    std::size_t i = 8;
    for (;;) {
        const std::size_t begin = i;
        const std::optional<ExrHeader> header = read_exr_header(bytes, i);
        if (!header) throw early;
        const bool more = (byte_at(bytes, 5) & kMultiPart) != 0;
        if (more && i == begin + 1) return claims;  // several headers end with an empty one
        if (header->width < 1 || header->height < 1)
            throw bad(name, fmt::format("it claims {}x{} pixels", header->width, header->height));
        const Claims own{std::uint64_t(header->width), std::uint64_t(header->height), header->channels,
                         4 * header->channels};
        // Each chunk has its place, of 8 bytes, in a table behind the header. Sides over 2^31 do not come so far.
        if (own.width <= 0x7fffffff && own.height <= 0x7fffffff && exr_chunks(*header) > bytes.size() / 8) throw early;
        if (!claims || own.width * own.height > claims->width * claims->height) claims = own;
        if (!more) return claims;
    }
}

}  // namespace

std::optional<Claims> read_claims(Bytes bytes, Format format, const std::string& name)
{
    switch (format) {
        case Format::png:
            return png_claims(bytes);
        case Format::jpeg:
            return jpeg_claims(bytes);
        case Format::webp:
            return webp_claims(bytes);
        case Format::exr:
            return exr_claims(bytes, name);
        case Format::hdr:
            break;
    }
    return std::nullopt;
}

void check_claims(const Claims& claims, std::size_t file_bytes, const Limits& limits, const std::string& name)
{
    const auto& [width, height, channels, pixel_bytes] = claims;
    if (width < 1 || height < 1) throw bad(name, fmt::format("it claims {}x{} pixels", width, height));
    if (width > limits.image_side || height > limits.image_side)
        throw bad(name, fmt::format("it claims {}x{} pixels; the limit is {} a side", width, height, limits.image_side),
                  "resize it");
    const std::uint64_t pixels = width * height;  // sides are at most 2^20, even without limits
    if (pixels > limits.image_pixels)
        throw bad(name, fmt::format("it claims {} pixels; the limit is {}", pixels, limits.image_pixels), "resize it");
    if (channels < 1 || channels > limits.image_channels)
        throw bad(name, fmt::format("it claims {} channels; the limit is {}", channels, limits.image_channels));
    const std::uint64_t decoded = pixels * pixel_bytes;
    if (decoded > kHarmlessBytes && decoded / limits.image_ratio > file_bytes)
        throw bad(name, fmt::format("its {} bytes claim to hold {} bytes of pixels", file_bytes, decoded));
}

bool is_whole(Bytes bytes, Format format)
{
    if (format == Format::jpeg) return jpeg_is_whole(bytes);
    // OpenImageIO leaves its reader by longjmp when it meets the end, past destructors, so it must not meet it.
    if (format == Format::png) return for_each_png_chunk(bytes, [](std::string_view, std::size_t, std::size_t) {});
    return true;
}

std::vector<std::byte> bare(Bytes bytes, Format format)
{
    if (format == Format::png) return bare_png(bytes);
    if (format == Format::jpeg) return bare_jpeg(bytes);
    if (format == Format::webp) return bare_webp(bytes);
    return {bytes.begin(), bytes.end()};
}

std::vector<std::byte> webp_without_alpha(Bytes bytes)
{
    return with_webp_chunks(bytes, [](std::span<std::byte> kind, std::span<std::byte> data) {
        if (is(kind, "VP8X")) data[0] &= ~std::byte{0x10};
        if (is(kind, "VP8L") && data.size() > 4) data[4] &= ~std::byte{0x10};  // bit 28 after the signature byte
        if (is(kind, "ALPH")) make_unknown(kind);
    });
}

}  // namespace etalon::codec
