#pragma once
#include <span>
#include <string>

#include "tools/etalon/arguments.h"

namespace etalon::cli {

/// Splits what follows a subcommand into options and positional arguments. Throws Error(input) with the nearest
/// option's name for a misspelt one, and for a missing value, a choice that is none, or too few or too many arguments.
Arguments parse(const Command& command, std::span<const std::string> words);

}  // namespace etalon::cli
