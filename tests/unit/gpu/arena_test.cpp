// Arenas hand out pieces that do not overlap, and take them back whole.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "engine/gpu/memory_pool.h"

namespace etalon::gpu {
namespace {

Arena make_arena(std::uint64_t size)
{
    Arena arena;
    arena.size = size;
    arena.free.push_back({0, size});
    return arena;
}

TEST(Arena, gives_all_of_itself_and_no_more)
{
    Arena arena = make_arena(1024);
    std::uint64_t offset = 1;
    EXPECT_FALSE(arena.take(1025, 1, offset));
    EXPECT_TRUE(arena.take(1024, 256, offset));
    EXPECT_EQ(offset, 0u);
    EXPECT_FALSE(arena.take(1, 1, offset));
    arena.give_back(0, 1024);
    EXPECT_TRUE(arena.empty());
}

TEST(Arena, the_gap_before_an_aligned_piece_is_not_lost)
{
    Arena arena = make_arena(1024);
    std::uint64_t first = 0;
    std::uint64_t aligned = 0;
    std::uint64_t gap = 0;
    ASSERT_TRUE(arena.take(10, 1, first));
    ASSERT_TRUE(arena.take(100, 256, aligned));
    EXPECT_EQ(aligned, 256u);
    ASSERT_TRUE(arena.take(246, 1, gap));
    EXPECT_EQ(gap, 10u);
}

TEST(Arena, neighbours_that_come_back_in_any_order_are_one_again)
{
    const std::vector<std::vector<std::uint64_t>> orders = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2},
                                                            {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
    for (const auto& order : orders) {
        Arena arena = make_arena(300);
        std::uint64_t offset = 0;
        for (int i = 0; i < 3; ++i) ASSERT_TRUE(arena.take(100, 1, offset));
        for (const std::uint64_t piece : order) arena.give_back(100 * piece, 100);
        EXPECT_TRUE(arena.empty());
    }
}

TEST(Arena, random_use_never_overlaps_and_ends_empty)
{
    constexpr std::uint64_t kSize = 1 << 16;
    Arena arena = make_arena(kSize);
    std::map<std::uint64_t, std::uint64_t> taken;  // size by offset
    std::mt19937 random(7);
    for (int i = 0; i < 20'000; ++i) {
        if (random() % 2 == 0 && !taken.empty()) {
            const auto piece = std::next(taken.begin(), static_cast<long>(random() % taken.size()));
            arena.give_back(piece->first, piece->second);
            taken.erase(piece);
            continue;
        }
        const std::uint64_t size = 1 + random() % 2000;
        const std::uint64_t alignment = std::uint64_t{1} << random() % 9;
        std::uint64_t offset = 0;
        if (!arena.take(size, alignment, offset)) continue;
        ASSERT_EQ(offset % alignment, 0u);
        ASSERT_LE(offset + size, kSize);
        const auto next = taken.lower_bound(offset);
        if (next != taken.end()) {
            ASSERT_LE(offset + size, next->first);
        }
        if (next != taken.begin()) {
            ASSERT_LE(std::prev(next)->first + std::prev(next)->second, offset);
        }
        taken[offset] = size;
    }
    for (const auto& [offset, size] : taken) arena.give_back(offset, size);
    EXPECT_TRUE(arena.empty());
}

}  // namespace
}  // namespace etalon::gpu
