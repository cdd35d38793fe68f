#include "engine/base/error.h"
#include "engine/base/memory.h"

#include <gtest/gtest.h>

namespace etalon {
namespace {

TEST(Error, says_what_where_from_the_outside_in_and_how_to_mend)
{
    Error error(Blame::input, "cannot read chair.gltf", "export again");
    error.at("accessor 7").at("/meshes/2/primitives/0");
    EXPECT_EQ(error.message(),
              "etalon: cannot read chair.gltf\n  at /meshes/2/primitives/0\n  at accessor 7\n  mend: export again");
    EXPECT_STREQ(error.what(), "cannot read chair.gltf");
}

TEST(Error, leaves_out_what_it_does_not_know)
{
    EXPECT_EQ(Error(Blame::machine, "device lost").message(), "etalon: device lost");
}

TEST(Error, blame_is_the_exit_code)
{
    EXPECT_EQ(Error(Blame::input, "").exit_code(), 2);
    EXPECT_EQ(Error(Blame::machine, "").exit_code(), 3);
}

TEST(Error, a_hostile_name_neither_moves_the_cursor_nor_forges_a_line)
{
    const std::string message = Error(Blame::input, "cannot read \x1b[2Jx\netalon: all is well\x7f").message();
    EXPECT_EQ(message, "etalon: cannot read \\x1b[2Jx\n    etalon: all is well\\x7f");
}

TEST(Error, names_in_utf8_are_left_alone)
{
    EXPECT_EQ(Error(Blame::input, "Möbius → 椅子").message(), "etalon: Möbius → 椅子");
}

[[noreturn]] void run_out()
{
    throw std::bad_alloc();
}

struct Exhausted {
    ~Exhausted() { run_out(); }  // in a destructor, which ends the program
};

TEST(OutOfMemoryDeathTest, in_a_destructor_it_is_said_with_the_exit_code_of_the_machine)
{
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    const auto destroy = [] {
        exit_when_out_of_memory();
        const Exhausted exhausted;
    };
    EXPECT_EXIT(destroy(), ::testing::ExitedWithCode(3), "etalon: out of memory\n  mend: ");
}

TEST(AssumeDeathTest, a_broken_assumption_aborts_with_its_place)
{
    GTEST_FLAG_SET(death_test_style, "threadsafe");  // libraries have started threads before main
    assume(true);
    EXPECT_EXIT(assume(false), ::testing::KilledBySignal(SIGABRT),
                "assumption broken in .*\n  at .*error_test.cpp:[0-9]+");
}

}  // namespace
}  // namespace etalon
