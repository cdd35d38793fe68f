#pragma once
#include <concepts>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace etalon {
class Error;
}

namespace etalon::cli {

/// Text between quotes as JSON wants it; bytes that are not UTF-8 become U+FFFD.
std::string json_quoted(std::string_view text);

/// A JSON value put together from the inside out, already as text. Numbers that are not finite become null.
class Json {
 public:
    Json() = default;  ///< null
    Json(bool value) : text_(value ? "true" : "false") {}
    Json(double value);
    template <std::integral Number>
    Json(Number value) : text_(std::to_string(value))
    {}
    Json(std::string_view value) : text_(json_quoted(value)) {}
    Json(const std::string& value) : Json(std::string_view(value)) {}
    Json(const char* value) : Json(std::string_view(value)) {}
    template <typename T>
    Json(const std::optional<T>& value) : text_(value ? Json(*value).text() : "null")
    {}
    Json(const std::vector<Json>& values);
    Json(const std::vector<std::string>& values) : Json(std::vector<Json>(values.begin(), values.end())) {}

    struct Member {
        std::string_view key;
        const Json& value;
    };
    /// An object, its members in the order given.
    static Json object(std::initializer_list<Member> members);
    static Json object(const std::vector<std::pair<std::string, Json>>& members);
    /// Text that is JSON already.
    static Json raw(std::string text);

    const std::string& text() const { return text_; }

 private:
    std::string text_ = "null";
};

/// A failure as --json says it: what, where, mend and exit code.
Json as_json(const Error& error);

}  // namespace etalon::cli
