// replace_file over a disk on which everything goes wrong (faulty_io.cpp).
#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/files.h"
#include "tests/support/errors.h"
#include "tests/support/files.h"

namespace etalon {
namespace {

using test::message_of;
using test::TemporaryDirectory;
using ::testing::AnyOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// While it lives, calls go wrong as `words` say.
class Faults {
 public:
    explicit Faults(const std::string& words) { ::setenv("FAULTY_IO", words.c_str(), 1); }
    ~Faults() { ::unsetenv("FAULTY_IO"); }
    Faults(const Faults&) = delete;
    Faults& operator=(const Faults&) = delete;
};

std::string text_of(const std::filesystem::path& path)
{
    const std::vector<std::byte> bytes = read_file(path);
    return std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size());
}

/// Where the file system has no files without a name, a temporary has one from the beginning.
const std::vector<std::string> kDisks = {"", "nameless=" + std::to_string(EOPNOTSUPP) + " "};
const std::string kOld = "the old one";
const std::string kNew(10000, 'n');

/// Replaces `path` in a process of its own, which must die of it.
void replace_and_die(const std::filesystem::path& path, const std::string& words)
{
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
        const Faults faults(words);
        replace_file(path, std::string_view(kNew));
        ::_exit(0);
    }
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    ASSERT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL) << words;
}

TEST(ReplaceFileFaults, death_around_any_call_leaves_the_old_file_or_the_new_one_and_the_next_run_cleans_up)
{
    const TemporaryDirectory folder;
    for (const std::string& disk : kDisks)
        for (const std::string call : {"flock", "write", "fsync", "linkat", "rename"})
            for (const std::string when : {"kill", "killed"}) {
                if (!disk.empty() && call == "linkat") continue;  // it has its name already
                const std::string words = disk + call + "=" + when;
                SCOPED_TRACE(words);
                replace_file(folder / "a", std::string_view(kOld));
                replace_and_die(folder / "a", words);
                EXPECT_THAT(text_of(folder / "a"), AnyOf(kOld, kNew));
                replace_file(folder / "a", std::string_view("the next run"));
                EXPECT_THAT(folder.names(), ElementsAre("a"));
            }
}

TEST(ReplaceFileFaults, death_while_making_a_new_file_leaves_all_of_it_or_nothing)
{
    for (const std::string call : {"flock", "write", "fsync", "linkat"})
        for (const std::string when : {"kill", "killed"}) {
            const TemporaryDirectory folder;
            replace_and_die(folder / "a", call + "=" + when);
            if (call + when == "linkatkilled")
                EXPECT_EQ(text_of(folder / "a"), kNew);
            else
                EXPECT_THAT(folder.names(), ElementsAre());
        }
    for (const std::string call : {"flock", "write", "fsync", "rename"})
        for (const std::string when : {"kill", "killed"}) {
            const TemporaryDirectory folder;
            replace_and_die(folder / "a", kDisks[1] + call + "=" + when);
            if (call + when == "renamekilled") {
                EXPECT_EQ(text_of(folder / "a"), kNew);
            } else {
                EXPECT_FALSE(std::filesystem::exists(folder / "a"));
            }
            const Faults faults(kDisks[1]);
            replace_file(folder / "a", std::string_view("the next run"));
            EXPECT_THAT(folder.names(), ElementsAre("a"));
        }
}

TEST(ReplaceFileFaults, any_failing_call_is_said_and_keeps_the_old_file)
{
    struct Case {
        int code;
        Blame blame;
        const char* said;
    };
    const TemporaryDirectory folder;
    replace_file(folder / "a", std::string_view(kOld));
    for (const auto& [code, blame, said] : {Case{ENOSPC, Blame::machine, "free some space"},
                                            {EDQUOT, Blame::machine, "free some space"},
                                            {EIO, Blame::machine, "Input/output error"},
                                            {EFBIG, Blame::machine, "ulimit -f"},
                                            {EPERM, Blame::input, "choose a place"}})
        for (const std::string& disk : kDisks)
            for (const std::string call : {"write", "fsync", "linkat", "rename"}) {
                if (!disk.empty() && call == "linkat") continue;
                const std::string words = disk + call + "=" + std::to_string(code);
                SCOPED_TRACE(words);
                const Faults faults(words);
                const std::string message =
                    message_of([&] { replace_file(folder / "a", std::string_view(kNew)); }, blame);
                EXPECT_THAT(message, HasSubstr((folder / "a").string()));
                EXPECT_THAT(message, HasSubstr(said));
                EXPECT_EQ(text_of(folder / "a"), kOld);
                EXPECT_THAT(folder.names(), ElementsAre("a"));
            }
}

TEST(ReplaceFileFaults, disks_without_locks_or_fsync_are_written_to)
{
    const TemporaryDirectory folder;
    const std::string no_lock = "flock=" + std::to_string(ENOLCK), no_sync = "fsync=" + std::to_string(EINVAL);
    for (const std::string& disk : kDisks) {
        const Faults faults(disk + no_lock + " " + no_sync);
        for (const std::string& text : {kOld, kNew}) {
            replace_file(folder / "a", std::string_view(text));
            EXPECT_EQ(text_of(folder / "a"), text);
            EXPECT_THAT(folder.names(), ElementsAre("a"));
        }
    }
}

TEST(ReplaceFileFaults, a_temporary_that_is_locked_by_another_is_given_up)
{
    const TemporaryDirectory folder;
    const Faults faults(kDisks[1] + "flock=" + std::to_string(EWOULDBLOCK));
    EXPECT_THAT(message_of([&] { replace_file(folder / "a", std::string_view(kNew)); }), HasSubstr("cannot write"));
    EXPECT_THAT(folder.names(), ElementsAre());
}

TEST(ReplaceFileFaults, short_and_interrupted_calls_change_no_byte)
{
    const TemporaryDirectory folder;
    const Faults faults("read=short write=short");
    std::string text;
    for (int i = 0; i < 3000; ++i) text += static_cast<char>(i * 7);
    replace_file(folder / "a", std::string_view(text));
    EXPECT_EQ(text_of(folder / "a"), text);
}

TEST(ReplaceFileFaults, a_read_that_fails_is_said)
{
    const TemporaryDirectory folder;
    replace_file(folder / "a", std::string_view(kOld));
    const Faults faults("read=" + std::to_string(EIO));
    EXPECT_THAT(message_of([&] { read_file(folder / "a"); }, Blame::machine), HasSubstr("Input/output error"));
}

}  // namespace
}  // namespace etalon
