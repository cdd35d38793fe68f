#include "engine/measure/reference_cache.h"

#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/files.h"
#include "tests/unit/measure/films.h"

namespace etalon {
namespace {

Film film_of(std::uint64_t samples, float value = 1)
{
    Film film = test::constant_film(32, 32, value);
    film.samples = samples;
    return film;
}

TEST(ReferenceCache, gives_back_what_was_kept_and_nothing_else)
{
    const test::TemporaryDirectory folder;
    const ReferenceCache cache(folder.path() / "deep" / "references");
    EXPECT_FALSE(cache.find("a"));
    ASSERT_TRUE(cache.keep("a", film_of(64, 0.5f)));
    ASSERT_TRUE(cache.keep("b", film_of(64, 2)));
    const auto a = cache.find("a");
    ASSERT_TRUE(a);
    EXPECT_EQ(a->mean, film_of(64, 0.5f).mean);
    EXPECT_EQ(a->variance, film_of(64).variance);
    EXPECT_EQ(a->samples, 64u);
    EXPECT_EQ(cache.find("b")->mean.front().x, 2);
    EXPECT_FALSE(cache.find("c"));
}

TEST(ReferenceCache, a_film_of_more_samples_stays)
{
    const test::TemporaryDirectory folder;
    const ReferenceCache cache(folder.path());
    ASSERT_TRUE(cache.keep("a", film_of(64)));
    ASSERT_TRUE(cache.keep("a", film_of(16)));
    EXPECT_EQ(cache.find("a")->samples, 64u);
    ASSERT_TRUE(cache.keep("a", film_of(256)));
    EXPECT_EQ(cache.find("a")->samples, 256u);
}

TEST(ReferenceCache, damage_and_another_keys_file_count_as_absent)
{
    const test::TemporaryDirectory folder;
    const ReferenceCache cache(folder.path());
    ASSERT_TRUE(cache.keep("a", film_of(64)));
    const auto file = std::filesystem::directory_iterator(folder.path())->path();
    ASSERT_TRUE(cache.keep("b", film_of(64)));
    for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
        if (entry.path() != file)
            std::filesystem::copy_file(entry.path(), file, std::filesystem::copy_options::overwrite_existing);
    EXPECT_FALSE(cache.find("a")) << "the file says that it is of b";
    std::filesystem::resize_file(file, 100);
    EXPECT_FALSE(cache.find("a"));
}

TEST(ReferenceCache, stays_within_its_size_and_lets_the_longest_unused_go)
{
    const test::TemporaryDirectory folder;
    ASSERT_TRUE(ReferenceCache(folder.path()).keep("a", film_of(64)));
    const auto bytes = std::filesystem::file_size(std::filesystem::directory_iterator(folder.path())->path());
    const ReferenceCache cache(folder.path(), 2 * bytes + bytes / 2);
    ASSERT_TRUE(cache.keep("b", film_of(64)));
    for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
        std::filesystem::last_write_time(entry.path(),
                                         std::filesystem::file_time_type::clock::now() - std::chrono::hours(1));
    ASSERT_TRUE(cache.find("a")) << "used now";
    ASSERT_TRUE(cache.keep("c", film_of(64)));
    EXPECT_TRUE(cache.find("a"));
    EXPECT_FALSE(cache.find("b"));
    EXPECT_TRUE(cache.find("c"));
}

TEST(ReferenceCache, a_folder_that_cannot_be_made_is_no_failure)
{
    const test::TemporaryDirectory folder;
    std::ofstream(folder.path() / "file") << "in the way";
    EXPECT_FALSE(ReferenceCache(folder.path() / "file" / "references").keep("a", film_of(64)));
    EXPECT_FALSE(ReferenceCache(folder.path() / "file" / "references").find("a"));
}

}  // namespace
}  // namespace etalon
