#include "engine/base/error.h"

#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>
#include <utility>

namespace etalon {
namespace {

/// Text for a terminal: names out of hostile files must neither move its cursor nor forge a line of ours.
std::string printable(std::string_view text)
{
    std::string out;
    for (const char c : text) {
        const auto code = static_cast<unsigned char>(c);
        if (c == '\n')
            out += "\n    ";
        else if (code < 0x20 || code == 0x7f)
            out += fmt::format("\\x{:02x}", code);
        else
            out += c;
    }
    return out;
}

}  // namespace

Error::Error(Blame blame, std::string what, std::string mend)
    : what_(std::move(what)), mend_(std::move(mend)), blame_(blame)
{}

Error& Error::at(std::string where)
{
    where_.push_back(std::move(where));
    return *this;
}

std::string Error::message() const
{
    std::string out = "etalon: " + printable(what_);
    for (auto where = where_.rbegin(); where != where_.rend(); ++where) out += "\n  at " + printable(*where);
    if (!mend_.empty()) out += "\n  mend: " + printable(mend_);
    return out;
}

void fail_assumption(const char* file, int line, const char* function) noexcept
{
    std::fprintf(stderr,
                 "etalon: a bug of ours: assumption broken in %s\n  at %s:%d\n  mend: please report it with the "
                 "command and the scene\n",
                 function, file, line);
    std::abort();
}

}  // namespace etalon
