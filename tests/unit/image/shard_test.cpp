#include "engine/image/shard.h"

#include <gmock/gmock.h>

#include <cstring>
#include <functional>
#include <random>

#include "engine/image/io.h"
#include "tests/support/errors.h"
#include "tests/support/files.h"

namespace etalon {
namespace {

using ::testing::HasSubstr;

constexpr int kWidth = 5, kHeight = 11;

/// A film of noise with every kind of number in it.
Film noise()
{
    std::mt19937 random(5);
    std::uniform_real_distribution<float> uniform(0, 2);
    Film film;
    film.width = kWidth;
    film.height = kHeight;
    film.samples = 64;
    for (std::size_t i = 0; i < film.pixel_count(); ++i) {
        film.mean.emplace_back(uniform(random), uniform(random), uniform(random));
        film.variance.emplace_back(uniform(random), 0, uniform(random));
        film.alpha.push_back(uniform(random));
        film.aovs.depth.push_back(uniform(random));
        film.aovs.object_id.push_back(std::uint32_t(random()));
    }
    film.mean[3].x = std::numeric_limits<float>::quiet_NaN();
    film.metadata = {{"settings", "spp=64"}, {"device", "a drum"}};
    return film;
}

Film rows(const Film& whole, int first, int end)
{
    Film part = whole;
    part.height = end - first;
    const auto cut = [&](auto& list) {
        list.erase(list.begin() + end * kWidth, list.end());
        list.erase(list.begin(), list.begin() + first * kWidth);
    };
    cut(part.mean);
    cut(part.variance);
    cut(part.alpha);
    part.aovs = rows_of(whole.aovs, first, end, kWidth);
    return part;
}

/// Shards 1/3, 2/3 and 3/3, which lost 1, 2 and 3 samples.
std::vector<NamedFilm> three_shards()
{
    const Film whole = noise();
    std::vector<NamedFilm> shards;
    for (unsigned i = 1; i <= 3; ++i) {
        const int first = kHeight * int(i - 1) / 3;
        Film part = rows(whole, first, kHeight * int(i) / 3);
        part.nonfinite = i;
        part.metadata["error"] = "of part " + std::to_string(i);
        mark_shard(part, {.number = i, .count = 3, .first_row = first, .picture_height = kHeight, .scene = "abc"});
        shards.push_back({"part" + std::to_string(i), part});
    }
    return shards;
}

std::string refusal(const std::vector<NamedFilm>& shards)
{
    return test::message_of([&] { merge_shards(shards); });
}

TEST(Shards, any_order_gives_the_picture_back_to_the_bit)
{
    const Film whole = noise();
    std::vector<NamedFilm> shards = three_shards();
    std::swap(shards[0], shards[2]);
    const Film merged = merge_shards(shards);
    EXPECT_EQ(merged.height, kHeight);
    EXPECT_EQ(std::memcmp(merged.mean.data(), whole.mean.data(), whole.pixel_count() * sizeof(vec3)), 0);
    EXPECT_EQ(merged.variance, whole.variance);
    EXPECT_EQ(merged.alpha, whole.alpha);
    EXPECT_EQ(merged.aovs.depth, whole.aovs.depth);
    EXPECT_EQ(merged.aovs.object_id, whole.aovs.object_id);
    EXPECT_TRUE(merged.aovs.normal.empty());
    EXPECT_EQ(merged.metadata, whole.metadata);
    EXPECT_EQ(merged.samples, 64u);
    EXPECT_EQ(merged.nonfinite, 6u);
}

TEST(Shards, survive_being_written_and_read)
{
    const test::TemporaryDirectory folder;
    std::vector<NamedFilm> read;
    for (const NamedFilm& shard : three_shards()) {
        write_film(shard.film, folder / (shard.name + ".exr"));
        read.push_back({shard.name, read_film(folder / (shard.name + ".exr"))});
    }
    EXPECT_EQ(merge_shards(read).alpha, noise().alpha);
}

TEST(Shards, one_that_is_missing_is_named)
{
    std::vector<NamedFilm> shards = three_shards();
    shards.erase(shards.begin() + 1);
    EXPECT_THAT(refusal(shards), HasSubstr("missing: 2/3"));
    shards.erase(shards.begin());
    EXPECT_THAT(refusal(shards), HasSubstr("2 of 3 shards are missing: 1/3, 2/3"));
}

TEST(Shards, one_that_is_there_twice_is_refused)
{
    std::vector<NamedFilm> shards = three_shards();
    shards.push_back(shards[0]);
    shards.back().name = "copy";
    EXPECT_THAT(refusal(shards), HasSubstr("part1 and copy are both shard 1/3"));
}

TEST(Shards, a_single_changed_bit_is_found_wherever_it_is)
{
    const std::function<void(Film&)> damages[] = {
        [](Film& f) { f.mean[7].y = std::nextafter(f.mean[7].y, 9.0f); },
        [](Film& f) { f.variance[0].y = -0.0f; },
        [](Film& f) { f.alpha.back() = std::nextafter(f.alpha.back(), 9.0f); },
        [](Film& f) { f.aovs.object_id[2] ^= 1u << 31; },
        [](Film& f) { f.aovs.depth.clear(); },
        [](Film& f) { f.samples ^= 1; },
        [](Film& f) { f.nonfinite += 1; },
        [](Film& f) { f.metadata["device"] = "a harp"; },
        [](Film& f) { f.metadata["shard"] = "2/4"; },
        [](Film& f) { f.metadata["shard.rows"] = "4/11"; },
        [](Film& f) { f.metadata.erase("shard.check"); },
        [](Film& f) { f.metadata["more"] = ""; },
    };
    int which = 0;
    for (const auto& damage : damages) {
        std::vector<NamedFilm> shards = three_shards();
        damage(shards[1].film);
        EXPECT_THAT(refusal(shards), HasSubstr("part2 is damaged: its checksum does not match")) << which;
        ++which;
    }
}

TEST(Shards, parts_of_different_pictures_are_refused_with_what_differs)
{
    const auto of_another = [](const std::function<void(Film&)>& change) {
        std::vector<NamedFilm> shards = three_shards();
        change(shards[2].film);
        mark_shard(shards[2].film,
                   {.number = 3, .count = 3, .first_row = 7, .picture_height = kHeight, .scene = "abc"});
        return refusal(shards);
    };
    EXPECT_THAT(of_another([](Film& f) { f.metadata["settings"] = "spp=65"; }),
                HasSubstr("settings is \"spp=64\" and"));
    EXPECT_THAT(of_another([](Film& f) { f.samples = 65; }), HasSubstr("samples is \"64\" and \"65\""));
    EXPECT_THAT(of_another([](Film& f) { f.aovs = {}; }), HasSubstr("not parts of one picture"));
    std::vector<NamedFilm> shards = three_shards();
    mark_shard(shards[2].film, {.number = 3, .count = 3, .first_row = 7, .picture_height = kHeight, .scene = "xyz"});
    EXPECT_THAT(refusal(shards), HasSubstr("shard.scene is \"abc\" and \"xyz\""));
}

TEST(Shards, forged_places_do_no_harm)
{
    const ShardPlace places[] = {{.number = 0, .count = 3, .first_row = 0, .picture_height = kHeight},
                                 {.number = 4, .count = 3, .first_row = 0, .picture_height = kHeight},
                                 {.number = 1, .count = 1, .first_row = 1, .picture_height = kHeight},
                                 {.number = 1, .count = 1, .first_row = 0, .picture_height = kHeight + 1},
                                 {.number = 1, .count = 1, .first_row = -1, .picture_height = kHeight},
                                 {.number = 1, .count = 4'000'000'000u, .first_row = 0, .picture_height = kHeight},
                                 {.number = 1, .count = 1, .first_row = 0, .picture_height = 2'000'000'000}};
    for (const ShardPlace& place : places) {
        Film film = noise();
        mark_shard(film, place);
        EXPECT_FALSE(refusal({{"forged", film}}).empty());
    }
    EXPECT_THAT(refusal({{"whole", noise()}}), HasSubstr("whole is no shard"));
    EXPECT_FALSE(refusal({}).empty());
}

}  // namespace
}  // namespace etalon
