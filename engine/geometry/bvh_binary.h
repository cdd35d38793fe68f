#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "engine/geometry/bvh.h"

namespace etalon {

/// A node of the binary tree from which the wide one is made: children left and left + 1, or a leaf.
struct BinaryNode {
    Box box;
    std::uint32_t left = 0;   ///< of an inner node; the right child follows it
    std::uint32_t first = 0;  ///< of a leaf, into BinaryBvh::order
    std::uint32_t count = 0;  ///< 0: an inner node
    bool is_leaf() const { return count != 0; }
};

/// Node 0 is the root; empty without boxes.
struct BinaryBvh {
    std::vector<BinaryNode> nodes;
    std::vector<std::uint32_t> order;
    std::size_t dropped = 0;
};

BinaryBvh build_binary_bvh(std::span<const Box> boxes, const BvhOptions& options);

}  // namespace etalon
