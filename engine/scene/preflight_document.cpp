#include "engine/scene/preflight_document.h"

#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "engine/scene/json_check.h"

namespace etalon::document {

namespace {

constexpr double kExact = 9007199254740992;  // 2^53: whole numbers up to it are exact in double

// What a writer meant by "3.0" is 3. "-0.0" stays what it is.
void make_whole_numbers_integers(json& value)
{
    if (value.is_structured()) {
        for (json& part : value) make_whole_numbers_integers(part);
    } else if (value == 0 && value.is_number_integer()) {
        value = Unsigned{0};  // "-0"
    } else if (value.is_number_float()) {
        const double number = value.get<double>();
        if (std::fabs(number) <= kExact && std::trunc(number) == number && !std::signbit(number))
            value = static_cast<Unsigned>(number);
    }
}

}  // namespace

std::string Place::pointer() const
{
    std::vector<const Place*> chain;
    for (const Place* place = this; place->parent != nullptr; place = place->parent) chain.push_back(place);
    std::string out;
    for (auto place = chain.rbegin(); place != chain.rend(); ++place) {
        out += '/';
        if ((*place)->key.data() == nullptr) out += std::to_string((*place)->element);
        for (const char c : (*place)->key) out += c == '~' ? "~0" : c == '/' ? "~1" : std::string(1, c);
    }
    return out;
}

Error fault(std::string pointer, std::string what, std::string mend)
{
    Error error(Blame::input, std::move(what), std::move(mend));
    error.at(pointer.empty() ? "/" : std::move(pointer));
    return error;
}

std::string brief(const json& value)
{
    constexpr std::size_t kShown = 60;
    if (value.is_structured()) return value.is_array() ? "an array" : "an object";
    if (value.is_string() && value.get_ref<const std::string&>().size() > kShown)
        return fmt::format("a text of {} bytes", value.get_ref<const std::string&>().size());
    return value.dump();
}

void refuse_kind(const json& value, const Place& place, std::string_view expected)
{
    throw fault(place.pointer(), fmt::format("{} instead of {} [TYPE_MISMATCH]", brief(value), expected));
}

json parse(const LiftedText& text, const Limits& limits)
{
    // Two passes, not one with a callback: nlohmann's callback parser takes time quadratic in the elements of an array.
    check_json(text.text(), limits);
    json out = json::parse(text.text().begin(), text.text().end());
    make_whole_numbers_integers(out);
    return out;
}

const json& collection(const json& document, std::string_view path)
{
    static const json kEmpty = json::array();
    const json* at = &document;
    while (!path.empty() && at != nullptr) {
        const std::size_t slash = std::min(path.find('/', 1), path.size());
        at = member(*at, path.substr(1, slash - 1));
        path.remove_prefix(slash);
    }
    return at == nullptr ? kEmpty : *at;
}

const json* member(const json& object, std::string_view key)
{
    if (!object.is_object()) return nullptr;
    const auto found = object.find(key);
    return found == object.end() ? nullptr : &*found;
}

Unsigned unsigned_at(const json& object, std::string_view key, const std::string& pointer,
                     std::optional<Unsigned> standard)
{
    const json* found = member(object, key);
    if (found == nullptr) {
        if (standard) return *standard;
        throw fault(pointer, fmt::format("{} is missing [UNDEFINED_PROPERTY]", key));
    }
    if (found->is_number_unsigned()) return found->get<Unsigned>();
    const std::string_view code = found->is_number_integer() ? "VALUE_NOT_IN_RANGE" : "TYPE_MISMATCH";
    throw fault(fmt::format("{}/{}", pointer, key),
                fmt::format("{} is not a whole number from 0 [{}]", brief(*found), code));
}

}  // namespace etalon::document
