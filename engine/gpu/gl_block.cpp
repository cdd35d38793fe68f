#include "engine/gpu/gl_block.h"

#include <algorithm>

namespace etalon::gpu {
namespace {

std::uint32_t round_up(std::uint32_t value, std::uint32_t step)
{
    return (value + step - 1) / step * step;
}

void copy(std::span<const BlockPiece> pieces, std::span<const std::byte> from, std::byte* to)
{
    for (const BlockPiece& piece : pieces) {
        if (piece.from >= from.size()) continue;
        const std::size_t size = std::min<std::size_t>(piece.size, from.size() - piece.from);
        std::copy_n(from.begin() + piece.from, size, to + piece.to);
    }
}

}  // namespace

bool BlockLayout::is_identity() const
{
    const auto same = [](const std::vector<BlockPiece>& pieces) {
        return std::all_of(pieces.begin(), pieces.end(),
                           [](const BlockPiece& piece) { return piece.from == piece.to; });
    };
    return same(fixed) && same(element) && from_stride == to_stride && (from_stride == 0 || from_fixed == to_fixed);
}

std::vector<std::byte> BlockLayout::apply(std::span<const std::byte> bytes) const
{
    const std::size_t rest = bytes.size() - std::min<std::size_t>(bytes.size(), from_fixed);
    const std::size_t count = from_stride != 0 ? rest / from_stride : 0;
    std::vector<std::byte> out(to_fixed + count * to_stride);
    copy(fixed, bytes.first(bytes.size() - rest), out.data());
    for (std::size_t i = 0; i < count; ++i)
        copy(element, bytes.subspan(from_fixed + i * from_stride, from_stride), out.data() + to_fixed + i * to_stride);
    return out;
}

struct BlockLayouts::Member {
    Laid laid;  ///< of one element
    std::uint32_t count = 1;
    std::uint32_t from_stride = 0;  ///< of arrays
    std::uint32_t to_stride = 0;
    std::uint32_t from_size() const { return from_stride != 0 ? count * from_stride : laid.from_size; }
    std::uint32_t to_size() const { return to_stride != 0 ? count * to_stride : laid.to_size; }
};

void BlockLayouts::append(std::vector<BlockPiece>& out, const std::vector<BlockPiece>& pieces, std::uint32_t from,
                          std::uint32_t to)
{
    for (const BlockPiece& piece : pieces) {
        const BlockPiece moved{from + piece.from, to + piece.to, piece.size};
        // Neighbours in both layouts are one copy.
        if (!out.empty() && out.back().from + out.back().size == moved.from &&
            out.back().to + out.back().size == moved.to)
            out.back().size += moved.size;
        else
            out.push_back(moved);
    }
}

/// Where `runtime` is given, the last member may be an array without size.
BlockLayouts::Laid BlockLayouts::lay_members(spvc_type_id id, BlockRules rules, BlockLayout* runtime)
{
    const spvc_type type = module_.type(id);
    Laid out{.rules = rules, .pieces = {}};
    for (unsigned i = 0; i < spvc_type_get_num_member_types(type); ++i) {
        unsigned from = 0;
        module_.check(spvc_compiler_type_struct_member_offset(module_.compiler(), type, i, &from));
        const Member member = lay_member(id, i, rules);
        const std::uint32_t to = round_up(out.to_size, member.laid.alignment);
        spvc_compiler_set_member_decoration(module_.compiler(), id, i, SpvDecorationOffset, to);
        out.alignment = std::max(out.alignment, member.laid.alignment);
        if (member.count == 0) {
            if (runtime == nullptr) throw Error(Blame::input, "an array without size within a struct");
            runtime->element = member.laid.pieces;
            runtime->from_stride = member.from_stride;
            runtime->to_stride = member.to_stride;
            out.from_size = from;
            out.to_size = to;
            continue;
        }
        for (std::uint32_t n = 0; n < member.count; ++n)
            append(out.pieces, member.laid.pieces, from + n * member.from_stride, to + n * member.to_stride);
        out.from_size = from + member.from_size();
        out.to_size = to + member.to_size();
    }
    if (rules == BlockRules::std140) out.alignment = round_up(out.alignment, 16);
    return out;
}

const BlockLayouts::Laid& BlockLayouts::lay_struct(spvc_type_id id, BlockRules rules)
{
    auto known = structs_.find(id);
    if (known == structs_.end()) {
        Laid laid = lay_members(id, rules, nullptr);
        laid.to_size = round_up(laid.to_size, laid.alignment);
        known = structs_.emplace(id, std::move(laid)).first;
    }
    if (known->second.rules != rules)
        throw Error(Blame::input, "one struct in uniform and in storage blocks has no one layout in OpenGL");
    return known->second;
}

BlockLayouts::Member BlockLayouts::lay_member(spvc_type_id owner, unsigned index, BlockRules rules)
{
    const spvc_type owner_type = module_.type(owner);
    const spvc_type_id id = spvc_type_get_member_type(owner_type, index);
    const spvc_type type = module_.type(id);
    Member out{.laid = lay_element(owner, index, rules)};
    const unsigned dimensions = spvc_type_get_num_array_dimensions(type);
    if (dimensions == 0) return out;
    if (dimensions > 1) throw Error(Blame::input, "arrays of arrays have no layout in OpenGL here");
    out.count = spvc_type_get_array_dimension(type, 0);
    if (const auto known = from_strides_.find(id); known != from_strides_.end())
        out.from_stride = known->second;
    else
        module_.check(
            spvc_compiler_type_struct_member_array_stride(module_.compiler(), owner_type, index, &out.from_stride));
    from_strides_[id] = out.from_stride;
    if (rules == BlockRules::std140) out.laid.alignment = round_up(out.laid.alignment, 16);
    out.to_stride = round_up(out.laid.to_size, out.laid.alignment);
    spvc_compiler_set_decoration(module_.compiler(), id, SpvDecorationArrayStride, out.to_stride);
    return out;
}

/// One element of a member, whatever its array dimensions.
BlockLayouts::Laid BlockLayouts::lay_element(spvc_type_id owner, unsigned index, BlockRules rules)
{
    const spvc_type owner_type = module_.type(owner);
    const spvc_type type = module_.type(spvc_type_get_member_type(owner_type, index));
    if (spvc_type_get_basetype(type) == SPVC_BASETYPE_STRUCT)
        return lay_struct(spvc_type_get_base_type_id(type), rules);
    const std::uint32_t scalar = spvc_type_get_bit_width(type) / 8;
    const std::uint32_t rows = spvc_type_get_vector_size(type);
    const std::uint32_t columns = spvc_type_get_columns(type);
    Laid out{.rules = rules,
             .alignment = scalar * (rows == 3 ? 4 : rows),
             .from_size = scalar * rows,
             .to_size = scalar * rows,
             .pieces = {{0, 0, scalar * rows}}};
    if (columns == 1) return out;
    if (spvc_compiler_has_member_decoration(module_.compiler(), owner, index, SpvDecorationRowMajor) != SPVC_FALSE)
        throw Error(Blame::input, "row-major matrices have no layout in OpenGL here");
    unsigned from_stride = 0;
    module_.check(spvc_compiler_type_struct_member_matrix_stride(module_.compiler(), owner_type, index, &from_stride));
    if (rules == BlockRules::std140) out.alignment = round_up(out.alignment, 16);
    const std::uint32_t to_stride = round_up(out.to_size, out.alignment);
    const std::vector<BlockPiece> column = std::move(out.pieces);
    out.pieces.clear();
    for (std::uint32_t n = 0; n < columns; ++n) append(out.pieces, column, n * from_stride, n * to_stride);
    out.from_size = (columns - 1) * from_stride + out.from_size;
    out.to_size = columns * to_stride;
    spvc_compiler_set_member_decoration(module_.compiler(), owner, index, SpvDecorationMatrixStride, to_stride);
    return out;
}

BlockLayout BlockLayouts::lay_out(spvc_type_id block, BlockRules rules)
{
    const auto [known, is_new] = blocks_.try_emplace(block);
    BlockLayout& layout = known->second;
    if (!is_new) return layout;
    Laid laid = lay_members(block, rules, &layout);
    layout.fixed = std::move(laid.pieces);
    layout.from_fixed = laid.from_size;
    layout.to_fixed = layout.to_stride != 0 ? laid.to_size : round_up(laid.to_size, 16);
    return layout;
}

}  // namespace etalon::gpu
