#pragma once
#include <span>
#include <string>
#include <string_view>

namespace etalon {

/// The candidate closest to `word` by edits (swaps count one), if it is close enough to be what was meant; else empty.
/// Views one of `candidates`.
std::string_view nearest(std::string_view word, std::span<const std::string> candidates);

}  // namespace etalon
