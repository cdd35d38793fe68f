#pragma once
// Inside engine/gpu only: blocks of memory as OpenGL lays them out.
#include <cstddef>
#include <cstdint>
#include <map>
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

/// Lays out the blocks of one module anew. Types are redecorated so that SPIRV-Cross writes them by the new rules; what
/// they said before is remembered, because a type may be met again in another member or block.
class BlockLayouts {
 public:
    explicit BlockLayouts(const SpirvModule& module) : module_(module) {}

    /// Of the block of this type, and what that does to its bytes. Throws Error(input) for what cannot be: row-major
    /// matrices, arrays of arrays, one struct under both rules.
    BlockLayout lay_out(spvc_type_id block, BlockRules rules);

 private:
    /// A type in the new layout: where its pieces go, from its own start.
    struct Laid {
        BlockRules rules = BlockRules::std430;
        std::uint32_t alignment = 1;
        std::uint32_t from_size = 0;
        std::uint32_t to_size = 0;
        std::vector<BlockPiece> pieces;
    };
    struct Member;

    Laid lay_members(spvc_type_id id, BlockRules rules, BlockLayout* runtime);
    const Laid& lay_struct(spvc_type_id id, BlockRules rules);
    Member lay_member(spvc_type_id owner, unsigned index, BlockRules rules);
    Laid lay_element(spvc_type_id owner, unsigned index, BlockRules rules);
    static void append(std::vector<BlockPiece>& out, const std::vector<BlockPiece>& pieces, std::uint32_t from,
                       std::uint32_t to);

    const SpirvModule& module_;
    std::map<spvc_type_id, BlockLayout> blocks_;
    std::map<spvc_type_id, Laid> structs_;
    std::map<spvc_type_id, unsigned> from_strides_;  // of array types
};

}  // namespace etalon::gpu
