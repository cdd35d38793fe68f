#include "tools/etalon/json.h"

#include <fmt/format.h>

#include <cmath>

#include "engine/base/error.h"

namespace etalon::cli {
namespace {

/// Length of the UTF-8 sequence at the front of `text`; 0 when it is none (overlong forms and surrogates included).
std::size_t utf8_length(std::string_view text)
{
    const auto byte = [&](std::size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u; };
    const auto follows = [&](std::size_t i) { return (byte(i) & 0xc0u) == 0x80u; };
    const unsigned first = byte(0);
    if (first < 0x80) return 1;
    if (first >= 0xc2 && first < 0xe0) return follows(1) ? 2 : 0;
    if (first >= 0xe0 && first < 0xf0) {
        const unsigned code = (first & 0x0fu) << 12 | (byte(1) & 0x3fu) << 6;
        const bool valid = code >= 0x800 && (code < 0xd800 || code >= 0xe000);
        return valid && follows(1) && follows(2) ? 3 : 0;
    }
    if (first >= 0xf0 && first < 0xf5) {
        const unsigned code = (first & 0x07u) << 18 | (byte(1) & 0x3fu) << 12;
        return code >= 0x10000 && code < 0x110000 && follows(1) && follows(2) && follows(3) ? 4 : 0;
    }
    return 0;
}

template <typename Members, typename Text>
std::string join(const Members& members, char open, char close, const Text& text)
{
    std::string out(1, open);
    for (const auto& member : members) {
        if (out.size() > 1) out += ", ";
        out += text(member);
    }
    return out + close;
}

}  // namespace

std::string json_quoted(std::string_view text)
{
    std::string out = "\"";
    while (!text.empty()) {
        const std::size_t length = utf8_length(text);
        const char c = text.front();
        if (length == 0)
            out += "\xef\xbf\xbd";
        else if (c == '"' || c == '\\')
            out += {'\\', c};
        else if (c == '\n')
            out += "\\n";
        else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f)
            out += fmt::format("\\u{:04x}", static_cast<unsigned>(c));
        else
            out += text.substr(0, length);
        text.remove_prefix(length == 0 ? 1 : length);
    }
    return out + '"';
}

Json::Json(double value) : text_(std::isfinite(value) ? fmt::format("{}", value) : "null") {}

Json::Json(const std::vector<Json>& values)
    : text_(join(values, '[', ']', [](const Json& value) { return value.text(); }))
{}

Json Json::object(std::initializer_list<Member> members)
{
    return raw(join(members, '{', '}', [](const Member& m) { return json_quoted(m.key) + ": " + m.value.text(); }));
}

Json Json::object(const std::vector<std::pair<std::string, Json>>& members)
{
    return raw(join(members, '{', '}', [](const auto& m) { return json_quoted(m.first) + ": " + m.second.text(); }));
}

Json Json::raw(std::string text)
{
    Json json;
    json.text_ = std::move(text);
    return json;
}

Json as_json(const Error& error)
{
    return Json::object(
        {{"what", error.what()}, {"where", error.where()}, {"mend", error.mend()}, {"exit_code", error.exit_code()}});
}

}  // namespace etalon::cli
