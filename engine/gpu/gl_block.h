#pragma once
// Inside engine/gpu only: blocks of memory as OpenGL lays them out.
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/gpu/spirv_module.h"

namespace etalon::gpu {

/// Bytes that lie at `from` in the scalar layout of shaders/shared and at `to` in OpenGL's.
struct BlockPiece {
    std::uint32_t from = 0;
    std::uint32_t to = 0;
    std::uint32_t size = 0;
    bool operator==(const BlockPiece&) const = default;
};

/// How the bytes of one block go from the scalar layout, which OpenGL has not, to std430 or std140: first a fixed part,
/// then an array of as many elements as there are.
struct BlockLayout {
    std::vector<BlockPiece> fixed;
    std::uint32_t from_fixed = 0;  ///< bytes of the fixed part, that is where the array begins
    std::uint32_t to_fixed = 0;
    std::vector<BlockPiece> element;
    std::uint32_t from_stride = 0;  ///< 0: no array
    std::uint32_t to_stride = 0;
    bool operator==(const BlockLayout&) const = default;

    /// True where both layouts are one.
    bool is_identity() const;
    /// `bytes` laid out anew. Of an array whose last element is cut off, the whole ones.
    std::vector<std::byte> apply(std::span<const std::byte> bytes) const;
};

enum class BlockRules { std140, std430 };

/// Redecorates a block's type so that SPIRV-Cross writes it by `rules`, and says what that does to its bytes. Throws
/// Error(input) naming what cannot be: row-major matrices, arrays of arrays.
BlockLayout lay_out(const SpirvModule& module, spvc_type_id block, BlockRules rules);

}  // namespace etalon::gpu
