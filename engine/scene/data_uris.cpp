#include "engine/scene/data_uris.h"

#include <charconv>

namespace etalon {

namespace {

constexpr std::string_view kStandIn = "data:@";
constexpr std::size_t kLong = 4096;  // below it a copy is cheaper than the care

// Behind the closing quote of the string that opens before `begin`; the end of the text when nothing closes it.
std::size_t string_end(std::string_view text, std::size_t begin)
{
    for (std::size_t from = begin;;) {
        const std::size_t quote = text.find('"', from);
        if (quote == std::string_view::npos) return text.size();
        std::size_t slashes = 0;
        while (quote - slashes > begin && text[quote - slashes - 1] == '\\') ++slashes;
        if (slashes % 2 == 0) return quote + 1;
        from = quote + 1;
    }
}

}  // namespace

LiftedText::LiftedText(std::string_view text) : whole_(text)
{
    std::size_t copied = 0;
    for (std::size_t open = text.find('"'); open != std::string_view::npos;) {
        const std::size_t end = string_end(text, open + 1);
        const std::string_view inside = text.substr(open + 1, end - open - 1);  // with the closing quote
        if (inside.size() > kLong && inside.starts_with("data:") && inside.ends_with('"') &&
            inside.find('\\') == std::string_view::npos) {
            short_ += text.substr(copied, open + 1 - copied);
            short_ += kStandIn;
            short_ += std::to_string(uris_.size());
            copied = end - 1;
            uris_.push_back(inside.substr(0, inside.size() - 1));
        }
        open = text.find('"', end);
    }
    if (!uris_.empty()) short_ += text.substr(copied);
}

std::string_view LiftedText::uri(std::string_view value) const
{
    std::size_t index = 0;
    if (!value.starts_with(kStandIn)) return value;
    const char* end = value.data() + value.size();
    const auto [stop, error] = std::from_chars(value.data() + kStandIn.size(), end, index);
    return error == std::errc() && stop == end && index < uris_.size() ? uris_[index] : value;
}

}  // namespace etalon
