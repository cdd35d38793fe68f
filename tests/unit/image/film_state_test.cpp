#include "engine/image/film_state.h"

#include <gtest/gtest.h>

#include "engine/base/files.h"
#include "engine/image/film.h"
#include "tests/support/errors.h"
#include "tests/support/files.h"

namespace etalon {
namespace {

FilmState some_state()
{
    return {.of = {{"seed", "7"}, {"scene", "a cat"}},
            .width = 2,
            .height = 3,
            .samples = 300,
            .nonfinite = 4,
            .truncated = 5,
            .sums = {0.1, -0.0, std::numeric_limits<double>::denorm_min()},
            .block_samples = 44,
            .block = {1.5f, std::numeric_limits<float>::quiet_NaN()}};
}

TEST(FilmState, comes_back_to_the_bit)
{
    const test::TemporaryDirectory folder;
    const FilmState state = some_state();
    write_film_state(state, folder / "state");
    const FilmState back = read_film_state(folder / "state");
    EXPECT_EQ(back.of, state.of);
    EXPECT_EQ(back.width, 2);
    EXPECT_EQ(back.height, 3);
    EXPECT_EQ(back.samples, 300u);
    EXPECT_EQ(back.nonfinite, 4u);
    EXPECT_EQ(back.truncated, 5u);
    EXPECT_EQ(back.block_samples, 44u);
    ASSERT_EQ(back.sums.size(), 3u);
    EXPECT_TRUE(std::signbit(back.sums[1]));
    EXPECT_EQ(back.sums[2], state.sums[2]);
    ASSERT_EQ(back.block.size(), 2u);
    EXPECT_TRUE(std::isnan(back.block[1]));
    EXPECT_EQ(folder.names(), std::vector<std::string>{"state"});
}

TEST(FilmState, every_bit_flip_and_every_cut_is_refused)
{
    const test::TemporaryDirectory folder;
    write_film_state(some_state(), folder / "state");
    const std::vector<std::byte> good = read_file(folder / "state");
    for (std::size_t i = 0; i < good.size(); ++i) {
        std::vector<std::byte> bad = good;
        bad[i] ^= std::byte{1} << (i % 8);
        replace_file(folder / "state", std::span<const std::byte>(bad));
        EXPECT_FALSE(test::message_of([&] { read_film_state(folder / "state"); }).empty()) << i;
        replace_file(folder / "state", std::span<const std::byte>(good).first(i));
        EXPECT_FALSE(test::message_of([&] { read_film_state(folder / "state"); }).empty()) << i;
    }
}

TEST(FilmState, says_what_differs)
{
    const FilmState state = some_state();
    EXPECT_EQ(difference(state, state.of), "");
    EXPECT_EQ(difference(state, {{"seed", "8"}, {"scene", "a cat"}}), "seed is 7 there and 8 here");
    EXPECT_EQ(difference(state, {{"seed", "7"}}), "scene is a cat there and nothing here");
    EXPECT_EQ(difference(state, {{"seed", "7"}, {"scene", "a cat"}, {"size", "1x1"}}), "size is missing there");
}

TEST(FilmState, fewer_samples_than_there_are_cannot_be_asked_for)
{
    const FilmState state = some_state();
    EXPECT_NO_THROW(check_samples({}, 1));
    EXPECT_NO_THROW(check_samples({.from = &state}, 300));
    EXPECT_THROW(check_samples({.from = &state}, 299), Error);
}

TEST(FilmSum, M4_goes_on_from_its_state_to_the_same_bits)
{
    const std::vector<float> a{0.1f, 0.7f, 3}, b{0.3f, 5, 1e-3f}, m2{1, 2, 0.3f}, alpha{0.4f};
    FilmSum once(1, 1), first(1, 1), second(1, 1);
    once.add_block(a, m2, alpha, 256);
    once.add_block(b, m2, alpha, 100);
    first.add_block(a, m2, alpha, 256);
    second.restore(first.state(), first.samples());
    second.add_block(b, m2, alpha, 100);
    EXPECT_EQ(once.state(), second.state());
    EXPECT_EQ(second.samples(), 356u);
    EXPECT_THROW(second.restore(std::vector<double>(8), 1), Error);
}

}  // namespace
}  // namespace etalon
