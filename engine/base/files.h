#pragma once
#include <cstddef>
#include <filesystem>
#include <functional>
#include <span>
#include <string_view>
#include <vector>

namespace etalon {

/// The whole file. Throws Error(input) naming the path when it is missing, no regular file, unreadable or over
/// `max_bytes`; Error(machine) when memory or the disk fails. Never waits on a pipe or a device.
std::vector<std::byte> read_file(const std::filesystem::path& path, std::size_t max_bytes = std::size_t{4} << 30);

/// Replaces `path` at once or not at all: `write` is given a temporary path in the same folder, which is then synced
/// and renamed over `path`; on any failure the temporary is removed, the old file is left as it was, and Error is
/// thrown. A symbolic link is followed and kept; an existing file keeps its permissions and is not replaced when it is
/// write-protected; what is neither absent nor a regular file (a folder, a device) is refused.
void replace_file(const std::filesystem::path& path, const std::function<void(const std::filesystem::path&)>& write);
void replace_file(const std::filesystem::path& path, std::span<const std::byte> bytes);
void replace_file(const std::filesystem::path& path, std::string_view text);

}  // namespace etalon
