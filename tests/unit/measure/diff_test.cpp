#include "engine/measure/diff.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "engine/base/error.h"
#include "engine/image/develop.h"
#include "engine/image/io.h"
#include "films.h"

namespace etalon {
namespace {

using ::testing::HasSubstr;

class Diff : public ::testing::Test {
 protected:
    std::filesystem::path file(const std::string& name) const { return folder_ / name; }
    void SetUp() override
    {
        folder_ = std::filesystem::temp_directory_path() /
                  ("etalon-diff-" + std::to_string(getpid()) +
                   std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()));
        std::filesystem::create_directories(folder_);
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }

 private:
    std::filesystem::path folder_;
};

TEST_F(Diff, films_with_error_are_tested_by_statistics)
{
    write_film(test::noisy_film(32, 32, 64, 1), file("a.exr"));
    write_film(test::noisy_film(32, 32, 64, 2), file("b.exr"));
    Film shifted = test::noisy_film(32, 32, 64, 3);
    for (vec3& pixel : shifted.mean) pixel *= 1.05f;
    write_film(shifted, file("c.exr"));
    EXPECT_EQ(diff_files(file("a.exr"), file("b.exr")).comparison.verdict, Verdict::indistinguishable);
    const FileDiff found = diff_files(file("a.exr"), file("c.exr"));
    EXPECT_EQ(found.comparison.verdict, Verdict::different);
    EXPECT_THAT(diff_table(found), HasSubstr("different"));
    EXPECT_THAT(diff_json(found, "a", "c"), HasSubstr("\"verdict\": \"different\""));
}

TEST_F(Diff, pictures_without_error_must_be_equal_or_within_a_budget)
{
    Film film = test::noisy_film(32, 32, 64, 1);
    write_png(develop(film, {}), {}, file("a.png"));
    film.mean[5] *= 0.5f;
    write_png(develop(film, {}), {}, file("b.png"));
    EXPECT_EQ(diff_files(file("a.png"), file("a.png")).comparison.verdict, Verdict::indistinguishable);
    EXPECT_EQ(diff_files(file("a.png"), file("b.png")).comparison.verdict, Verdict::different);
    EXPECT_EQ(diff_files(file("a.png"), file("b.png"), {.budgets = {.psnr = 30.0}}).comparison.verdict,
              Verdict::within_budget);
}

TEST_F(Diff, a_difference_of_alpha_alone_is_found)
{
    Film film = test::constant_film(8, 8, 0);
    film.variance.clear();
    write_png(develop(film, {}), {}, file("a.png"));
    film.alpha[3] = 0;
    write_png(develop(film, {}), {}, file("b.png"));
    const FileDiff found = diff_files(file("a.png"), file("b.png"));
    EXPECT_EQ(found.comparison.verdict, Verdict::different);
    EXPECT_FALSE(found.comparison.metrics.identical);
    EXPECT_THAT(diff_table(found), HasSubstr("alpha"));
}

TEST_F(Diff, errors_name_the_file)
{
    write_film(test::constant_film(8, 8, 1), file("a.exr"));
    write_film(test::constant_film(8, 9, 1), file("b.exr"));
    for (const char* other : {"b.exr", "missing.exr", "missing.png"}) {
        try {
            diff_files(file("a.exr"), file(other));
            FAIL() << other;
        } catch (const Error& error) {
            EXPECT_EQ(error.exit_code(), 2);
            EXPECT_THAT(error.message(), HasSubstr(other));
        }
    }
}

}  // namespace
}  // namespace etalon
