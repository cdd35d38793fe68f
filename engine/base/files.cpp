#include "engine/base/files.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <new>
#include <optional>
#include <random>
#include <system_error>
#include <utility>

#include "engine/base/error.h"

namespace etalon {
namespace {

namespace fs = std::filesystem;

class File {
 public:
    explicit File(int descriptor) : descriptor_(descriptor) {}
    ~File() { close(); }
    File(const File&) = delete;
    File& operator=(const File&) = delete;
    bool is_open() const { return descriptor_ >= 0; }
    int get() const { return descriptor_; }
    /// 0, or errno: a network disk may report a failed write only here.
    int close()
    {
        const int result = descriptor_ >= 0 ? ::close(std::exchange(descriptor_, -1)) : 0;
        return result == 0 ? 0 : errno;
    }

 private:
    int descriptor_;
};

std::string reason(int code)
{
    return std::error_code(code, std::generic_category()).message();
}

Blame blame_of(int code)
{
    switch (code) {
        case ENOSPC:
        case EDQUOT:
        case EFBIG:
        case EIO:
        case ENOMEM:
        case ENFILE:
        case EMFILE:
            return Blame::machine;
        default:
            return Blame::input;
    }
}

std::string mend_of(int code, const fs::path& path)
{
    const fs::path folder = path.parent_path();
    switch (code) {
        case ENOENT:
            return folder.empty() ? std::string{} : fmt::format("create the folder {} first", folder.string());
        case EACCES:
        case EPERM:
        case EROFS:
            return "choose a place that you may write to";
        case ENOSPC:
        case EDQUOT:
            return "free some space, or write to another disk";
        default:
            return {};
    }
}

Error cannot_read(const fs::path& path, int code)
{
    const std::string mend = code == ENOENT ? "check the spelling; relative paths start at the current folder" : "";
    return Error(blame_of(code), fmt::format("cannot read {}: {}", path.string(), reason(code)), mend);
}

Error cannot_write(const fs::path& path, int code)
{
    return Error(blame_of(code), fmt::format("cannot write {}: {}", path.string(), reason(code)), mend_of(code, path));
}

/// Reads to the end of the file, whose size `expected` is only a hint: files grow, and those of /proc say 0.
std::vector<std::byte> read_all(int descriptor, std::size_t expected, std::size_t max_bytes, const fs::path& path)
{
    std::vector<std::byte> bytes(expected + 1);
    std::size_t filled = 0;
    for (;;) {
        const ssize_t got = ::read(descriptor, bytes.data() + filled, bytes.size() - filled);
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) throw cannot_read(path, errno);
        if (got == 0) break;
        filled += static_cast<std::size_t>(got);
        if (filled > max_bytes)
            throw Error(Blame::input, fmt::format("cannot read {}: over {} bytes", path.string(), max_bytes));
        if (filled == bytes.size()) bytes.resize(2 * bytes.size());
    }
    bytes.resize(filled);
    return bytes;
}

/// Where `path` leads through symbolic links, the last of which may dangle.
fs::path follow_links(const fs::path& path)
{
    fs::path target = path;
    std::error_code ignored;
    for (int links = 0; fs::is_symlink(fs::symlink_status(target, ignored)); ++links) {
        if (links == 40) throw cannot_write(path, ELOOP);  // the kernel's own limit
        target = target.parent_path() / fs::read_symlink(target, ignored);
    }
    return target;
}

/// The permissions of the regular file at `target`, nothing when there is none; throws when it must not be replaced.
std::optional<mode_t> check_target(const fs::path& target, const fs::path& path)
{
    struct stat info {};
    if (::stat(target.c_str(), &info) != 0) {
        if (errno == ENOENT) return std::nullopt;
        throw cannot_write(path, errno);
    }
    if (S_ISDIR(info.st_mode)) throw cannot_write(path, EISDIR);
    if (!S_ISREG(info.st_mode))
        throw Error(Blame::input, fmt::format("cannot write {}: not a regular file", path.string()));
    if (::faccessat(AT_FDCWD, target.c_str(), W_OK, AT_EACCESS) != 0) throw cannot_write(path, errno);
    return info.st_mode & 07777;
}

/// A new file in the folder of `target`, removed again unless it has been renamed.
class Temporary {
 public:
    Temporary(const fs::path& target, const fs::path& named) : named_(named)
    {
        std::random_device random;
        // Short and without the target's name, which may already be as long as the file system allows; with its
        // extension, by which some writers choose the format.
        const std::string extension = target.extension().native().size() <= 16 ? target.extension().native() : "";
        for (int attempt = 0; attempt < 100; ++attempt) {
            path_ = target.parent_path() / fmt::format(".etalon-{:08x}{:08x}{}", random(), random(), extension);
            file_.emplace(::open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
            if (file_->is_open()) return;
            if (errno != EEXIST) break;
        }
        throw cannot_write(named_, errno);
    }
    ~Temporary()
    {
        if (!renamed_) ::unlink(path_.c_str());
    }
    Temporary(const Temporary&) = delete;
    Temporary& operator=(const Temporary&) = delete;

    const fs::path& path() const { return path_; }

    void write(std::span<const std::byte> bytes)
    {
        while (!bytes.empty()) {
            const ssize_t put = ::write(file_->get(), bytes.data(), bytes.size());
            if (put < 0 && errno == EINTR) continue;
            if (put < 0) throw cannot_write(named_, errno);
            bytes = bytes.subspan(static_cast<std::size_t>(put));
        }
    }

    void rename_to(const fs::path& target, std::optional<mode_t> mode)
    {
        if (mode && ::fchmod(file_->get(), *mode) != 0) throw cannot_write(named_, errno);
        // EINVAL: a file system without fsync, on which nothing more can be promised.
        if (::fsync(file_->get()) != 0 && errno != EINVAL) throw cannot_write(named_, errno);
        if (const int code = file_->close()) throw cannot_write(named_, code);
        if (::rename(path_.c_str(), target.c_str()) != 0) throw cannot_write(named_, errno);
        renamed_ = true;
        // The rename itself survives a power cut only once its folder is on disk; the data are safe either way.
        const fs::path folder = target.parent_path().empty() ? "." : target.parent_path();
        const File opened(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
        if (opened.is_open()) static_cast<void>(::fsync(opened.get()));
    }

 private:
    fs::path path_;
    fs::path named_;
    std::optional<File> file_;
    bool renamed_ = false;
};

}  // namespace

std::vector<std::byte> read_file(const fs::path& path, std::size_t max_bytes)
{
    // O_NONBLOCK: opening a pipe that nobody writes to must not wait for ever.
    const File file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
    if (!file.is_open()) throw cannot_read(path, errno);
    struct stat info {};
    if (::fstat(file.get(), &info) != 0) throw cannot_read(path, errno);
    if (S_ISDIR(info.st_mode)) throw cannot_read(path, EISDIR);
    if (!S_ISREG(info.st_mode))
        throw Error(Blame::input, fmt::format("cannot read {}: not a regular file", path.string()));
    const auto size = static_cast<std::uint64_t>(info.st_size);
    if (size > max_bytes)
        throw Error(Blame::input,
                    fmt::format("cannot read {}: {} bytes, over the limit of {}", path.string(), size, max_bytes));
    try {
        return read_all(file.get(), static_cast<std::size_t>(size), max_bytes, path);
    } catch (const std::bad_alloc&) {
        throw Error(Blame::machine, fmt::format("cannot read {}: no memory for its {} bytes", path.string(), size));
    }
}

void replace_file(const fs::path& path, const std::function<void(const fs::path&)>& write)
{
    const fs::path target = follow_links(path);
    const std::optional<mode_t> mode = check_target(target, path);
    Temporary temporary(target, path);
    write(temporary.path());
    temporary.rename_to(target, mode);
}

void replace_file(const fs::path& path, std::span<const std::byte> bytes)
{
    const fs::path target = follow_links(path);
    const std::optional<mode_t> mode = check_target(target, path);
    Temporary temporary(target, path);
    temporary.write(bytes);
    temporary.rename_to(target, mode);
}

void replace_file(const fs::path& path, std::string_view text)
{
    replace_file(path, std::as_bytes(std::span(text)));
}

}  // namespace etalon
