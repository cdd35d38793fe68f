#pragma once
#include <string_view>

#include "engine/base/limits.h"

namespace etalon {

/// Reads JSON text through without building or recursing. Error(input) where it is no JSON, or deeper or richer in
/// values than the limits.
void check_json(std::string_view text, const Limits& limits);

}  // namespace etalon
