#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/geometry/box.h"

namespace etalon {

/// The one grid in which all boxes of a BVH are quantised: position = base + q / scale, q = 0 … 65535 on each axis.
struct BvhGrid {
    vec3 base{0};
    vec3 scale{1};
};

/// A child as a ray meets it: its box on the grid, rounded outwards, and what is inside.
/// x = min.x | min.y << 16, y = min.z | max.x << 16, z = max.y | max.z << 16. ref ≥ 0: index of an inner node;
/// ref < 0: a leaf, ~ref = first << 4 | count, of positions in Bvh::order. An unused child is an empty leaf (count 0)
/// in the far corner of the grid, where nothing else lies.
struct BvhChild {
    std::uint32_t x = 0xffffffffu;
    std::uint32_t y = 0xffffffffu;
    std::uint32_t z = 0xffffffffu;
    std::int32_t ref = ~0;

    bool is_leaf() const { return ref < 0; }
    std::uint32_t first() const { return static_cast<std::uint32_t>(~ref) >> 4; }
    std::uint32_t count() const { return static_cast<std::uint32_t>(~ref) & 15u; }
    uvec3 low() const { return {x & 0xffffu, x >> 16, y & 0xffffu}; }
    uvec3 high() const { return {y >> 16, z & 0xffffu, z >> 16}; }
};

/// 64 bytes, four texels on a device.
using BvhNode = std::array<BvhChild, 4>;
static_assert(sizeof(BvhNode) == 64);

struct BvhOptions {
    std::uint32_t max_leaf = 4;  ///< primitives, 1 … 15
    unsigned threads = 0;        ///< CPU threads; 0: one per core. Never changes a bit of the tree.
};

/// A four-wide bounding volume hierarchy over boxes.
struct Bvh {
    std::vector<BvhNode> nodes;        ///< depth first, the largest child next to its parent; node 0 is the root
    std::vector<std::uint32_t> order;  ///< order[k]: the input box at leaf position k
    BvhGrid grid;
    Box bounds;               ///< of all boxes kept
    std::size_t dropped = 0;  ///< boxes that were empty or not finite: in no leaf
    int stack_need = 0;       ///< the most entries that a traversal can have waiting
    double sah_cost = 0;      ///< (RT-5) with c_t = c_i = 1, of the binary tree that was collapsed
};

/// The grid keeps this distance between a box and its quantised faces, in cells: an eighth covers the rounding of a
/// float slab test whose origin lies in or near the bounds (about 0.06 cells), so that no hit is lost (G20, G21).
inline constexpr double kBvhPad = 0.125;

/// Binned SAH (16 bins, all three axes; Wald 2007) of a binary tree, collapsed to four children by opening the one of
/// largest area. Needs at most 2^27 boxes. Any input ends: equal centroids split at the median, depth is bounded (G22).
Bvh build_bvh(std::span<const Box> boxes, const BvhOptions& options = {});

}  // namespace etalon
