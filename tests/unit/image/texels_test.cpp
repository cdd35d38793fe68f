#include <gmock/gmock.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <map>

#include "engine/base/error.h"
#include "engine/image/io.h"
#include "tests/support/files.h"
#include "tests/unit/image/samples.h"

namespace etalon {
namespace {

using samples::Bytes;
using samples::from_hex;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::string refusal(const Bytes& bytes)
{
    try {
        decode_texels(bytes, "texture 3");
    } catch (const Error& error) {
        EXPECT_EQ(error.blame(), Blame::input);
        EXPECT_THAT(error.message(), HasSubstr("cannot decode texture 3"));
        return error.message();
    }
    ADD_FAILURE() << "it was decoded";
    return {};
}

TEST(DecodeTexels, spreads_every_kind_of_png_to_rgba)
{
    EXPECT_THAT(decode_texels(samples::png({}, from_hex("000a141e28")), "rgba").bytes, ElementsAre(10, 20, 30, 40));
    EXPECT_THAT(decode_texels(samples::png({.color = 2}, from_hex("000a141e")), "rgb").bytes,
                ElementsAre(10, 20, 30, 255));
    EXPECT_THAT(decode_texels(samples::png({.color = 4}, from_hex("000a28")), "grey and alpha").bytes,
                ElementsAre(10, 10, 10, 40));
    EXPECT_THAT(decode_texels(samples::png({.color = 0}, from_hex("000a")), "grey").bytes,
                ElementsAre(10, 10, 10, 255));
    EXPECT_THAT(decode_texels(samples::png({.width = 2, .bits = 1, .color = 0}, from_hex("0040")), "one bit").bytes,
                ElementsAre(0, 0, 0, 255, 255, 255, 255, 255));
    EXPECT_THAT(
        decode_texels(samples::png({.bits = 8, .color = 3}, from_hex("0001"), from_hex("010203040506")), "palette")
            .bytes,
        ElementsAre(4, 5, 6, 255));
}

TEST(DecodeTexels, keeps_colour_under_zero_alpha)
{
    EXPECT_THAT(decode_texels(samples::png({}, from_hex("00c8643200")), "png").bytes, ElementsAre(200, 100, 50, 0));
    EXPECT_THAT(decode_texels(samples::flat_webp(1, 1, {200, 100, 50, 0}), "lossless webp").bytes,
                ElementsAre(200, 100, 50, 0));
    const Texels lossy = decode_texels(samples::lossy_webp(), "lossy webp");
    for (std::size_t i = 0; i < 256; ++i) {
        EXPECT_NEAR(lossy.bytes[4 * i], 200, 6);
        EXPECT_NEAR(lossy.bytes[4 * i + 1], 100, 6);
        EXPECT_NEAR(lossy.bytes[4 * i + 2], 50, 6);
        EXPECT_EQ(lossy.bytes[4 * i + 3], std::max<std::size_t>(i, 32));
    }
}

TEST(DecodeTexels, T15_keeps_sixteen_bits)
{
    const Texels texels = decode_texels(
        samples::png({.width = 2, .bits = 16, .color = 2}, from_hex("00000000018000fffffffe0100")), "wide");
    EXPECT_FALSE(texels.is_8_bit);
    EXPECT_THAT(texels.wide, ElementsAre(0, 1 / 65535.0f, 32768 / 65535.0f, 1, 1, 65534 / 65535.0f, 256 / 65535.0f, 1));
}

TEST(DecodeTexels, reads_jpeg)
{
    const Texels texels = decode_texels(samples::grey_jpeg(), "jpeg");
    EXPECT_EQ(texels.width, 8);
    EXPECT_EQ(texels.height, 8);
    for (std::size_t i = 0; i < 64; ++i) {
        EXPECT_NEAR(texels.bytes[4 * i], 4 * double(i), 6);
        EXPECT_EQ(texels.bytes[4 * i + 1], texels.bytes[4 * i]);
        EXPECT_EQ(texels.bytes[4 * i + 3], 255);
    }
}

TEST(DecodeTexels, knows_files_by_their_first_bytes_alone)
{
    EXPECT_THAT(refusal({}), HasSubstr("it is empty"));
    EXPECT_THAT(refusal(from_hex("00010203")), HasSubstr("of no format we know"));
    EXPECT_THAT(refusal(from_hex("89504e47")), HasSubstr("of no format we know"));
    EXPECT_THAT(refusal(from_hex("474946383961")), HasSubstr("convert it to one of: PNG, JPEG, WebP")) << "GIF";
    EXPECT_THAT(refusal(samples::hdr()), HasSubstr("Radiance HDR is not accepted here"));
    EXPECT_THAT(refusal(samples::tiled_exr(false)), HasSubstr("OpenEXR is not accepted here"));
}

TEST(DecodeTexels, T15_refuses_impossible_sizes_before_it_asks_for_memory)
{
    const Bytes nothing(1);
    const Bytes bomb = samples::png({.width = 1000000, .height = 1000000}, nothing);
    EXPECT_LE(bomb.size(), 80u);
    refusal(bomb);
    refusal(samples::png({.width = 0, .height = 0}, nothing));
    refusal(samples::png({.width = 0, .height = 5}, nothing));
    EXPECT_THAT(refusal(samples::png({.width = 40000, .height = 1}, nothing)), HasSubstr("the limit is 32768 a side"));
    EXPECT_THAT(refusal(samples::png({.width = 32768, .height = 32768}, nothing)), HasSubstr("the limit is 268435456"));
    EXPECT_THAT(refusal(samples::png({.width = 16000, .height = 16000}, nothing)),
                HasSubstr("claim to hold 1024000000 bytes"));
    refusal(samples::png({.width = 0xffffffffu, .height = 0xffffffffu}, nothing));
}

TEST(DecodeTexels, a_flat_picture_may_be_tiny_in_its_file)
{
    const Bytes bytes = samples::flat_webp(2000, 1000, {1, 2, 3, 255});
    EXPECT_LT(bytes.size(), 60u) << "8 MB in 60 bytes: over ten thousand to one, and harmless";
    const Texels texels = decode_texels(bytes, "flat");
    EXPECT_EQ(texels.bytes.size(), 8000000u);
    EXPECT_EQ(texels.bytes[7999998], 3);
}

TEST(DecodeTexelsDeathTest, says_when_memory_runs_out)
{
    if (test::address_space() > std::uint64_t{1} << 40) GTEST_SKIP() << "a sanitizer has reserved the address space";
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    const Bytes flat = samples::flat_webp(4096, 4096, {1, 2, 3, 4});  // 64 MiB of texels
    EXPECT_EXIT(
        {
            decode_texels(samples::flat_webp(1, 1, {1, 2, 3, 4}), "small");  // the decoders are loaded
            test::limit_memory(std::uint64_t{40} << 20);
            try {
                decode_texels(flat, "flat");
            } catch (const Error& error) {
                std::exit(std::string_view(error.what()) == "cannot decode flat: no memory for its pixels"
                              ? error.exit_code()
                              : 1);
            }
            std::exit(0);
        },
        ::testing::ExitedWithCode(3), "");
}

TEST(DecodeTexels, every_cut_is_noticed)
{
    const std::map<std::string, Bytes> whole = {{"png", samples::png({.width = 2, .height = 2}, Bytes(18))},
                                                {"jpeg", samples::grey_jpeg()},
                                                {"webp", samples::lossy_webp()}};
    for (const auto& [name, bytes] : whole) {
        decode_texels(bytes, name);
        for (std::size_t size = 0; size < bytes.size(); ++size)
            EXPECT_THROW(decode_texels(std::span(bytes).first(size), name), Error)
                << name << " of " << size << " bytes";
    }
}

TEST(DecodeTexels, no_damage_of_a_byte_crashes_it)
{
    const std::map<std::string, Bytes> whole = {
        {"png", samples::png({.width = 2, .height = 2}, Bytes(18))},
        {"palette", samples::png({.color = 3}, from_hex("0001"), from_hex("010203040506"))},
        {"jpeg", samples::grey_jpeg()},
        {"webp", samples::lossy_webp()},
        {"lossless", samples::flat_webp(3, 3, {9, 8, 7, 6})}};
    int refused = 0;
    for (const auto& [name, bytes] : whole)
        for (std::size_t i = 0; i < bytes.size(); ++i) {
            Bytes bad = bytes;
            bad[i] ^= std::byte(i % 3 == 0 ? 0x01 : i % 3 == 1 ? 0x90 : 0xff);
            try {
                const Texels texels = decode_texels(bad, name);
                ASSERT_EQ(texels.is_8_bit ? texels.bytes.size() : texels.wide.size(),
                          4 * std::size_t(texels.width) * std::size_t(texels.height));
            } catch (const Error&) {
                ++refused;
            }
        }
    EXPECT_GT(refused, 50);
}

/// The chunks of a PNG: type and data, in order.
std::vector<std::pair<std::string, std::string>> chunks_of(const Bytes& png)
{
    std::vector<std::pair<std::string, std::string>> chunks;
    const std::string text(reinterpret_cast<const char*>(png.data()), png.size());
    for (std::size_t i = 8; i + 12 <= text.size();) {
        std::size_t size = 0;
        for (std::size_t k = 0; k < 4; ++k) size = size << 8 | static_cast<unsigned char>(text[i + k]);
        chunks.emplace_back(text.substr(i + 4, 4), text.substr(i + 8, size));
        i += 12 + size;
    }
    return chunks;
}

TEST(EncodePng, writes_metadata_as_text_and_no_date)
{
    using namespace std::string_literals;
    const auto chunks = chunks_of(encode_png(Image(2, 2, 3), {{"etalon:scene", "box.glb"}, {"etalon:error", "0.01"}}));
    EXPECT_THAT(chunks, ::testing::Contains(std::pair("tEXt"s, "etalon:scene\0box.glb"s)));
    EXPECT_THAT(chunks, ::testing::Contains(std::pair("tEXt"s, "etalon:error\0"s + "0.01")));
    EXPECT_THAT(chunks, ::testing::Contains(::testing::Key("sRGB"s)));
    EXPECT_THAT(chunks, ::testing::Not(::testing::Contains(::testing::Key("tIME"s))));
}

TEST(EncodePng, keeps_true_unassociated_alpha)
{
    Image image(3, 1, 4);
    image.values = {1, 0.5f, 0, 0, 1, 0.5f, 0, 0.5f, 0, 0, 1, 1};
    EXPECT_THAT(decode_texels(encode_png(image, {}), "back").bytes,
                ElementsAre(255, 128, 0, 0, 255, 128, 0, 128, 0, 0, 255, 255));
}

TEST(EncodePng, T11_rounds_to_the_nearest_code_and_clamps_the_rest)
{
    Image image(256, 1, 3);
    for (int x = 0; x < 256; ++x)
        for (int c = 0; c < 3; ++c) image.at(x, 0, c) = (float(x) + 0.4f * float(c - 1)) / 255;
    const Texels back = decode_texels(encode_png(image, {}), "ramp");
    for (std::size_t x = 0; x < 256; ++x)
        for (std::size_t c = 0; c < 3; ++c) EXPECT_EQ(back.bytes[4 * x + c], x);

    Image nasty(2, 1, 3);
    nasty.values = {NAN, -1, 2, INFINITY, -INFINITY, 0.5f};
    EXPECT_THAT(decode_texels(encode_png(nasty, {}), "nasty").bytes, ElementsAre(0, 0, 255, 255, 255, 0, 128, 255));
}

}  // namespace
}  // namespace etalon
