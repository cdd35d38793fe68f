#include "engine/base/files.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstring>
#include <ctime>
#include <fstream>
#include <random>
#include <string>

#include "engine/base/error.h"
#include "engine/base/parallel.h"
#include "tests/support/errors.h"
#include "tests/support/files.h"

namespace etalon {
namespace {

namespace fs = std::filesystem;
using test::message_of;
using test::TemporaryDirectory;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::string text_of(const fs::path& path)
{
    const std::vector<std::byte> bytes = read_file(path);
    return std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size());
}

void put(const fs::path& path, const std::string& text)
{
    std::ofstream(path) << text;
}

TEST(ReadFile, gives_every_byte)
{
    const TemporaryDirectory folder;
    std::string text;
    for (int i = 0; i < 300000; ++i) text += static_cast<char>(i * 7);
    put(folder / "a", text);
    EXPECT_EQ(text_of(folder / "a"), text);
    put(folder / "empty", "");
    EXPECT_THAT(read_file(folder / "empty"), IsEmpty());
}

TEST(ReadFile, reads_files_that_do_not_know_their_size)
{
    EXPECT_THAT(text_of("/proc/self/status"), HasSubstr("Pid:"));
}

TEST(ReadFile, refuses_what_is_no_regular_file_without_waiting)
{
    const TemporaryDirectory folder;
    ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
    EXPECT_THAT(message_of([&] { read_file(folder / "absent"); }), HasSubstr("absent: No such file"));
    EXPECT_THAT(message_of([&] { read_file(folder.path()); }), HasSubstr("Is a directory"));
    EXPECT_THAT(message_of([&] { read_file(folder / "pipe"); }), HasSubstr("not a regular file"));
    EXPECT_THAT(message_of([&] { read_file("/dev/zero"); }), HasSubstr("not a regular file"));
    EXPECT_THAT(message_of([&] { read_file(""); }), HasSubstr("No such file"));
}

TEST(ReadFile, refuses_files_over_the_limit_and_takes_those_at_it)
{
    const TemporaryDirectory folder;
    put(folder / "ten", "0123456789");
    EXPECT_EQ(read_file(folder / "ten", 10).size(), 10u);
    EXPECT_THAT(message_of([&] { read_file(folder / "ten", 9); }), HasSubstr("10 bytes, over the limit of 9"));
    EXPECT_THAT(message_of([&] { read_file("/proc/self/status", 9); }), HasSubstr("over 9 bytes"));
}

TEST(ReadFile, says_when_it_may_not_read)
{
    const TemporaryDirectory folder;
    put(folder / "secret", "x");
    fs::permissions(folder.path(), fs::perms::all);
    fs::permissions(folder / "secret", fs::perms::none);
    const test::Unprivileged nobody;
    EXPECT_THAT(message_of([&] { read_file(folder / "secret"); }), HasSubstr("Permission denied"));
}

TEST(ReplaceFile, makes_a_new_file_and_replaces_an_old_one)
{
    const TemporaryDirectory folder;
    replace_file(folder / "a.txt", std::string_view("one"));
    EXPECT_EQ(text_of(folder / "a.txt"), "one");
    replace_file(folder / "a.txt", std::string_view("two and more"));
    EXPECT_EQ(text_of(folder / "a.txt"), "two and more");
    replace_file(folder / "a.txt", std::span<const std::byte>{});
    EXPECT_EQ(text_of(folder / "a.txt"), "");
    EXPECT_THAT(folder.names(), ElementsAre("a.txt"));
}

TEST(ReplaceFile, a_full_disk_leaves_the_old_file_and_nothing_else)
{
    const TemporaryDirectory folder;
    put(folder / "a", "old");
    const std::string big(100000, 'x');
    {
        const test::FileSizeLimit limit(4096);
        EXPECT_THAT(message_of([&] { replace_file(folder / "a", std::string_view(big)); }, Blame::machine),
                    HasSubstr("cannot write"));
    }
    EXPECT_EQ(text_of(folder / "a"), "old");
    EXPECT_THAT(folder.names(), ElementsAre("a"));
}

TEST(ReplaceFile, names_the_folder_that_is_missing)
{
    const TemporaryDirectory folder;
    const std::string message = message_of([&] { replace_file(folder / "no/such/a.png", std::string_view("x")); });
    EXPECT_THAT(message, HasSubstr("No such file or directory"));
    EXPECT_THAT(message, HasSubstr("mend: create the folder " + (folder / "no/such").string()));
}

TEST(ReplaceFile, refuses_folders_devices_and_pipes)
{
    const TemporaryDirectory folder;
    ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
    EXPECT_THAT(message_of([&] { replace_file(folder.path(), std::string_view("x")); }), HasSubstr("Is a directory"));
    EXPECT_THAT(message_of([&] { replace_file(folder / "pipe", std::string_view("x")); }),
                HasSubstr("not a regular file"));
    EXPECT_THAT(message_of([&] { replace_file("/dev/full", std::string_view("x")); }), HasSubstr("not a regular file"));
    EXPECT_TRUE(fs::is_character_file("/dev/full"));
    EXPECT_THROW(replace_file("", std::string_view("x")), Error);
    EXPECT_THAT(folder.names(), ElementsAre("pipe"));
}

TEST(ReplaceFile, respects_folders_and_files_that_are_write_protected)
{
    const TemporaryDirectory folder;
    fs::create_directory(folder / "closed");
    put(folder / "closed/a", "old");
    fs::permissions(folder.path(), fs::perms::all);
    fs::permissions(folder / "closed",
                    fs::perms::owner_read | fs::perms::owner_exec | fs::perms::others_read | fs::perms::others_exec);
    fs::permissions(folder / "closed/a", fs::perms::others_read | fs::perms::owner_read);
    {
        const test::Unprivileged nobody;
        EXPECT_THAT(message_of([&] { replace_file(folder / "closed/new", std::string_view("x")); }),
                    HasSubstr("Permission denied"));
        EXPECT_THAT(message_of([&] { replace_file(folder / "closed/a", std::string_view("x")); }),
                    HasSubstr("mend: choose a place"));
    }
    EXPECT_EQ(text_of(folder / "closed/a"), "old");
    fs::permissions(folder / "closed", fs::perms::owner_all);
}

TEST(ReplaceFile, keeps_permissions_and_gives_new_files_those_of_the_umask)
{
    const TemporaryDirectory folder;
    put(folder / "a", "old");
    fs::permissions(folder / "a", fs::perms(0640));
    replace_file(folder / "a", std::string_view("new"));
    EXPECT_EQ(fs::status(folder / "a").permissions(), fs::perms(0640));

    const mode_t old_mask = ::umask(027);
    replace_file(folder / "b", std::string_view("new"));
    ::umask(old_mask);
    EXPECT_EQ(fs::status(folder / "b").permissions(), fs::perms(0640));
}

TEST(ReplaceFile, follows_links_and_keeps_them)
{
    const TemporaryDirectory folder;
    fs::create_directory(folder / "real");
    put(folder / "real/a", "old");
    fs::create_symlink("real/a", folder / "link");
    fs::create_symlink("link", folder / "link to link");
    replace_file(folder / "link to link", std::string_view("new"));
    EXPECT_TRUE(fs::is_symlink(folder / "link"));
    EXPECT_EQ(text_of(folder / "real/a"), "new");

    fs::create_symlink("real/b", folder / "dangling");
    replace_file(folder / "dangling", std::string_view("made"));
    EXPECT_EQ(text_of(folder / "real/b"), "made");

    fs::create_symlink("loop", folder / "loop");
    EXPECT_THAT(message_of([&] { replace_file(folder / "loop", std::string_view("x")); }), HasSubstr("symbolic links"));
}

TEST(ReplaceFile, takes_names_as_long_as_the_file_system_allows)
{
    const TemporaryDirectory folder;
    const std::string name = std::string(251, 'n') + ".png";
    replace_file(folder / name, std::string_view("x"));
    EXPECT_THAT(folder.names(), ElementsAre(name));
    EXPECT_THAT(message_of([&] { replace_file(folder / (name + "x"), std::string_view("x")); }),
                HasSubstr("name too long"));
}

TEST(ReplaceFile, sweeps_what_dead_writers_left_and_nothing_else)
{
    const TemporaryDirectory folder;
    put(folder / "a", "old");
    put(folder / "precious", "kept");
    put(folder / ".etalon-0123456789abcdef", "half a picture");
    put(folder / ".etalon-00000000deadbeef", "of one who lives");
    const int living = ::open((folder / ".etalon-00000000deadbeef").c_str(), O_WRONLY | O_CLOEXEC);
    ASSERT_EQ(::flock(living, LOCK_EX), 0);
    put(folder / ".etalon-0123456789ABCDEF", "not ours");
    put(folder / ".etalon-0123456789abcdef.png", "not ours");
    fs::create_symlink("precious", folder / ".etalon-000000000000link");
    fs::create_symlink("precious", folder / ".etalon-0000000000000001");
    ASSERT_EQ(::mkfifo((folder / ".etalon-0000000000000002").c_str(), 0600), 0);
    fs::create_directory(folder / ".etalon-0000000000000003");

    replace_file(folder / "a", std::string_view("new"));
    EXPECT_THAT(folder.names(),
                ElementsAre(".etalon-0000000000000001", ".etalon-0000000000000002", ".etalon-0000000000000003",
                            ".etalon-000000000000link", ".etalon-00000000deadbeef", ".etalon-0123456789ABCDEF",
                            ".etalon-0123456789abcdef.png", "a", "precious"));
    EXPECT_EQ(text_of(folder / "precious"), "kept");
    ::close(living);
}

/// Every byte is the same, so that one from elsewhere shows.
bool is_whole(const std::string& text, std::size_t size)
{
    return text.size() == size && text.find_first_not_of(text.front()) == std::string::npos;
}

TEST(ReplaceFile, killed_at_a_hundred_random_instants_leaves_the_old_file_or_the_new_one)
{
    constexpr std::size_t kSize = 300000;
    const TemporaryDirectory folder;
    put(folder / "a", std::string(kSize, 'a'));
    std::mt19937 random(11);
    for (int i = 0; i < 100; ++i) {
        const pid_t child = ::fork();
        ASSERT_GE(child, 0);
        if (child == 0) {
            const std::string b(kSize, 'b'), c(kSize, 'c');
            for (;;) {
                replace_file(folder / "a", std::string_view(b));
                replace_file(folder / "a", std::string_view(c));
            }
        }
        const timespec delay{0, long(random() % 4'000'000)};
        ::nanosleep(&delay, nullptr);
        ::kill(child, SIGKILL);
        int status = 0;
        ASSERT_EQ(::waitpid(child, &status, 0), child);
        ASSERT_TRUE(WIFSIGNALED(status)) << "it ended by itself";
        ASSERT_TRUE(is_whole(text_of(folder / "a"), kSize)) << "kill " << i;
    }
    replace_file(folder / "a", std::string_view("the next run"));
    EXPECT_THAT(folder.names(), ElementsAre("a"));
}

TEST(ReplaceFile, writers_of_one_file_at_once_never_show_half_of_it)
{
    constexpr std::size_t kSize = 100000;
    const TemporaryDirectory folder;
    put(folder / "a", std::string(kSize, 'a'));
    parallel_for(
        80,
        [&](std::size_t i) {
            replace_file(folder / "a", std::string_view(std::string(kSize, char('a' + i % 8))));
            EXPECT_TRUE(is_whole(text_of(folder / "a"), kSize));
        },
        8);
    EXPECT_THAT(folder.names(), ElementsAre("a"));
}

/// While it lives, a signal interrupts what waits every 100 us.
class SignalStorm {
 public:
    SignalStorm()
    {
        struct sigaction action {};
        action.sa_handler = [](int) {};  // and no SA_RESTART
        ::sigaction(SIGALRM, &action, &old_);
        const itimerval every{{0, 100}, {0, 100}};
        ::setitimer(ITIMER_REAL, &every, nullptr);
    }
    ~SignalStorm()
    {
        const itimerval never{};
        ::setitimer(ITIMER_REAL, &never, nullptr);
        ::sigaction(SIGALRM, &old_, nullptr);
    }
    SignalStorm(const SignalStorm&) = delete;
    SignalStorm& operator=(const SignalStorm&) = delete;

 private:
    struct sigaction old_ {};
};

TEST(ReplaceFile, and_reading_outlast_a_storm_of_signals)
{
    const TemporaryDirectory folder;
    const SignalStorm storm;
    for (int i = 0; i < 20; ++i) {
        const std::string text(std::size_t(1) << 20, char('a' + i));
        replace_file(folder / "a", std::string_view(text));
        ASSERT_EQ(text_of(folder / "a"), text);
    }
}

}  // namespace
}  // namespace etalon
