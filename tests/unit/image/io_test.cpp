#include "engine/image/io.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <random>

#include "engine/base/error.h"
#include "engine/base/files.h"
#include "engine/image/codec.h"
#include "engine/image/develop.h"
#include "tests/support/errors.h"
#include "tests/support/files.h"
#include "tests/support/nasty.h"
#include "tests/unit/image/samples.h"

namespace etalon {
namespace {

namespace fs = std::filesystem;
using samples::Bytes;
using test::message_of;
using test::TemporaryDirectory;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

template <typename T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b)
{
    return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

/// Fills with every kind of bit pattern: NaN with payloads, Inf, denormals.
template <typename T>
void fill(std::vector<T>& values, std::size_t count, std::mt19937& random)
{
    values.resize(count);
    std::vector<std::uint32_t> words(count * sizeof(T) / 4);
    for (std::uint32_t& word : words) word = std::uint32_t(random());
    std::memcpy(values.data(), words.data(), count * sizeof(T));
}

Film film_of_every_bit()
{
    Film film;
    film.width = 37;
    film.height = 21;
    std::mt19937 random(5);
    const std::size_t n = film.pixel_count();
    fill(film.mean, n, random);
    fill(film.variance, n, random);
    fill(film.alpha, n, random);
    fill(film.aovs.depth, n, random);
    fill(film.aovs.normal, n, random);
    fill(film.aovs.albedo, n, random);
    fill(film.aovs.emission, n, random);
    fill(film.aovs.object_id, n, random);
    fill(film.aovs.material_id, n, random);
    fill(film.aovs.uv, n, random);
    for (const auto& [why, value] : nasty::not_finite<float>()) film.mean[std::size_t(random() % n)].y = value;
    film.samples = ~std::uint64_t{0};
    film.nonfinite = 3;
    film.truncated = std::uint64_t{1} << 40;
    film.metadata = {{"scene", "a \"b\" c.glb"}, {"device", "llvmpipe → é"}, {"settings", "{\"spp\":\n4}"}};
    return film;
}

Film plain_film(int width, int height)
{
    Film film;
    film.width = width;
    film.height = height;
    film.mean.assign(film.pixel_count(), vec3(0.25f, 0.5f, 1));
    film.alpha.assign(film.pixel_count(), 1.0f);
    return film;
}

TEST(WriteFilm, round_trips_every_bit_of_every_channel)
{
    const TemporaryDirectory folder;
    const Film film = film_of_every_bit();
    write_film(film, folder / "a.exr");
    const Film back = read_film(folder / "a.exr");
    EXPECT_EQ(back.width, film.width);
    EXPECT_EQ(back.height, film.height);
    EXPECT_TRUE(same_bytes(back.mean, film.mean));
    EXPECT_TRUE(same_bytes(back.variance, film.variance));
    EXPECT_TRUE(same_bytes(back.alpha, film.alpha));
    EXPECT_TRUE(same_bytes(back.aovs.depth, film.aovs.depth));
    EXPECT_TRUE(same_bytes(back.aovs.normal, film.aovs.normal));
    EXPECT_TRUE(same_bytes(back.aovs.albedo, film.aovs.albedo));
    EXPECT_TRUE(same_bytes(back.aovs.emission, film.aovs.emission));
    EXPECT_TRUE(same_bytes(back.aovs.object_id, film.aovs.object_id));
    EXPECT_TRUE(same_bytes(back.aovs.material_id, film.aovs.material_id));
    EXPECT_TRUE(same_bytes(back.aovs.uv, film.aovs.uv));
    EXPECT_EQ(back.samples, film.samples);
    EXPECT_EQ(back.nonfinite, film.nonfinite);
    EXPECT_EQ(back.truncated, film.truncated);
    EXPECT_EQ(back.metadata, film.metadata);
    EXPECT_THAT(folder.names(), ElementsAre("a.exr"));
}

TEST(WriteFilm, leaves_out_what_the_film_has_not)
{
    const TemporaryDirectory folder;
    write_film(plain_film(3, 2), folder / "a.EXR");
    const Film back = read_film(folder / "a.EXR");
    EXPECT_THAT(back.variance, IsEmpty());
    EXPECT_TRUE(back.aovs.empty());
    EXPECT_THAT(back.aovs.object_id, IsEmpty());
    EXPECT_EQ(back.samples, 0u);
    EXPECT_THAT(back.metadata, IsEmpty());
    EXPECT_EQ(read_image(folder / "a.EXR").channels, 4);
}

TEST(WriteFilm, writes_the_same_bytes_for_the_same_film)
{
    const TemporaryDirectory folder;
    write_film(film_of_every_bit(), folder / "a.exr");
    write_film(film_of_every_bit(), folder / "b.exr");
    EXPECT_EQ(read_file(folder / "a.exr"), read_file(folder / "b.exr"));
    const Bytes bytes = read_file(folder / "a.exr");
    const std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    const std::size_t date = text.find(std::string("capDate\0string\0", 15));
    EXPECT_TRUE(date == std::string::npos || text.compare(date + 15, 4, std::string(4, '\0')) == 0)
        << "a date would make equal films differ tomorrow";
}

TEST(WriteFilm, takes_pictures_of_one_pixel_or_one_row)
{
    const TemporaryDirectory folder;
    for (const auto& [w, h] : {std::pair{1, 1}, {1, 300}, {300, 1}}) {
        write_film(plain_film(w, h), folder / "a.exr");
        const Film back = read_film(folder / "a.exr");
        EXPECT_EQ(back.width, w);
        EXPECT_EQ(back.height, h);
        EXPECT_EQ(back.mean.back(), vec3(0.25f, 0.5f, 1));
    }
}

TEST(WriteFilm, names_the_formats_there_are_when_the_extension_is_another)
{
    const Film film = plain_film(2, 2);
    EXPECT_THAT(message_of([&] { write_film(film, "a.jpg"); }), HasSubstr("use .exr"));
    EXPECT_THAT(message_of([&] { write_film(film, "a"); }), HasSubstr("no extension"));
    EXPECT_THAT(message_of([&] { write_film(film, "a.png"); }), HasSubstr("use the extension .exr"));
    EXPECT_THAT(message_of([&] { write_png(Image(2, 2, 3), {}, "a.exr"); }), HasSubstr("use the extension .png"));
    EXPECT_EQ(picture_format("x/y.Png"), PictureFormat::png);
    EXPECT_EQ(picture_format("x.png/y.exr"), PictureFormat::exr);
    EXPECT_THROW(picture_format("x.png/y"), Error);
    EXPECT_THROW(picture_format(".png"), Error) << "a hidden file without extension";
}

TEST(WriteFilm, a_failure_leaves_the_old_picture_and_no_temporary)
{
    const TemporaryDirectory folder;
    Film film = plain_film(200, 200);
    std::mt19937 random(6);
    fill(film.mean, film.pixel_count(), random);  // random bits do not compress under the limit
    write_film(plain_film(2, 2), folder / "a.exr");
    {
        const test::FileSizeLimit full_disk(10000);
        EXPECT_THAT(message_of([&] { write_film(film, folder / "a.exr"); }, Blame::machine), HasSubstr("a.exr"));
    }
    EXPECT_EQ(read_film(folder / "a.exr").width, 2);
    EXPECT_THAT(folder.names(), ElementsAre("a.exr"));

    fs::create_directory(folder / "dir.exr");
    EXPECT_THAT(message_of([&] { write_film(film, folder / "dir.exr"); }), HasSubstr("Is a directory"));
    EXPECT_THAT(message_of([&] { write_film(film, folder / "absent/a.exr"); }), HasSubstr("create the folder"));
    EXPECT_THAT(message_of([&] { write_png(Image(2, 2, 3), {}, folder / "absent/a.png"); }),
                HasSubstr("create the folder"));
    EXPECT_THAT(folder.names(), ElementsAre("a.exr", "dir.exr"));
}

TEST(ReadFilm, refuses_what_is_no_film)
{
    const TemporaryDirectory folder;
    replace_file(folder / "grey.png", samples::png({}, std::vector<std::byte>(5)));
    EXPECT_THAT(message_of([&] { read_film(folder / "grey.png"); }), HasSubstr("PNG is not accepted here"));
    EXPECT_THAT(message_of([&] { read_film(folder / "absent.exr"); }), HasSubstr("No such file"));
    EXPECT_THAT(message_of([&] { read_film(folder.path()); }), HasSubstr("Is a directory"));
    replace_file(folder / "empty.exr", std::string_view());
    EXPECT_THAT(message_of([&] { read_film(folder / "empty.exr"); }), HasSubstr("it is empty"));
}

TEST(ReadFilm, reads_the_references_of_another_renderer)
{
    const auto path = test::find_shared("reference/furnace/mean.exr");
    if (!path) GTEST_SKIP() << "no shared inputs";
    const Film film = read_film(*path);
    EXPECT_GT(film.width, 0);
    EXPECT_EQ(film.mean.size(), film.pixel_count());
    EXPECT_EQ(film.alpha.size(), film.pixel_count());
}

/// Overwrites the 4 numbers after `attribute` in an EXR header.
Bytes with_window(Bytes exr, const std::string& attribute, const std::array<std::int32_t, 4>& window)
{
    const std::string key = attribute + std::string("\0box2i\0\x10\0\0\0", 11);
    const std::string text(reinterpret_cast<const char*>(exr.data()), exr.size());
    const std::size_t at = text.find(key);
    EXPECT_NE(at, std::string::npos);
    std::memcpy(&exr[at + key.size()], window.data(), sizeof window);
    return exr;
}

TEST(ReadFilm, refuses_headers_that_claim_what_the_file_cannot_hold)
{
    const TemporaryDirectory folder;
    write_film(plain_film(4, 4), folder / "a.exr");
    const Bytes good = read_file(folder / "a.exr");
    const auto refused = [&](const Bytes& bytes) {
        replace_file(folder / "b.exr", bytes);
        return message_of([&] { read_film(folder / "b.exr"); });
    };
    const auto resized = [&](std::int32_t w, std::int32_t h) {
        return with_window(with_window(good, "dataWindow", {0, 0, w - 1, h - 1}), "displayWindow",
                           {0, 0, w - 1, h - 1});
    };
    EXPECT_THAT(refused(resized(40000, 4)), HasSubstr("the limit is 32768 a side"));
    refused(resized(32768, 32768));  // OpenEXR misses the table of its lines before we ask
    refused(resized(1 << 30, 1 << 30));
    refused(resized(0, 0));
    EXPECT_THAT(refused(with_window(good, "displayWindow", {0, 0, 7, 7})), HasSubstr("data window"));

    Bytes hungry = good;  // an attribute of 2 GiB
    const std::string text(reinterpret_cast<const char*>(good.data()), good.size());
    const std::size_t size_at = text.find(std::string("compression\0compression\0", 24)) + 24;
    std::fill_n(&hungry[size_at], 3, std::byte{0xff});
    hungry[size_at + 3] = std::byte{0x7f};
    EXPECT_THAT(refused(hungry), HasSubstr("the file ends early"));
}

TEST(ReadFilm, takes_tiles_only_where_they_fill_the_picture)
{
    const TemporaryDirectory folder;
    replace_file(folder / "whole.exr", samples::tiled_exr(false));
    EXPECT_EQ(read_film(folder / "whole.exr").mean.at(15), vec3(0.5f));
    replace_file(folder / "partial.exr", samples::tiled_exr(true));
    EXPECT_THAT(message_of([&] { read_film(folder / "partial.exr"); }), HasSubstr("scan lines instead of tiles"));
}

TEST(ReadFilm, a_count_that_is_none_is_an_error)
{
    const TemporaryDirectory folder;
    Film film = plain_film(2, 2);
    film.samples = 16;
    write_film(film, folder / "a.exr");
    Bytes bytes = read_file(folder / "a.exr");
    const std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    bytes[text.find("16", text.find("etalon:samples") + 20)] = std::byte{'x'};
    replace_file(folder / "a.exr", bytes);
    EXPECT_THAT(message_of([&] { read_film(folder / "a.exr"); }), HasSubstr("etalon:samples is \"x6\", not a count"));
}

TEST(ReadFilm, no_damage_of_a_byte_or_an_end_crashes_it)
{
    const TemporaryDirectory folder;
    write_film(plain_film(5, 3), folder / "a.exr");
    const Bytes good = read_file(folder / "a.exr");
    int refused = 0, read = 0;
    const auto attempt = [&](const Bytes& bytes) {
        std::ofstream(folder / "b.exr", std::ios::binary)
            .write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()));
        try {
            const Film film = read_film(folder / "b.exr");
            EXPECT_EQ(film.mean.size(), film.pixel_count());
            ++read;
        } catch (const Error&) {
            ++refused;
        }
    };
    for (std::size_t size = 0; size < good.size(); size += 7)
        attempt(Bytes(good.begin(), good.begin() + std::ptrdiff_t(size)));
    EXPECT_EQ(read, 0) << "every cut must be noticed";
    for (std::size_t i = 0; i < good.size(); ++i) {
        Bytes bad = good;
        bad[i] ^= std::byte(i % 3 == 0 ? 0x01 : i % 3 == 1 ? 0x80 : 0xff);
        attempt(bad);
    }
    EXPECT_GT(refused, 100);
}

