#pragma once
// Private to preflight: the parsed document and how its parts are named in messages.
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "engine/base/error.h"
#include "engine/base/limits.h"
#include "engine/scene/data_uris.h"

namespace etalon::document {

using nlohmann::json;
using Unsigned = std::uint64_t;

/// Where in the document we are: a chain on the stack that is written out only for a message.
struct Place {
    const Place* parent = nullptr;
    std::string_view key{};       ///< of a member
    std::size_t element = 0;      ///< of an array, where there is no key
    std::string pointer() const;  ///< as JSON pointer (RFC 6901)
};

inline constexpr std::string_view kMend = "export again, or repair the file by hand";
/// Error(input) at `pointer`.
Error fault(std::string pointer, std::string what, std::string mend = std::string(kMend));
/// A value as messages show it: whole when short.
std::string brief(const json& value);

/// The text as a document whose whole numbers are integers however they were written ("3.0"). Checked by check_json
/// first, so that nothing here recurses deeper than limits.json_depth.
json parse(const LiftedText& text, const Limits& limits);

/// The array of objects at `path` ("/nodes"); an empty one when absent.
const json& collection(const json& document, std::string_view path);
/// The member `key`; null when absent or when `object` is none.
const json* member(const json& object, std::string_view key);
/// The unsigned integer `key` of the object at `place`; `standard` when absent. Fault when it is anything else.
Unsigned unsigned_at(const json& object, std::string_view key, const std::string& pointer,
                     std::optional<Unsigned> standard = {});

/// Calls `with(value, place)` for everything below `at` that `pattern` names: "/nodes/*/mesh", * standing for every
/// element or member. Members that are absent are passed over; fault where the pattern meets another kind of value.
template <typename Function>
void for_each(const json& at, std::string_view pattern, const Function& with, const Place& place = {});

[[noreturn]] void refuse_kind(const json& value, const Place& place, std::string_view expected);

template <typename Function>
void for_each(const json& at, std::string_view pattern, const Function& with, const Place& place)
{
    if (pattern.empty()) return with(at, place);
    const std::size_t slash = std::min(pattern.find('/', 1), pattern.size());
    const std::string_view key = pattern.substr(1, slash - 1);
    const std::string_view rest = pattern.substr(slash);
    if (key != "*") {
        if (!at.is_object()) refuse_kind(at, place, "an object");
        if (const auto found = at.find(key); found != at.end())
            for_each(*found, rest, with, Place{.parent = &place, .key = found.key()});
    } else if (at.is_array()) {
        for (std::size_t i = 0; i < at.size(); ++i) for_each(at[i], rest, with, Place{.parent = &place, .element = i});
    } else if (at.is_object()) {
        for (auto i = at.begin(); i != at.end(); ++i) for_each(*i, rest, with, Place{.parent = &place, .key = i.key()});
    } else {
        refuse_kind(at, place, "an array or object");
    }
}

}  // namespace etalon::document
