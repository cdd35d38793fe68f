// Stands between a program and the C library, linked into a test or preloaded into the program: makes system calls on
// files fail, fall short or be interrupted, or end the process with SIGKILL. What, the variable FAULTY_IO says: words
// such as "rename=kill" (before it), "rename=killed" (after it), "write=28" (fails with errno 28), "write=short" (a few
// bytes at a time, interrupted in between). "nameless" stands for opening a file without a name.
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/types.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdarg>
#include <cstdlib>
#include <cstring>
#include <string_view>

namespace {

std::string_view action(std::string_view call)
{
    const char* const words = std::getenv("FAULTY_IO");
    std::string_view rest = words == nullptr ? "" : words;
    while (!rest.empty()) {
        const std::size_t end = std::min(rest.find(' '), rest.size());
        const std::string_view word = rest.substr(0, end);
        if (word.size() > call.size() && word.starts_with(call) && word[call.size()] == '=')
            return word.substr(call.size() + 1);
        rest.remove_prefix(std::min(end + 1, rest.size()));
    }
    return {};
}

template <typename Function>
Function* next(const char* name)
{
    return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

template <typename Call>
auto faulty(std::string_view name, const Call& call) -> decltype(call())
{
    const std::string_view what = action(name);
    if (what == "kill") ::kill(::getpid(), SIGKILL);
    if (!what.empty() && what.front() >= '0' && what.front() <= '9') {
        errno = std::atoi(what.data());
        return -1;
    }
    const auto result = call();
    if (what == "killed") ::kill(::getpid(), SIGKILL);
    return result;
}

/// How many of `size` bytes a call may move now; 0: it is interrupted.
std::size_t allowed(std::string_view name, std::size_t size)
{
    static std::atomic<unsigned> calls{0};
    if (action(name) != "short") return size;
    const unsigned n = calls++;
    return n % 2 == 0 ? 0 : std::min<std::size_t>(size, 1 + n % 7);
}

int open_faulty(const char* name, const char* path, int flags, mode_t mode)
{
    const auto open = [&] { return next<int(const char*, int, ...)>(name)(path, flags, mode); };
    return (flags & O_TMPFILE) == O_TMPFILE ? faulty("nameless", open) : open();
}

}  // namespace

extern "C" {

int open(const char* path, int flags, ...)
{
    va_list arguments;
    va_start(arguments, flags);
    const auto mode = static_cast<mode_t>(va_arg(arguments, int));
    va_end(arguments);
    return open_faulty("open", path, flags, mode);
}

int open64(const char* path, int flags, ...)
{
    va_list arguments;
    va_start(arguments, flags);
    const auto mode = static_cast<mode_t>(va_arg(arguments, int));
    va_end(arguments);
    return open_faulty("open64", path, flags, mode);
}

ssize_t read(int file, void* data, std::size_t size)
{
    const std::size_t part = allowed("read", size);
    if (part == 0 && size > 0) {
        errno = EINTR;
        return -1;
    }
    return faulty("read", [&] { return next<ssize_t(int, void*, std::size_t)>("read")(file, data, part); });
}

ssize_t write(int file, const void* data, std::size_t size)
{
    const std::size_t part = allowed("write", size);
    if (part == 0 && size > 0) {
        errno = EINTR;
        return -1;
    }
    return faulty("write", [&] { return next<ssize_t(int, const void*, std::size_t)>("write")(file, data, part); });
}

int fsync(int file)
{
    return faulty("fsync", [&] { return next<int(int)>("fsync")(file); });
}

int linkat(int from_folder, const char* from, int to_folder, const char* to, int flags) noexcept
{
    return faulty("linkat", [&] {
        return next<int(int, const char*, int, const char*, int)>("linkat")(from_folder, from, to_folder, to, flags);
    });
}

int rename(const char* from, const char* to) noexcept
{
    return faulty("rename", [&] { return next<int(const char*, const char*)>("rename")(from, to); });
}

int flock(int file, int operation) noexcept
{
    return faulty("flock", [&] { return next<int(int, int)>("flock")(file, operation); });
}
}
