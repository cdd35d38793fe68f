#include "engine/base/files.h"

#include <dirent.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <memory>
#include <new>
#include <optional>
#include <random>
#include <system_error>
#include <utility>

#include "engine/base/error.h"

namespace etalon {
namespace {

namespace fs = std::filesystem;

/// Calls again what a signal interrupted. Network disks interrupt even the calls that local ones never do.
template <typename Call>
auto uninterrupted(const Call& call)
{
    auto result = call();
    while (result < 0 && errno == EINTR) result = call();
    return result;
}

class File {
 public:
    explicit File(int descriptor) : descriptor_(descriptor) {}
    ~File()
    {
        if (descriptor_ >= 0) ::close(descriptor_);
    }
    File(File&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}
    File& operator=(File&& other) noexcept
    {
        std::swap(descriptor_, other.descriptor_);
        return *this;
    }
    static File open(const fs::path& path, int flags, mode_t mode = 0)
    {
        return File(uninterrupted([&] { return ::open(path.c_str(), flags | O_CLOEXEC, mode); }));
    }
    bool is_open() const { return descriptor_ >= 0; }
    int get() const { return descriptor_; }

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
        case ESTALE:
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
        case EFBIG:
            return "raise the limit on the size of files (ulimit -f), or write to another disk";
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
        const ssize_t got =
            uninterrupted([&] { return ::read(descriptor, bytes.data() + filled, bytes.size() - filled); });
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

constexpr std::string_view kTemporaryPrefix = ".etalon-";
constexpr std::size_t kTemporaryDigits = 16;

bool is_temporary(std::string_view name)
{
    return name.size() == kTemporaryPrefix.size() + kTemporaryDigits && name.starts_with(kTemporaryPrefix) &&
           name.find_first_not_of("0123456789abcdef", kTemporaryPrefix.size()) == std::string_view::npos;
}

/// A name that no process has used before or will use again.
fs::path temporary_in(const fs::path& folder)
{
    std::random_device random;
    return folder / fmt::format("{}{:08x}{:08x}", kTemporaryPrefix, random(), random());
}

/// Whoever writes a temporary holds this lock as long as the temporary has its name; the kernel lets go of it when the
/// process dies.
bool lock(const File& file)
{
    return uninterrupted([&] { return ::flock(file.get(), LOCK_EX | LOCK_NB); }) == 0;
}

/// Removes the temporaries in `folder` whose writers have died. A living one between our opening and our unlinking
/// loses nothing: either it holds the lock, or it has given up the name, which nobody will use again.
void sweep(const fs::path& folder)
{
    // Not std::filesystem's iterator: out of memory, it ends the program.
    const std::unique_ptr<DIR, int (*)(DIR*)> opened(::opendir(folder.c_str()), ::closedir);
    while (const dirent* const entry = opened ? ::readdir(opened.get()) : nullptr) {
        if (!is_temporary(entry->d_name)) continue;
        const fs::path path = folder / entry->d_name;
        const File file = File::open(path, O_RDWR | O_NOFOLLOW | O_NONBLOCK);
        struct stat info {};
        if (file.is_open() && ::fstat(file.get(), &info) == 0 && S_ISREG(info.st_mode) && lock(file))
            ::unlink(path.c_str());
    }
}

/// New content on its way to a name. It has none of its own where the file system can do without, so that it vanishes
/// with its process.
class Replacement {
 public:
    Replacement(const fs::path& target, const fs::path& named)
        : target_(target),
          folder_(target.parent_path().empty() ? fs::path(".") : target.parent_path()),
          named_(named),
          file_(File::open(folder_, O_WRONLY | O_TMPFILE, 0666))
    {
        // Without /proc a nameless file could never be given a name.
        if (!file_.is_open() || ::access(link_source().c_str(), F_OK) != 0)
            open_by_name();
        else
            lock(file_);
    }
    ~Replacement()
    {
        if (!path_.empty()) ::unlink(path_.c_str());
    }
    Replacement(const Replacement&) = delete;
    Replacement& operator=(const Replacement&) = delete;

