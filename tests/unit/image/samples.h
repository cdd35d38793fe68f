#pragma once
// Small files as bytes: some in hexadecimal, made once with OpenImageIO, some built here to say exactly what a test
// wants.
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace etalon::samples {

using Bytes = std::vector<std::byte>;

inline Bytes from_hex(std::string_view hex)
{
    const auto digit = [](char c) { return c <= '9' ? c - '0' : c - 'a' + 10; };
    Bytes out;
    for (std::size_t i = 0; i + 1 < hex.size(); i += 2)
        out.push_back(std::byte(16 * digit(hex[i]) + digit(hex[i + 1])));
    return out;
}

/// JPEG of one channel, 8x8: texel i is 4 i, give or take what quality 90 loses.
inline Bytes grey_jpeg()
{
    return from_hex(
        "ffd8ffe000104a46494600010100000100010000ffe1001645786966000049492a0008000000000000000000ffdb004300030202"
        "0302020303030304030304050805050404050a070706080c0a0c0c0b0a0b0b0d0e12100d0e110e0b0b1016101113141515150c0f"
        "171816141812141514ffc0000b080008000801011100ffc4001f0000010501010101010100000000000000000102030405060708"
        "090a0bffc400b5100002010303020403050504040000017d01020300041105122131410613516107227114328191a1082342b1c1"
        "1552d1f02433627282090a161718191a25262728292a3435363738393a434445464748494a535455565758595a63646566676869"
        "6a737475767778797a838485868788898a92939495969798999aa2a3a4a5a6a7a8a9aab2b3b4b5b6b7b8b9bac2c3c4c5c6c7c8c9"
        "cad2d3d4d5d6d7d8d9dae1e2e3e4e5e6e7e8e9eaf1f2f3f4f5f6f7f8f9faffda0008010100003f008bc35ff04dbfb9ff0012bffc"
        "875fffd9");
}

/// Lossy WebP with an ALPH chunk, 16x16: colour (200, 100, 50) throughout, alpha of texel i is max(i, 32).
inline Bytes lossy_webp()
{
    return from_hex(
        "524946468c00000057454250565038580a000000100000000f00000f0000414c50481d00000001893244f43fa0260012061a1081"
        "fe45ddde111330010ee5141588fe0f0056503820480000007002009d012a1000100000000025a13001185100fc00fd00fe0003c8"
        "00feee7854fd5b4adba5966f13e58b94d067304fffc7f5608d0a2d7effc7f3fffb3e1e727e94ffece0000000");
}

/// EXR in tiles of 4x4, every value 0.5; `partial`: 5x5 texels, so that tiles stick out; else 4x4.
inline Bytes tiled_exr(bool partial)
{
    if (partial)
        return from_hex(
            "762f3101020200006361704461746500737472696e6700000000006368616e6e656c730063686c69737400370000004200010000"
            "0000000000010000000100000047000100000000000000010000000100000052000100000000000000010000000100000000636f"
            "6d7072657373696f6e00636f6d7072657373696f6e0001000000036461746157696e646f7700626f783269001000000000000000"
            "000000000400000004000000646973706c617957696e646f7700626f783269001000000000000000000000000400000004000000"
            "6c696e654f72646572006c696e654f72646572000100000000706978656c417370656374526174696f00666c6f61740004000000"
            "0000803f73637265656e57696e646f7743656e746572007632660008000000000000000000000073637265656e57696e646f7757"
            "6964746800666c6f617400040000000000803f74696c65730074696c656465736300090000000400000004000000000088010000"
            "00000000ac01000000000000ce01000000000000f0010000000000000000000000000000000000000000000010000000785e6368"
            "200dec4017200000f3582fb9010000000000000000000000000000000e000000785e636840801d486c008cb80bb9000000000100"
            "000000000000000000000e000000785e636840801d486c008cb80bb9010000000100000000000000000000000600000000380038"
            "0038");
    return from_hex(
        "762f3101020200006361704461746500737472696e6700000000006368616e6e656c730063686c69737400370000004200010000"
        "0000000000010000000100000047000100000000000000010000000100000052000100000000000000010000000100000000636f"
        "6d7072657373696f6e00636f6d7072657373696f6e0001000000036461746157696e646f7700626f783269001000000000000000"
        "000000000300000003000000646973706c617957696e646f7700626f783269001000000000000000000000000300000003000000"
        "6c696e654f72646572006c696e654f72646572000100000000706978656c417370656374526174696f00666c6f61740004000000"
        "0000803f73637265656e57696e646f7743656e746572007632660008000000000000000000000073637265656e57696e646f7757"
        "6964746800666c6f617400040000000000803f74696c65730074696c656465736300090000000400000004000000000070010000"
        "000000000000000000000000000000000000000010000000785e6368200dec4017200000f3582fb9");
}

inline void append_big_endian(Bytes& out, std::uint32_t value)
{
    for (const int shift : {24, 16, 8, 0}) out.push_back(std::byte(value >> shift & 0xff));
}

inline std::uint32_t crc32(std::span<const std::byte> bytes)
{
    std::uint32_t crc = 0xffffffffu;
    for (const std::byte b : bytes) {
        crc ^= std::to_integer<std::uint32_t>(b);
        for (int k = 0; k < 8; ++k) crc = crc & 1 ? crc >> 1 ^ 0xedb88320u : crc >> 1;
    }
    return ~crc;
}

inline void append_chunk(Bytes& png, std::string_view type, std::span<const std::byte> data)
{
    append_big_endian(png, std::uint32_t(data.size()));
    Bytes body;
    for (const char c : type) body.push_back(std::byte(c));
    body.insert(body.end(), data.begin(), data.end());
    png.insert(png.end(), body.begin(), body.end());
    append_big_endian(png, crc32(body));
}

/// A zlib stream of one stored block (so `data` holds less than 64 KiB).
inline Bytes stored(std::span<const std::byte> data)
{
    Bytes out = from_hex("780101");
    const auto size = std::uint32_t(data.size());
    for (const std::uint32_t length : {size, ~size})
        for (const int shift : {0, 8}) out.push_back(std::byte(length >> shift & 0xff));
    out.insert(out.end(), data.begin(), data.end());
    std::uint32_t a = 1, b = 0;
    for (const std::byte value : data) {
        a = (a + std::to_integer<std::uint32_t>(value)) % 65521;
        b = (b + a) % 65521;
    }
    append_big_endian(out, b << 16 | a);
    return out;
}

struct PngHeader {
    std::uint32_t width = 1;
    std::uint32_t height = 1;
    std::uint8_t bits = 8;
    std::uint8_t color = 6;  ///< 0 grey, 2 RGB, 3 palette, 4 grey and alpha, 6 RGBA
};

/// A PNG of any header over `rows`, each of which starts with its filter byte; `palette` may be empty.
inline Bytes png(const PngHeader& header, std::span<const std::byte> rows, std::span<const std::byte> palette = {})
{
    Bytes out = from_hex("89504e470d0a1a0a");
    Bytes ihdr;
    append_big_endian(ihdr, header.width);
    append_big_endian(ihdr, header.height);
    for (const std::uint8_t value : {header.bits, header.color, std::uint8_t{0}, std::uint8_t{0}, std::uint8_t{0}})
        ihdr.push_back(std::byte{value});
    append_chunk(out, "IHDR", ihdr);
    if (!palette.empty()) append_chunk(out, "PLTE", palette);
    append_chunk(out, "IDAT", stored(rows));
    append_chunk(out, "IEND", {});
    return out;
}

/// A lossless WebP of one colour: every prefix code has one symbol, so that no texel takes a bit.
inline Bytes flat_webp(std::uint32_t width, std::uint32_t height, std::array<std::uint8_t, 4> rgba)
{
    std::vector<bool> bits;
    const auto put = [&](std::uint32_t value, int count) {
        for (int i = 0; i < count; ++i) bits.push_back((value >> i & 1) != 0);
    };
    put(width - 1, 14);
    put(height - 1, 14);
    put(1, 1);  // has alpha
    put(0, 3);  // version
    put(0, 3);  // no transform, no colour cache, no meta prefix codes
    for (const std::size_t channel : {1u, 0u, 2u, 3u}) {
        put(1, 1);  // simple code
        put(0, 1);  // of one symbol
        put(1, 1);  // of 8 bits
        put(rgba[channel], 8);
    }
    put(1, 1);  // distances: one symbol of 1 bit, 0
    put(0, 3);
    Bytes data{std::byte{0x2f}};
    for (std::size_t i = 0; i < bits.size(); i += 8) {
        unsigned value = 0;
        for (std::size_t k = 0; k < 8 && i + k < bits.size(); ++k) value |= unsigned(bits[i + k]) << k;
        data.push_back(std::byte(value));
    }
    if (data.size() % 2 == 1) data.push_back(std::byte{0});
    Bytes out;
    const auto put_text = [&](std::string_view text) {
        for (const char c : text) out.push_back(std::byte(c));
    };
    const auto put_size = [&](std::size_t size) {
        for (const int shift : {0, 8, 16, 24}) out.push_back(std::byte(size >> shift & 0xff));
    };
    put_text("RIFF");
    put_size(12 + data.size());
    put_text("WEBPVP8L");
    put_size(data.size());
    out.insert(out.end(), data.begin(), data.end());
    return out;
}

/// Radiance HDR, 2x1, flat: (1, 0.5, 0.25) and black.
inline Bytes hdr()
{
    constexpr std::string_view kHeader = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n";
    Bytes out;
    for (const char c : kHeader) out.push_back(std::byte(c));
    for (const int value : {128, 64, 32, 129, 0, 0, 0, 0}) out.push_back(std::byte(value));
    return out;
}

}  // namespace etalon::samples
