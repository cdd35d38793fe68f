#pragma once
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/image/film.h"
#include "engine/measure/compare.h"

namespace etalon {

/// `text` for HTML content and double-quoted attributes; control characters but tab and newline become U+FFFD.
std::string html_escape(std::string_view text);
/// RFC 4648 with padding.
std::string base64(std::span<const std::byte> bytes);

/// "1.23% (1.20% to 1.26%)", or "not measured".
std::string error_text(const Film& film);
/// "0.213 s", "2 min 13 s".
std::string seconds_text(double seconds);
/// "indistinguishable", with what it means: false-alarm rate and power where a test was made.
std::string verdict_text(const Comparison& comparison);
/// A percentage with three significant digits.
std::string percent(double fraction);

using TableRow = std::vector<std::string>;
/// Code points, which is columns for everything that is printed here.
std::size_t columns(const std::string& text);
/// Left-aligned columns two spaces apart; the last one is not padded.
std::string aligned(const std::vector<TableRow>& rows);

}  // namespace etalon