    void write(std::span<const std::byte> bytes)
    {
        while (!bytes.empty()) {
            const ssize_t put = uninterrupted([&] { return ::write(file_.get(), bytes.data(), bytes.size()); });
            if (put < 0) throw cannot_write(named_, errno);
            bytes = bytes.subspan(static_cast<std::size_t>(put));
        }
    }

    /// Puts it in place of the target, which has permissions `mode` or does not exist.
    void take_place(std::optional<mode_t> mode)
    {
        if (mode && ::fchmod(file_.get(), *mode) != 0) throw cannot_write(named_, errno);
        // EINVAL: a file system without fsync, on which nothing more can be promised.
        if (uninterrupted([&] { return ::fsync(file_.get()); }) != 0 && errno != EINVAL)
            throw cannot_write(named_, errno);
        if (path_.empty() && !mode && link_to(target_)) return sync_folder();
        if (path_.empty()) {  // only a file with a name can take the place of another
            sweep(folder_);
            fs::path name = temporary_in(folder_);
            if (!link_to(name)) throw cannot_write(named_, errno);
            path_ = std::move(name);
        }
        if (uninterrupted([&] { return ::rename(path_.c_str(), target_.c_str()); }) != 0)
            throw cannot_write(named_, errno);
        path_.clear();
        sync_folder();
    }

 private:
    std::string link_source() const { return fmt::format("/proc/self/fd/{}", file_.get()); }

    void open_by_name()
    {
        sweep(folder_);
        for (int attempt = 0; attempt < 100; ++attempt) {
            const fs::path name = temporary_in(folder_);
            File file = File::open(name, O_WRONLY | O_CREAT | O_EXCL, 0666);
            if (!file.is_open() && errno == EEXIST) continue;
            if (!file.is_open()) throw cannot_write(named_, errno);
            file_ = std::move(file);
            path_ = name;
            if (!is_swept()) return;
            ::unlink(std::exchange(path_, {}).c_str());
        }
        throw cannot_write(named_, EEXIST);
    }

    /// Whether a sweep took it for a dead one's before the lock was ours. Where there are no locks nothing sweeps.
    bool is_swept() const
    {
        struct stat info {};
        return lock(file_) ? ::fstat(file_.get(), &info) == 0 && info.st_nlink == 0 : errno == EWOULDBLOCK;
    }

    bool link_to(const fs::path& name) const
    {
        const std::string source = link_source();
        return uninterrupted(
                   [&] { return ::linkat(AT_FDCWD, source.c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW); }) == 0;
    }

    /// The new name survives a power cut only once its folder is on disk; the data are safe either way.
    void sync_folder() const
    {
        const File folder = File::open(folder_, O_RDONLY | O_DIRECTORY);
        if (folder.is_open()) static_cast<void>(uninterrupted([&] { return ::fsync(folder.get()); }));
    }

    fs::path target_;
    fs::path folder_;
    fs::path named_;
    File file_;
    fs::path path_;  // its name, while it has one
};

}  // namespace

std::vector<std::byte> read_file(const fs::path& path, std::size_t max_bytes)
{
    // O_NONBLOCK: opening a pipe that nobody writes to must not wait for ever.
    const File file = File::open(path, O_RDONLY | O_NONBLOCK);
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

void replace_file(const fs::path& path, std::span<const std::byte> bytes)
{
    const fs::path target = follow_links(path);
    const std::optional<mode_t> mode = check_target(target, path);
    Replacement replacement(target, path);
    replacement.write(bytes);
    replacement.take_place(mode);
}

void check_replaceable(const fs::path& path)
{
    static_cast<void>(check_target(follow_links(path), path));
}

void replace_file(const fs::path& path, std::string_view text)
{
    replace_file(path, std::as_bytes(std::span(text)));
}

void make_folder(const std::filesystem::path& path)
{
    std::error_code failed;
    std::filesystem::create_directories(path, failed);
    if (failed)
        throw Error(Blame::input, "cannot make the folder: " + failed.message(), "choose another with -o")
            .at(path.string());
}

}  // namespace etalon
