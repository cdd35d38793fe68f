#include "engine/render/resample.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace etalon {

std::vector<Coverage> coverages(int from, int to)
{
    std::vector<Coverage> all(static_cast<std::size_t>(to));
    for (int i = 0; i < to; ++i) {
        // Integers in units of 1/to of a source texel: exact, so that a whole factor gives equal weights.
        const std::int64_t begin = std::int64_t{i} * from;
        const std::int64_t end = begin + from;
        Coverage& coverage = all[static_cast<std::size_t>(i)];
        coverage.first = static_cast<int>(begin / to);
        for (std::int64_t j = coverage.first; j * to < end; ++j) {
            const std::int64_t covered = std::min(end, (j + 1) * to) - std::max(begin, j * to);
            coverage.weights.push_back(static_cast<double>(covered) / from);
        }
    }
    return all;
}

}  // namespace etalon
