// Settings are chosen by what was measured, and only of the same scene, device and build.
#include "engine/measure/frontier_profile.h"

#include <gtest/gtest.h>

#include "engine/base/files.h"
#include "tests/support/files.h"

namespace etalon {
namespace {

FrontierProfile::Point point(int msaa, double seconds, double error)
{
    FrontierProfile::Point out{.seconds = seconds, .first_seconds = seconds + 1, .error = error};
    out.settings.renderer = Renderer::raster;
    out.settings.msaa = msaa;
    return out;
}

FrontierProfile three()
{
    return {.size = ivec2(10, 10), .points = {point(1, 0.1, 0.3), point(4, 0.2, 0.2), point(8, 0.8, 0.1)}};
}

TEST(FrontierProfile, picks_the_fastest_of_those_near_enough_and_the_nearest_of_those_fast_enough)
{
    const FrontierProfile profile = three();
    EXPECT_EQ(profile.within_error(0.25, {10, 10})->settings.msaa, 4);
    EXPECT_EQ(profile.within_error(0.5, {10, 10})->settings.msaa, 1);
    EXPECT_EQ(profile.within_error(0.05, {10, 10}), nullptr);
    EXPECT_EQ(profile.within_time(1.5, {10, 10})->settings.msaa, 4);
    EXPECT_EQ(profile.within_time(5, {10, 10})->settings.msaa, 8);
    EXPECT_EQ(profile.within_time(0.5, {10, 10}), nullptr);
    EXPECT_EQ(profile.most_accurate()->settings.msaa, 8);
    EXPECT_EQ(profile.fastest({10, 10})->settings.msaa, 1);
}

TEST(FrontierProfile, larger_pictures_take_longer_but_their_scene_does_not)
{
    const FrontierProfile profile = three();
    EXPECT_DOUBLE_EQ(profile.seconds(profile.points[2], {10, 10}), 1.8);
    EXPECT_DOUBLE_EQ(profile.seconds(profile.points[2], {20, 20}), 1 + 3.2);
    EXPECT_EQ(profile.within_time(1.9, {20, 20})->settings.msaa, 4);
}

TEST(FrontierProfile, without_points_has_no_answer)
{
    const FrontierProfile none;
    EXPECT_EQ(none.most_accurate(), nullptr);
    EXPECT_EQ(none.within_time(1e9, {1, 1}), nullptr);
}

TEST(ProfileStore, gives_back_what_was_kept_for_the_same_key_alone)
{
    const test::TemporaryDirectory folder;
    const ProfileStore store(folder.path() / "deep");
    EXPECT_FALSE(store.find("scene device build"));
    ASSERT_TRUE(store.keep("scene device build", three()));
    const auto found = store.find("scene device build");
    ASSERT_TRUE(found);
    EXPECT_EQ(found->size, ivec2(10, 10));
    ASSERT_EQ(found->points.size(), 3u);
    EXPECT_EQ(found->points[2].settings.msaa, 8);
    EXPECT_EQ(found->points[2].seconds, 0.8);
    EXPECT_EQ(found->points[2].first_seconds, 1.8);
    EXPECT_EQ(found->points[2].error, 0.1);
    EXPECT_FALSE(store.find("scene device another build"));  // it has expired
    EXPECT_FALSE(store.keep("empty", {}));
}

TEST(ProfileStore, takes_nothing_from_a_damaged_file)
{
    const test::TemporaryDirectory folder;
    const ProfileStore store(folder.path());
    ASSERT_TRUE(store.keep("k", three()));
    const std::filesystem::path file = std::filesystem::directory_iterator(folder.path())->path();
    for (const char* text :
         {"", "etalon-profile/1\nk\n10 10\n", "etalon-profile/1\nk\n0 10\n1 1 1 --msaa 4\n",
          "etalon-profile/1\nk\n10 10\n1 1 nan --msaa 4\n", "etalon-profile/1\nk\n10 10\n1 1\n",
          "etalon-profile/1\nk\n10 10\n1 1 1 --msaa 1000\n", "etalon-profile/1\nk\n10 10\n1 1 1 --no x\n"}) {
        replace_file(file, std::string(text));
        EXPECT_FALSE(store.find("k")) << text;
    }
}

TEST(ProfileStore, keeps_no_more_than_it_may)
{
    const test::TemporaryDirectory folder;
    const ProfileStore store(folder.path(), 2);
    for (const char* key : {"a", "b", "c", "d"}) ASSERT_TRUE(store.keep(key, three()));
    const std::filesystem::directory_iterator files(folder.path());
    EXPECT_EQ(std::distance(begin(files), end(files)), 2);
    EXPECT_TRUE(store.find("d"));
}

}  // namespace
}  // namespace etalon
