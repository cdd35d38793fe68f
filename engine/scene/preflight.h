#pragma once
#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace etalon {

/// What a glTF file may ask of us before we say no.
struct GltfLimits {
    std::size_t json_bytes = std::size_t{1} << 30;
    std::size_t json_depth = 256;  ///< no recursive reader sees deeper text
    std::size_t json_values = 50'000'000;
    std::size_t resource_bytes = std::size_t{4} << 30;  ///< one buffer or image
    std::size_t zero_filled_bytes = 256 << 20;          ///< accessors without a bufferView, together
};

/// The bytes of a buffer: in the file itself, or owned.
struct GltfBuffer {
    std::vector<std::byte> owned;
    std::span<const std::byte> bytes;  ///< of `owned` or of the file that was checked; empty when the file gives none
};

/// Where an image is: in a buffer or behind a URI that has not been followed yet.
struct GltfImage {
    std::string name;                                 ///< for messages
    std::string uri;                                  ///< when there are no bytes
    std::optional<std::span<const std::byte>> bytes;  ///< empty when its buffer has no data in the file
};

/// A glTF file whose every index, range and offset has been checked, ready for a parser that trusts them.
struct CheckedGltf {
    std::string json;  ///< the document without `buffers` and `images`
    std::vector<GltfBuffer> buffers;
    std::vector<GltfImage> images;
};

/// Looks at a .gltf or .glb file before anything trusts it: GLB chunks, JSON depth and counts, version, required
/// extensions, the type and range of every index, accessors within bufferViews within buffers (overflow-safe, sparse
/// ones too), nodes a forest. Buffers are loaded from beneath `folder`; `bytes` must outlive the result. Throws
/// Error(input) with a JSON pointer, the value and, where one fits, the Khronos validator's code in brackets. Bounded
/// in time and memory by the limits.
CheckedGltf preflight(std::span<const std::byte> bytes, const std::filesystem::path& folder,
                      const GltfLimits& limits = {});

}  // namespace etalon
