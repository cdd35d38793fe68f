// What stands in front of OpenImageIO: hostile pictures are refused on their headers, in little memory, whatever end
// they come to.
#include <gmock/gmock.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstring>
#include <functional>
#include <map>

#include "engine/base/error.h"
#include "engine/image/claims.h"
#include "engine/image/codec.h"
#include "tests/support/errors.h"
#include "tests/support/files.h"
#include "tests/unit/image/samples.h"

namespace etalon::codec {
namespace {

using samples::Bytes;
using samples::from_hex;
using test::message_of;
using ::testing::HasSubstr;

constexpr std::array kEvery{Format::png, Format::jpeg, Format::webp, Format::hdr, Format::exr};

Picture decoded(std::span<const std::byte> bytes)
{
    return decode(bytes, kEvery, Limits(), "it");
}

/// MiB that `work` adds to the most memory a process has held; it is done in a process of its own.
long peak_growth(const std::function<void()>& work)
{
    const auto peak = [] {
        rusage usage{};
        ::getrusage(RUSAGE_SELF, &usage);
        return usage.ru_maxrss / 1024;
    };
    const pid_t child = ::fork();
    if (child == 0) {
        const long before = peak();
        work();
        ::_exit(static_cast<int>(std::min(peak() - before, 255L)));
    }
    int status = 0;
    EXPECT_EQ(::waitpid(child, &status, 0), child);
    EXPECT_TRUE(WIFEXITED(status));
    return WEXITSTATUS(status);
}

/// A zlib stream of `count` zeros: one literal, then copies of 258 (RFC 1951, fixed codes).
Bytes deflated_zeros(std::size_t count)
{
    std::vector<bool> bits;
    const auto put = [&](unsigned value, int size) {  // Huffman codes begin with their highest bit
        for (int i = size - 1; i >= 0; --i) bits.push_back((value >> i & 1) != 0);
    };
    put(0b110, 3);       // the last block, fixed codes
    put(0b00110000, 8);  // literal 0
    const std::size_t copies = (count - 1) / 258;
    for (std::size_t i = 0; i < copies; ++i) put(0b1100010100000, 13);  // length 258, distance 1
    for (std::size_t i = 1 + 258 * copies; i < count; ++i) put(0b00110000, 8);
    put(0, 7);  // end of block
    Bytes out = from_hex("7801");
    for (std::size_t i = 0; i < bits.size(); i += 8) {
        unsigned value = 0;
        for (std::size_t k = 0; k < 8 && i + k < bits.size(); ++k) value |= unsigned(bits[i + k]) << k;
        out.push_back(std::byte(value));
    }
    samples::append_big_endian(out, static_cast<std::uint32_t>(count % 65521 << 16 | 1));
    return out;
}

/// A PNG of one grey pixel with further chunks before it.
Bytes png_with(const std::vector<std::pair<std::string, Bytes>>& chunks)
{
    const Bytes plain = samples::png({.color = 0}, from_hex("007b"));
    constexpr std::ptrdiff_t kHeaderEnd = 8 + 25;
    Bytes out(plain.begin(), plain.begin() + kHeaderEnd);
    for (const auto& [name, data] : chunks) samples::append_chunk(out, name, data);
    out.insert(out.end(), plain.begin() + kHeaderEnd, plain.end());
    return out;
}

/// A progressive JPEG whose first scan is a few coefficients of nothing.
Bytes progressive_jpeg(std::uint16_t width, std::uint16_t height)
{
    Bytes out = from_hex("ffd8ffdb004300");
    out.insert(out.end(), 64, std::byte{1});
    for (const std::byte b : from_hex("ffc2001108")) out.push_back(b);
    for (const std::uint16_t side : {height, width})
        for (const int shift : {8, 0}) out.push_back(std::byte(side >> shift & 0xff));
    for (const std::byte b : from_hex("03011100021100031100")) out.push_back(b);
    for (const char* table : {"ffc400140001000000000000000000000000000000"
                              "00",
                              "ffc400141001000000000000000000000000000000"
                              "00"})
        for (const std::byte b : from_hex(table)) out.push_back(b);
    for (const std::byte b : from_hex("ffda000c03010002000300000000")) out.push_back(b);
    out.insert(out.end(), 50, std::byte{0});
    out.push_back(std::byte{0xff});
    out.push_back(std::byte{0xd9});
    return out;
}

Bytes exr_of(const std::vector<Channel>& channels, int width, int height)
{
    return encode_exr(width, height, channels, {});
}

TEST(ImageGuard, bombs_are_refused_on_their_headers_in_little_memory)
{
    if (test::address_space() > std::uint64_t{1} << 40) GTEST_SKIP() << "a sanitizer holds memory of its own";
    const Bytes four_megabytes(std::size_t{4} << 20);
    Bytes canvas = samples::flat_webp(4, 4, {1, 2, 3, 4});
    const Bytes extended = from_hex(
        "56503858"
        "0a000000"
        "10000000"
        "ffffff"
        "ffffff");
    canvas.insert(canvas.begin() + 12, extended.begin(), extended.end());
    Bytes hdr = samples::hdr();
    const std::string size = "-Y 32768 +X 32768\n";
    hdr.resize(hdr.size() - std::strlen("-Y 1 +X 2\n") - 8);
    for (const char c : size) hdr.push_back(std::byte(c));
    hdr.resize(hdr.size() + 200);
    const std::map<std::string, Bytes> bombs = {
        {"PNG of 65k x 65k in 4 MB", samples::png({.width = 65535, .height = 65535, .color = 0}, four_megabytes)},
        {"PNG of a million x a million", samples::png({.width = 1000000, .height = 1000000}, Bytes(1))},
        {"PNG at the limit of pixels", samples::png({.width = 32768, .height = 8192, .bits = 16}, Bytes(1))},
        {"JPEG of 65k x 65k", progressive_jpeg(65500, 65500)},
        {"JPEG at the limit of pixels", progressive_jpeg(32768, 8192)},
        {"WebP of 16k x 16k", samples::flat_webp(16383, 16383, {1, 2, 3, 4})},
        {"WebP with a canvas of 2^48", canvas},
        {"HDR of 32k x 32k", hdr},
    };
    for (const auto& bomb : bombs) {
        const Bytes& bytes = bomb.second;
        SCOPED_TRACE(bomb.first);
        EXPECT_THAT(message_of([&] { decoded(bytes); }), HasSubstr("claim"));
        EXPECT_LT(peak_growth([&] { EXPECT_THROW(decoded(bytes), Error); }), 64);
    }
}

TEST(ImageGuard, exr_headers_reserve_nothing_on_their_word)
{
    if (test::address_space() > std::uint64_t{1} << 40) GTEST_SKIP() << "a sanitizer holds memory of its own";
    const float values[2 * 2] = {1, 2, 3, 4};
    const Bytes good = exr_of({{"Y", values, 1}}, 2, 2);
    const std::string text(reinterpret_cast<const char*>(good.data()), good.size());
    for (const auto& [w, h] :
         {std::pair{1, 500'000'000}, {1 << 30, 1 << 30}, {0x7fffffff, 0x7fffffff}, {32768, 32768}}) {
        Bytes bad = good;
        for (const char* window : {"dataWindow", "displayWindow"}) {
            const std::size_t at = text.find(window + std::string("\0box2i\0\x10\0\0\0", 11));
            const std::int32_t corners[4] = {0, 0, w - 1, h - 1};
            std::memcpy(&bad.at(at + std::strlen(window) + 11), corners, sizeof corners);
        }
        EXPECT_LT(peak_growth([&] { EXPECT_THROW(decoded(bad), Error); }), 64) << w << "x" << h;
    }
}

TEST(ImageGuard, texts_and_profiles_are_not_even_unpacked)
{
    const Bytes zeros = deflated_zeros(7'900'000);
    ASSERT_LT(zeros.size(), 60'000u);
    std::vector<std::pair<std::string, Bytes>> texts;
    for (int i = 0; i < 60; ++i) {
        Bytes text = from_hex("6b0000");  // keyword k, deflated
        text.insert(text.end(), zeros.begin(), zeros.end());
        texts.emplace_back("zTXt", text);
    }
    const Bytes bomb = png_with(texts);
    EXPECT_THAT(decoded(bomb).codes8, ::testing::ElementsAre(0x7b));
    const bool sanitized = test::address_space() > std::uint64_t{1} << 40;
    EXPECT_TRUE(sanitized || peak_growth([&] { decoded(bomb); }) < 64);

    EXPECT_THAT(decoded(png_with({{"iCCP", from_hex("00112233")}, {"eXIf", from_hex("ffffffff")}})).codes8,
                ::testing::ElementsAre(0x7b));
    Bytes jpeg = samples::grey_jpeg();
    const Bytes segment = from_hex(
        "ffe1000a45786966000000ff"
        "ffe20006deadbeef"
        "fffe0004ffff");
    jpeg.insert(jpeg.begin() + 2, segment.begin(), segment.end());
    EXPECT_EQ(decoded(jpeg).codes8, decoded(samples::grey_jpeg()).codes8);
}

/// One picture of each format and depth.
std::map<std::string, Bytes> every_kind()
{
    std::map<std::string, Bytes> all = {{"JPEG", samples::grey_jpeg()},
                                        {"WebP, lossy", samples::lossy_webp()},
                                        {"WebP, lossless", samples::flat_webp(3, 3, {9, 8, 7, 6})},
                                        {"HDR", samples::hdr()},
                                        {"EXR, tiles", samples::tiled_exr(false)}};
    struct Kind {
        std::uint8_t color;
        std::vector<std::uint8_t> depths;
        std::size_t channels;
    };
    for (const auto& [color, depths, channels] :
         {Kind{0, {1, 2, 4, 8, 16}, 1}, {2, {8, 16}, 3}, {3, {1, 2, 4, 8}, 1}, {4, {8, 16}, 2}, {6, {8, 16}, 4}})
        for (const std::uint8_t bits : depths) {
            const std::size_t row = 1 + (3 * channels * bits + 7) / 8;
            const Bytes palette = color == 3 ? from_hex("010203040506") : Bytes{};
            all["PNG, colour type " + std::to_string(color) + ", " + std::to_string(bits) + " bits"] =
                samples::png({.width = 3, .height = 2, .bits = bits, .color = color}, Bytes(2 * row), palette);
        }
    const float values[2 * 2] = {1, 2, 3, 4};
    const std::uint32_t words[2 * 2] = {1, 2, 3, 0xffffffffu};
    all["EXR, float"] = exr_of({{"R", values, 1}, {"G", values, 1}, {"B", values, 1}}, 2, 2);
    all["EXR, float and integers"] = exr_of({{"Y", values, 1}, {"id", words, 1}}, 2, 2);
    return all;
}

TEST(ImageGuard, every_format_and_depth_is_read_and_no_cut_of_it)
{
    for (const auto& [name, bytes] : every_kind()) {
        SCOPED_TRACE(name);
        const Picture picture = decoded(bytes);
        const std::size_t values = picture.codes8.size() + picture.codes16.size() + picture.values.size();
        EXPECT_EQ(values, std::size_t(picture.width) * std::size_t(picture.height) * picture.channels.size());
        EXPECT_EQ(picture.codes16.empty(), name.find("16 bits") == std::string::npos);
        for (std::size_t size = 0; size < bytes.size(); ++size)
            EXPECT_THROW(decoded(std::span(bytes).first(size)), Error) << size << " bytes";
    }
}

TEST(ImageGuard, what_a_header_claims_is_what_the_reader_finds)
{
    for (const auto& [name, bytes] : every_kind()) {
        SCOPED_TRACE(name);
        const Picture picture = decoded(bytes);
        const std::optional<Claims> claims = read_claims(bytes, picture.format, name);
        ASSERT_EQ(claims.has_value(), picture.format != Format::hdr);
        if (!claims) continue;
        EXPECT_EQ(claims->width, std::uint64_t(picture.width));
        EXPECT_EQ(claims->height, std::uint64_t(picture.height));
        EXPECT_LE(claims->channels, 4u);
    }
}

TEST(ImageGuard, limits_are_those_that_are_given)
{
    const Bytes bytes = samples::flat_webp(300, 200, {1, 2, 3, 4});
    const auto refusal = [&](std::uint64_t Limits::*limit, std::uint64_t value) {
        Limits limits;
        limits.*limit = value;
        return message_of([&] { decode(bytes, kEvery, limits, "it"); });
    };
    EXPECT_THAT(refusal(&Limits::image_side, 299), HasSubstr("it claims 300x200 pixels; the limit is 299 a side"));
    EXPECT_THAT(refusal(&Limits::image_pixels, 59999), HasSubstr("it claims 60000 pixels; the limit is 59999"));
    EXPECT_THAT(refusal(&Limits::image_channels, 3), HasSubstr("4 channels; the limit is 3"));
    EXPECT_EQ(decode(bytes, kEvery, Limits(LimitLevel::none), "it").width, 300);
    EXPECT_EQ(decode(bytes, kEvery, Limits(LimitLevel::strict), "it").width, 300);
}

}  // namespace
}  // namespace etalon::codec
