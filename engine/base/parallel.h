#pragma once
#include <cstddef>
#include <functional>

namespace etalon {

/// Calls `body(i)` once for each i in [0, count), on up to `threads` threads (0: one per core), in no fixed order.
/// Returns when all are done; the exception of the lowest index that threw is rethrown then. Results must not depend
/// on the order: every i writes to its own place. Nested calls run on the calling thread.
void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body, unsigned threads = 0);

}  // namespace etalon
