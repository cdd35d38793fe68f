#pragma once
#include <exception>
#include <string>
#include <string_view>
#include <vector>

namespace etalon {

/// Who must act on a failure; the values are the exit codes of every program of this project.
enum class Blame : int {
    input = 2,    ///< the caller: a bad option, file, field or value
    machine = 3,  ///< the machine: no device, no memory, no disk, device lost
};

/// A failure of input or machine: thrown once where it is met, given context on its way up, caught in `main` and in
/// tests. Printed as `etalon: <what>`, one line `  at <where>` per context (outermost first), and `  mend: <mend>`.
class Error : public std::exception {
 public:
    /// `what`: the fault with the value that shows it; `mend`: what the reader can do (may be empty).
    Error(Blame blame, std::string what, std::string mend = {});

    /// Adds where it happened (a file, a JSON pointer such as /meshes/2/primitives/0, a Vulkan call). Innermost first.
    Error& at(std::string where);

    const char* what() const noexcept override { return what_.c_str(); }
    const std::string& mend() const noexcept { return mend_; }
    const std::vector<std::string>& where() const noexcept { return where_; }
    Blame blame() const noexcept { return blame_; }
    int exit_code() const noexcept { return static_cast<int>(blame_); }
    /// All of it as the lines that a user reads, without a final newline.
    std::string message() const;

 private:
    std::string what_;
    std::string mend_;
    std::vector<std::string> where_;
    Blame blame_;
};

/// Prints the place of a broken assumption and aborts.
[[noreturn]] void fail_assumption(const char* file, int line, const char* function) noexcept;

/// A condition that only our own bug can break: prints the place and aborts, in every build. Inline, so that hot code
/// pays one predicted branch. (The built-ins, since clang 14 has no std::source_location with this standard library.)
inline void assume(bool condition, const char* file = __builtin_FILE(), int line = __builtin_LINE(),
                   const char* function = __builtin_FUNCTION())
{
    if (!condition) [[unlikely]]
        fail_assumption(file, line, function);
}

}  // namespace etalon