TEST(ReadImage, reads_hdr_exr_and_decodes_srgb)
{
    const TemporaryDirectory folder;
    replace_file(folder / "a.hdr", samples::hdr());
    const Image hdr = read_image(folder / "a.hdr");
    EXPECT_THAT(hdr.values, ElementsAre(1, 0.5f, 0.25f, 0, 0, 0));

    const Bytes rows = samples::from_hex("00ff80007f");  // one RGBA texel after its filter byte
    replace_file(folder / "a.png", samples::png({}, rows));
    const Image png = read_image(folder / "a.png");
    EXPECT_EQ(png.channels, 4);
    EXPECT_THAT(png.values, ElementsAre(1, ::testing::FloatEq(float(linear_from_srgb(128.0 / 255))), 0, 127.0f / 255))
        << "not premultiplied";

    replace_file(folder / "a.jpg", samples::grey_jpeg());
    const Image jpg = read_image(folder / "a.jpg");
    EXPECT_EQ(jpg.channels, 3);
    EXPECT_NEAR(jpg.at(7, 7, 2), linear_from_srgb(252.0 / 255), 0.03);
}

TEST(ReadImage, finds_channels_by_name_in_any_order_and_spreads_grey)
{
    const TemporaryDirectory folder;
    const std::vector<float> values = {1, 2, 3, 4, 5, 6, 7, 8};
    const auto write = [&](std::vector<std::string> names) {
        std::vector<codec::Channel> channels;
        for (std::size_t c = 0; c < names.size(); ++c) channels.push_back({names[c], values.data() + c, names.size()});
        replace_file(folder / "a.exr", codec::encode_exr(2, 1, channels, {}));
        return folder / "a.exr";
    };
    EXPECT_THAT(read_image(write({"B", "G", "R"})).values, ElementsAre(3, 2, 1, 6, 5, 4));
    EXPECT_THAT(read_image(write({"A", "B", "G", "R"})).values, ElementsAre(4, 3, 2, 1, 8, 7, 6, 5));
    EXPECT_THAT(read_image(write({"Y"})).values, ElementsAre(1, 1, 1, 2, 2, 2));
    EXPECT_THAT(message_of([&] { read_image(write({"R", "G"})); }), HasSubstr("it has no channel B"));
    EXPECT_THAT(message_of([&] { read_film(write({"R", "G"})); }), HasSubstr("no channels R, G and B"));
}

TEST(ReplaceNonfinite, T14_mends_what_is_not_finite_and_counts_texels)
{
    Image image(3, 1, 3);
    image.values = {1, 2, 3, NAN, INFINITY, -INFINITY, -5, 4, INFINITY};
    EXPECT_EQ(replace_nonfinite(image), 2u);
    EXPECT_THAT(image.values, ElementsAre(1, 2, 3, 0, 4, 0, -5, 4, 4));
    EXPECT_EQ(replace_nonfinite(image), 0u);
    Image all(1, 1, 3);
    all.values = {NAN, INFINITY, NAN};
    EXPECT_EQ(replace_nonfinite(all), 1u);
    EXPECT_THAT(all.values, ElementsAre(0, 0, 0));
}

}  // namespace
}  // namespace etalon
