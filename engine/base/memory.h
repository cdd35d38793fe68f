#pragma once
#include <cstdint>

namespace etalon {

/// Bytes of memory that this process can ever have: the machine's, or less where a control group (version 1 or 2, any
/// of those above it) or the limit of its address space says so.
std::uint64_t memory_of_machine();

/// Bytes that this process holds now (resident) and the most that it ever held.
std::uint64_t memory_held();
std::uint64_t memory_peak();

}  // namespace etalon
