#pragma once
#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace etalon {

/// The bytes of a glTF `uri`: a data: URI, decoded, or a file beneath `folder`. Nothing outside `folder` is ever
/// opened, whatever the URI, the links in it or a race say: absolute paths, `..` that leaves, links that leave, other
/// schemes, devices, pipes and folders are refused. Throws Error(input) that names the URI; the caller adds the JSON
/// pointer. Over `max_bytes` is refused before anything is read. Of a file only the first `wanted` bytes are read, and
/// only they count.
std::vector<std::byte> read_uri(std::string_view uri, const std::filesystem::path& folder, std::size_t max_bytes,
                                std::size_t wanted = ~std::size_t{0});

/// The path of a file that read_uri would read, for readers that open files themselves. Refuses what read_uri refuses.
std::filesystem::path confined_path(std::string_view uri, const std::filesystem::path& folder);

/// `%41` → `A`, once. Error(input) for a bad escape or a control character.
std::string percent_decoded(std::string_view text);

/// RFC 4648 base64, padding optional. Error(input) at the first byte that does not belong.
std::vector<std::byte> base64_decoded(std::string_view text);

}  // namespace etalon
