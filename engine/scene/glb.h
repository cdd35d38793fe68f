#pragma once
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace etalon {

/// The parts of a glTF file, as views into its bytes.
struct GltfParts {
    std::string_view json;
    std::optional<std::span<const std::byte>> binary;  ///< GLB's BIN chunk
    std::vector<std::string> warnings{};               ///< rules of the container that were broken without harm
};

/// Tells `.glb` from `.gltf` by the magic and walks the chunks. Lengths are checked in 64 bits against what is there.
/// Throws Error(input) with the validator's code: truncated, wrong version, chunk past the end, no JSON chunk first.
GltfParts split_gltf(std::span<const std::byte> bytes);

}  // namespace etalon
