#include "engine/measure/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>

namespace etalon {

std::string html_escape(std::string_view text)
{
    std::string out;
    for (const char c : text) {
        switch (c) {
            case '&':
                out += "&amp;";
                break;
            case '<':
                out += "&lt;";
                break;
            case '>':
                out += "&gt;";
                break;
            case '"':
                out += "&quot;";
                break;
            case '\'':
                out += "&#39;";
                break;
            default:
                if ((static_cast<unsigned char>(c) < 0x20 && c != '\t' && c != '\n') || c == 0x7f)
                    out += "\xef\xbf\xbd";
                else
                    out += c;
        }
    }
    return out;
}

std::string base64(std::span<const std::byte> bytes)
{
    constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out;
    out.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
        std::uint32_t bits = 0;
        for (std::size_t k = 0; k < 3; ++k)
            bits = bits << 8 | (k < count ? std::to_integer<std::uint32_t>(bytes[i + k]) : 0u);
        for (std::size_t k = 0; k < 4; ++k) out += k <= count ? kDigits[bits >> (18 - 6 * k) & 63u] : '=';
    }
    return out;
}

std::string percent(double fraction)
{
    return fmt::format("{:.3g}%", 100 * fraction);
}

std::string error_text(const Film& film)
{
    const std::optional<ErrorEstimate> error = estimate_error(film);
    if (!error) return "not measured";
    return fmt::format("{} ({} to {})", percent(error->relative), percent(error->low), percent(error->high));
}

std::string seconds_text(double seconds)
{
    if (seconds >= 60) return fmt::format("{} min {:.0f} s", std::floor(seconds / 60), std::fmod(seconds, 60.0));
    return fmt::format("{:.3g} s", seconds);
}

std::string verdict_text(const Comparison& comparison)
{
    std::string text(name(comparison.verdict));
    if (const auto& test = comparison.test)
        text += fmt::format(" (false alarms {}; would find {} in a tile, {} in the whole with {:.0f}%)",
                            percent(test->false_alarm), percent(test->detectable_tile), percent(test->detectable_whole),
                            100 * test->power);
    return text;
}

std::size_t columns(const std::string& text)
{
    return static_cast<std::size_t>(
        std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; }));
}

std::string aligned(const std::vector<TableRow>& rows)
{
    std::vector<std::size_t> widths;
    for (const TableRow& row : rows) {
        widths.resize(std::max(widths.size(), row.size()));
        for (std::size_t k = 0; k < row.size(); ++k) widths[k] = std::max(widths[k], columns(row[k]));
    }
    std::string out;
    for (const TableRow& row : rows) {
        for (std::size_t k = 0; k < row.size(); ++k) {
            out += row[k];
            if (k + 1 < row.size()) out.append(widths[k] - columns(row[k]) + 2, ' ');
        }
        out += '\n';
    }
    return out;
}

}  // namespace etalon
