#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/limits.h"

namespace etalon {

/// The bytes of a buffer: in the file itself, or owned.
struct GltfBuffer {
    std::vector<std::byte> owned;
    std::span<const std::byte> bytes;  ///< of `owned` or of the file that was checked; empty when the file gives none
    std::uint64_t declared = 0;        ///< its byteLength, with or without data
};

/// Where an image is: in a buffer or behind a URI that has not been followed yet.
struct GltfImage {
    std::string name;                                 ///< for messages
    std::string uri;                                  ///< when there are no bytes …
    std::string_view long_uri;                        ///< … or this view of the file that was checked
    std::optional<std::span<const std::byte>> bytes;  ///< empty when its buffer has no data in the file
    std::string_view source() const { return long_uri.empty() ? std::string_view(uri) : long_uri; }
};

/// A glTF file whose every index, range and offset has been checked, ready for a parser that trusts them.
struct CheckedGltf {
    std::string json;  ///< the document without `buffers` and `images`
    std::vector<GltfBuffer> buffers;
    std::vector<GltfImage> images;
    std::vector<std::string> warnings;      ///< what was ignored, with the validator's code
    std::vector<std::string> broken_rules;  ///< of glTF, without harm to the picture; likewise
};

/// Looks at a .gltf or .glb file before anything trusts it: GLB chunks, JSON depth and counts, version, required
/// extensions, the type and range of every index, accessors within bufferViews within buffers (overflow-safe, sparse
/// ones too), the headers of Draco and meshopt payloads, nodes a forest. Buffers are loaded from beneath `folder`;
/// `bytes` must outlive the result. Throws Error(input) with a JSON pointer, the value and, where one fits, the Khronos
/// validator's code in brackets. Bounded in time, memory and stack by the limits.
CheckedGltf preflight(std::span<const std::byte> bytes, const std::filesystem::path& folder,
                      const Limits& limits = Limits());

}  // namespace etalon
