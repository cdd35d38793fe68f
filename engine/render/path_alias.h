#pragma once
#include <cstdint>
#include <span>
#include <vector>

namespace etalon {

/// One entry of an alias table: a uniform pick of an entry keeps it with probability `threshold`, else takes `other`.
struct AliasEntry {
    float threshold = 1;
    std::uint32_t other = 0;
    double probability = 0;  ///< of this entry being the result
};

/// Vose 1991, in double: an entry of weight 0 is never drawn, whatever the ratio of the others (M10, S23). Weights must
/// be finite and not negative; empty when all are 0.
std::vector<AliasEntry> make_alias_table(std::span<const double> weights);

}  // namespace etalon
