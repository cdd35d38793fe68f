#pragma once
#include <cstddef>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

namespace etalon {

/// The whole file. Throws Error(input) naming the path when it is missing, no regular file, unreadable or over
/// `max_bytes`; Error(machine) when memory or the disk fails. Never waits on a pipe or a device.
std::vector<std::byte> read_file(const std::filesystem::path& path, std::size_t max_bytes = std::size_t{4} << 30);

/// Replaces `path` at once or not at all: the bytes go into a file without a name in the same folder, which is synced
/// and put into the place of `path` in one step. On any failure the old file is left as it was and Error is thrown;
/// whoever dies on the way, even by SIGKILL, leaves the old file or the whole new one. What then may be left beside it
/// (`.etalon-` and 16 digits, where the file system has no nameless files or death came between two system calls) goes
/// with the next replacement in that folder; those of living processes are locked and stay. A symbolic link is
/// followed and kept; an existing file keeps its permissions and is not replaced when it is write-protected; what is
/// neither absent nor a regular file (a folder, a device) is refused.
void replace_file(const std::filesystem::path& path, std::span<const std::byte> bytes);
void replace_file(const std::filesystem::path& path, std::string_view text);

/// Throws what replace_file would throw of `path` itself, without writing: a folder or device in its place, a
/// write-protected file. Before hours of rendering, not after.
void check_replaceable(const std::filesystem::path& path);

/// Makes the folder and its parents where they are absent. Throws Error(input).
void make_folder(const std::filesystem::path& path);

}  // namespace etalon
