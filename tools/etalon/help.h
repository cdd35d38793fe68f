#pragma once
#include <string>

#include "tools/etalon/options.h"

namespace etalon::cli {

/// What `etalon --help` prints, and `etalon COMMAND --help`.
std::string overview();
std::string help(const Command& command);

/// "-o, --output FILE".
std::string spelling(const Option& option);
/// `text` broken at spaces into lines of at most `width` characters, each after `indent` spaces.
std::string wrapped(std::string_view text, std::size_t indent, std::size_t width = 100);

}  // namespace etalon::cli
