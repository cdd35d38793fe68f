#include "tools/etalon/arguments.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "engine/base/error.h"

namespace etalon::cli {
namespace {

template <typename Number>
std::optional<Number> parse(std::string_view text)
{
    if (text.starts_with('+')) text.remove_prefix(1);
    Number value{};
    const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (fault != std::errc() || end != text.data() + text.size() || text.empty()) return std::nullopt;
    return value;
}

}  // namespace

bool Arguments::has(std::string_view option) const
{
    return given_.contains(std::string(option));
}

std::optional<std::string> Arguments::text(std::string_view option) const
{
    if (const auto found = given_.find(std::string(option)); found != given_.end() && !found->second.empty())
        return found->second.back();
    const Option* const row = find_option(*command_, option);
    return row == nullptr || row->standard.empty() ? std::nullopt : std::optional(row->standard);
}

std::vector<std::string> Arguments::all(std::string_view option) const
{
    const auto found = given_.find(std::string(option));
    return found == given_.end() ? std::vector<std::string>{} : found->second;
}

std::size_t Arguments::choice(std::string_view option) const
{
    const Option* const row = find_option(*command_, option);
    assume(row != nullptr && !row->choices.empty());
    const std::string value = text(option).value_or(row->choices.front());
    const auto found = std::find(row->choices.begin(), row->choices.end(), value);
    if (found != row->choices.end()) return static_cast<std::size_t>(found - row->choices.begin());
    const std::string_view meant = nearest(value, row->choices);
    refuse(option, value, fmt::format("one of {}", fmt::join(row->choices, ", ")),
           meant.empty() ? "" : fmt::format("did you mean --{} {}?", option, meant));
}

std::optional<double> Arguments::number(std::string_view option, double least, double most) const
{
    const std::optional<std::string> value = text(option);
    if (!value) return std::nullopt;
    const std::optional<double> number = parse_number(*value);
    if (!number || !(*number >= least && *number <= most))
        refuse(option, *value, fmt::format("a number from {} to {}", least, most));
    return number;
}

std::optional<std::uint64_t> Arguments::count(std::string_view option, std::uint64_t least, std::uint64_t most) const
{
    const std::optional<std::string> value = text(option);
    if (!value) return std::nullopt;
    const std::optional<std::uint64_t> number = parse_count(*value);
    if (!number || *number < least || *number > most)
        refuse(option, *value, fmt::format("a whole number from {} to {}", least, most));
    return number;
}

std::optional<double> parse_number(std::string_view text)
{
    const std::optional<double> value = parse<double>(text);
    return value && std::isfinite(*value) ? value : std::nullopt;
}

std::optional<std::uint64_t> parse_count(std::string_view text)
{
    return parse<std::uint64_t>(text);
}

std::vector<std::string> split(std::string_view text, char separator)
{
    std::vector<std::string> parts;
    for (std::size_t at = 0; at != std::string_view::npos;) {
        const std::size_t end = text.find(separator, at);
        parts.emplace_back(text.substr(at, end == std::string_view::npos ? end : end - at));
        at = end == std::string_view::npos ? end : end + 1;
    }
    return parts;
}

void refuse(std::string_view option, std::string_view value, std::string_view expected, std::string mend)
{
    throw Error(Blame::input, fmt::format("--{} takes {}, not '{}'", option, expected, value), std::move(mend));
}

}  // namespace etalon::cli
