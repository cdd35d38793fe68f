#include "tests/support/files.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <string>

#include "engine/base/error.h"

namespace etalon::test {

namespace fs = std::filesystem;

TemporaryDirectory::TemporaryDirectory()
{
    std::string pattern = (fs::temp_directory_path() / "etalon-test-XXXXXX").string();
    assume(::mkdtemp(pattern.data()) != nullptr);
    path_ = pattern;
}

TemporaryDirectory::~TemporaryDirectory()
{
    std::error_code ignored;
    fs::remove_all(path_, ignored);
}

std::vector<std::string> TemporaryDirectory::names() const
{
    std::vector<std::string> out;
    for (const fs::directory_entry& entry : fs::directory_iterator(path_))
        out.push_back(entry.path().filename().string());
    std::ranges::sort(out);
    return out;
}

std::optional<fs::path> find_shared(std::string_view relative)
{
    const char* given = std::getenv("ETALON_SHARED");
    const fs::path root = given != nullptr ? fs::path(given) : fs::path(ETALON_SOURCE_DIR).parent_path() / "shared";
    std::error_code ignored;
    fs::path path = root / relative;
    if (!fs::exists(path, ignored)) return std::nullopt;
    return path;
}

FileSizeLimit::FileSizeLimit(std::uint64_t bytes)
{
    rlimit limit{};
    assume(::getrlimit(RLIMIT_FSIZE, &limit) == 0);
    old_limit_ = limit.rlim_cur;
    old_handler_ = std::signal(SIGXFSZ, SIG_IGN);  // else the limit kills instead of failing the write
    limit.rlim_cur = bytes;
    assume(::setrlimit(RLIMIT_FSIZE, &limit) == 0);
}

FileSizeLimit::~FileSizeLimit()
{
    rlimit limit{};
    ::getrlimit(RLIMIT_FSIZE, &limit);
    limit.rlim_cur = old_limit_;
    ::setrlimit(RLIMIT_FSIZE, &limit);
    std::signal(SIGXFSZ, old_handler_);
}

std::uint64_t address_space()
{
    std::uint64_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages;
    return pages * std::uint64_t(::sysconf(_SC_PAGESIZE));
}

void limit_memory(std::uint64_t more)
{
    const std::uint64_t bytes = address_space() + more;
    const rlimit limit{bytes, bytes};
    assume(::setrlimit(RLIMIT_AS, &limit) == 0);
}

Unprivileged::Unprivileged() : was_root_(::geteuid() == 0)
{
    constexpr uid_t kNobody = 65534;
    if (was_root_) assume(::seteuid(kNobody) == 0);
}

Unprivileged::~Unprivileged()
{
    if (was_root_) assume(::seteuid(0) == 0);
}

}  // namespace etalon::test
