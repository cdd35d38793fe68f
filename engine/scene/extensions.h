#pragma once
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace etalon {

/// Does the importer honour this glTF extension?
bool is_supported_extension(std::string_view name);

/// What a user can do about a required extension that we lack.
std::string mend_for_extension(std::string_view name);

/// Throws Error(input) that names the first required extension that we lack.
void check_required_extensions(std::span<const std::string> required);

/// One warning for each used extension that is neither required nor honoured.
std::vector<std::string> warnings_for_extensions(std::span<const std::string> used);

}  // namespace etalon
