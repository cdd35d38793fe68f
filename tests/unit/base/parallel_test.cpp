#include "engine/base/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace etalon {
namespace {

TEST(ParallelFor, does_every_index_once_whatever_the_threads)
{
    for (const unsigned threads : {0u, 1u, 2u, 7u, 1000u})
        for (const std::size_t count : {0u, 1u, 2u, 3u, 64u, 10007u}) {
            std::vector<int> done(count, 0);
            parallel_for(
                count, [&](std::size_t i) { ++done[i]; }, threads);
            EXPECT_EQ(done, std::vector<int>(count, 1)) << threads << " threads, " << count << " indices";
        }
}

TEST(ParallelFor, really_uses_the_threads_it_is_given)
{
    // Both bodies wait for each other: on one thread this would never end, were it not for the count of tries.
    std::atomic<int> arrived = 0;
    std::atomic<bool> met = false;
    parallel_for(
        2,
        [&](std::size_t) {
            ++arrived;
            for (int tries = 0; tries < 5000 && arrived < 2; ++tries)
                std::this_thread::sleep_for(std::chrono::milliseconds(1));
            if (arrived == 2) met = true;
        },
        2);
    EXPECT_TRUE(met);
}

TEST(ParallelFor, throws_the_failure_of_the_lowest_index_every_time)
{
    for (int run = 0; run < 50; ++run) {
        std::vector<std::atomic<int>> done(1000);
        try {
            parallel_for(
                1000,
                [&](std::size_t i) {
                    ++done[i];
                    if (i % 100 == 37) throw std::runtime_error(std::to_string(i));
                },
                4);
            FAIL() << "nothing was thrown";
        } catch (const std::runtime_error& error) {
            EXPECT_STREQ(error.what(), "37");
        }
        for (std::size_t i = 0; i < 37; ++i) EXPECT_EQ(done[i], 1) << "index " << i << " lies below the failure";
    }
}

TEST(ParallelFor, nested_calls_stay_on_their_thread)
{
    std::vector<std::set<std::thread::id>> ids(8);
    parallel_for(
        8,
        [&](std::size_t i) {
            parallel_for(
                100, [&](std::size_t) { ids[i].insert(std::this_thread::get_id()); }, 4);
        },
        4);
    for (const auto& seen : ids) EXPECT_EQ(seen.size(), 1u);
}

TEST(ParallelFor, may_be_called_again_after_a_failure)
{
    EXPECT_THROW(parallel_for(
                     10, [](std::size_t) { throw 1; }, 3),
                 int);
    std::atomic<int> sum = 0;
    parallel_for(
        10, [&](std::size_t i) { sum += int(i); }, 3);
    EXPECT_EQ(sum, 45);
}

}  // namespace
}  // namespace etalon
