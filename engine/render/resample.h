#pragma once
#include <vector>

namespace etalon {

/// The texels that one texel of a box-resampled axis covers, with the share of it that each takes.
struct Coverage {
    int first = 0;
    std::vector<double> weights;  ///< of texels first, first + 1 …; their sum is 1
};

/// For each of `to` texels laid over `from` texels of the same axis: the exact box average, polyphase where the sizes
/// do not divide (TX-4), (SH-41); promise T8. Both at least 1.
std::vector<Coverage> coverages(int from, int to);

}  // namespace etalon
