#include "engine/base/memory.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <exception>
#include <fstream>
#include <new>
#include <string>
#include <string_view>

#include "engine/base/error.h"

namespace etalon {
namespace {

std::uint64_t page_bytes()
{
    return static_cast<std::uint64_t>(sysconf(_SC_PAGE_SIZE));
}

/// The smallest limit in the files `name` of `group` ("/a/b") and the groups above it, below the mount point `mount`.
/// No std::filesystem::path: joining two frees twice when memory ends (libstdc++ 12).
std::uint64_t smallest_limit(const std::string& mount, std::string group, const std::string& name)
{
    std::uint64_t smallest = ~std::uint64_t{0};
    for (;;) {
        std::uint64_t limit = 0;
        // Absent where the group is seen from inside its own namespace; "max" where there is none.
        const std::string file = fmt::format("{}{}/{}", mount, group, name);
        if (std::ifstream(file) >> limit && limit > 0) smallest = std::min(smallest, limit);
        if (group.empty()) return smallest;
        const std::size_t end = group.rfind('/');
        group.resize(end == std::string::npos ? 0 : end);
    }
}

std::uint64_t control_group_limit()
{
    std::uint64_t smallest = ~std::uint64_t{0};
    std::ifstream groups("/proc/self/cgroup");  // lines "number:controllers:path"
    for (std::string line; std::getline(groups, line);) {
        const std::size_t first = line.find(':');
        const std::size_t second = first == std::string::npos ? first : line.find(':', first + 1);
        if (second == std::string::npos) continue;
        const std::string controllers = ',' + line.substr(first + 1, second - first - 1) + ',';
        const std::string group = line.substr(second + 1);
        if (controllers == ",,")
            smallest = std::min(smallest, smallest_limit("/sys/fs/cgroup", group, "memory.max"));
        else if (controllers.find(",memory,") != std::string::npos)
            smallest = std::min(smallest, smallest_limit("/sys/fs/cgroup/memory", group, "memory.limit_in_bytes"));
    }
    return smallest;
}

}  // namespace

std::uint64_t memory_of_machine()
{
    std::uint64_t bytes = static_cast<std::uint64_t>(sysconf(_SC_PHYS_PAGES)) * page_bytes();
    rlimit space{};
    if (getrlimit(RLIMIT_AS, &space) == 0 && space.rlim_cur != RLIM_INFINITY)
        bytes = std::min<std::uint64_t>(bytes, space.rlim_cur);
    return std::min(bytes, control_group_limit());
}

std::uint64_t address_space_left()
{
    rlimit space{};
    if (getrlimit(RLIMIT_AS, &space) != 0 || space.rlim_cur == RLIM_INFINITY) return ~std::uint64_t{0};
    std::uint64_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages;
    return space.rlim_cur - std::min<std::uint64_t>(space.rlim_cur, pages * page_bytes());
}

std::uint64_t memory_held()
{
    std::uint64_t mapped = 0, resident = 0;
    std::ifstream("/proc/self/statm") >> mapped >> resident;
    return resident * page_bytes();
}

std::uint64_t memory_peak()
{
    rusage used{};
    return getrusage(RUSAGE_SELF, &used) == 0 ? static_cast<std::uint64_t>(used.ru_maxrss) * 1024 : 0;
}

void exit_when_out_of_memory()
{
    static const std::terminate_handler otherwise = std::get_terminate();
    std::set_terminate([] {
        try {
            if (const std::exception_ptr fault = std::current_exception()) std::rethrow_exception(fault);
        } catch (const std::bad_alloc&) {
            constexpr std::string_view kText = "etalon: out of memory\n  mend: a smaller --size or scene takes less\n";
            static_cast<void>(!::write(STDERR_FILENO, kText.data(), kText.size()));  // nobody is left to be told
            ::_exit(static_cast<int>(Blame::machine));
        } catch (...) {}
        otherwise();
    });
}

}  // namespace etalon
