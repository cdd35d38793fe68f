#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace etalon::test {

/// A new empty folder that is removed with all that is in it.
class TemporaryDirectory {
 public:
    TemporaryDirectory();
    ~TemporaryDirectory();
    TemporaryDirectory(const TemporaryDirectory&) = delete;
    TemporaryDirectory& operator=(const TemporaryDirectory&) = delete;
    const std::filesystem::path& path() const { return path_; }
    std::filesystem::path operator/(std::string_view name) const { return path_ / name; }
    /// Names of what lies in it, sorted.
    std::vector<std::string> names() const;

 private:
    std::filesystem::path path_;
};

/// `relative` in the folder of shared test inputs ($ETALON_SHARED, else <source>/../shared); nothing when it is not
/// there. A test that needs it says GTEST_SKIP() << "no shared inputs".
std::optional<std::filesystem::path> find_shared(std::string_view relative);

/// While it lives, no file of this process can grow over `bytes`: a full disk as far as a writer can tell.
class FileSizeLimit {
 public:
    explicit FileSizeLimit(std::uint64_t bytes);
    ~FileSizeLimit();
    FileSizeLimit(const FileSizeLimit&) = delete;
    FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
    std::uint64_t old_limit_;
    void (*old_handler_)(int);
};

/// Bytes of address space that this process has taken; terabytes under a sanitizer, where it cannot be limited.
std::uint64_t address_space();
/// Lets this process take `more` beyond that, for good: call it in a death test.
void limit_memory(std::uint64_t more);

/// While it lives, root is nobody, so that permissions mean something where tests run as root.
class Unprivileged {
 public:
    Unprivileged();
    ~Unprivileged();
    Unprivileged(const Unprivileged&) = delete;
    Unprivileged& operator=(const Unprivileged&) = delete;

 private:
    bool was_root_;
};

}  // namespace etalon::test
