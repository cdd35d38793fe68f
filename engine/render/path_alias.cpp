#include "engine/render/path_alias.h"

#include <algorithm>
#include <cmath>

namespace etalon {
namespace {

/// Rounded down, so that an entry whose chance is below one is never kept too often by a 24-bit uniform number.
float threshold_of(double kept)
{
    return static_cast<float>(std::clamp(kept, 0.0, 1.0));
}

}  // namespace

std::vector<AliasEntry> make_alias_table(std::span<const double> weights)
{
    double sum = 0;
    for (const double weight : weights) sum += weight;
    if (!(sum > 0) || !std::isfinite(sum)) return {};

    const auto count = static_cast<double>(weights.size());
    std::vector<AliasEntry> table(weights.size());
    std::vector<double> share(weights.size());
    std::vector<std::uint32_t> small;
    std::vector<std::uint32_t> large;
    std::size_t heaviest = 0;
    for (std::size_t i = 0; i < weights.size(); ++i) {
        table[i].probability = weights[i] / sum;
        share[i] = table[i].probability * count;
        (share[i] < 1 ? small : large).push_back(static_cast<std::uint32_t>(i));
        if (weights[i] > weights[heaviest]) heaviest = i;
    }
    while (!small.empty() && !large.empty()) {
        const std::uint32_t poor = small.back();
        const std::uint32_t rich = large.back();
        small.pop_back();
        table[poor].threshold = threshold_of(share[poor]);
        table[poor].other = rich;
        share[rich] -= 1 - share[poor];
        if (share[rich] < 1) {
            large.pop_back();
            small.push_back(rich);
        }
    }
    // What rounding leaves over keeps itself, except where it must never be drawn.
    for (const std::uint32_t i : large) table[i] = {1, i, table[i].probability};
    for (const std::uint32_t i : small)
        table[i] = weights[i] > 0 ? AliasEntry{1, i, table[i].probability}
                                  : AliasEntry{0, static_cast<std::uint32_t>(heaviest), 0};
    return table;
}

}  // namespace etalon
