#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/etalon/options.h"

namespace etalon::cli {

/// What was typed after a subcommand, as text by option name; read and checked on demand. Every reader throws
/// Error(input) that names the option, the value and what it takes.
class Arguments {
 public:
    Arguments(const Command& command, std::vector<std::string> positional,
              std::map<std::string, std::vector<std::string>> given)
        : command_(&command), positional_(std::move(positional)), given_(std::move(given))
    {}

    const Command& command() const { return *command_; }
    const std::vector<std::string>& positional() const { return positional_; }

    bool has(std::string_view option) const;
    /// The last value given, else the option's standard; nothing when both are absent.
    std::optional<std::string> text(std::string_view option) const;
    std::vector<std::string> all(std::string_view option) const;
    /// The place of the value among the option's choices.
    std::size_t choice(std::string_view option) const;
    std::optional<double> number(std::string_view option, double least, double most) const;
    std::optional<std::uint64_t> count(std::string_view option, std::uint64_t least, std::uint64_t most) const;

 private:
    const Command* command_;
    std::vector<std::string> positional_;
    std::map<std::string, std::vector<std::string>> given_;
};

/// A number written in C's manner whatever the locale, all of `text`; nothing when it is none.
std::optional<double> parse_number(std::string_view text);
std::optional<std::uint64_t> parse_count(std::string_view text);
/// The parts of `text` between separators: "1,2,,3" has four.
std::vector<std::string> split(std::string_view text, char separator);

/// Throws Error(input): "--size: '12' is not WxH".
[[noreturn]] void refuse(std::string_view option, std::string_view value, std::string_view expected,
                         std::string mend = {});

}  // namespace etalon::cli
