#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

namespace etalon {

/// Every node has one parent at most, none is its own ancestor or below `max_depth` others; scenes list each node
/// without a parent at most once. `children` of each node and `nodes` of each scene, all below children.size().
/// Error(input) with the validator's code. Iterative: nodes may be 10^6 deep.
void check_forest(const std::vector<std::vector<std::size_t>>& children,
                  const std::vector<std::vector<std::size_t>>& scenes, std::uint64_t max_depth);

}  // namespace etalon
