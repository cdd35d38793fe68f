#pragma once
#include <cstddef>
#include <vector>

namespace etalon {

/// Every node has one parent at most and none is its own ancestor; scenes list each node without a parent at most once.
/// `children` of each node and `nodes` of each scene, all below children.size(). Error(input) with the validator's
/// code. Iterative: nodes may be 10^6 deep.
void check_forest(const std::vector<std::vector<std::size_t>>& children,
                  const std::vector<std::vector<std::size_t>>& scenes);

}  // namespace etalon
