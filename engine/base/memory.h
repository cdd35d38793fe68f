#pragma once
#include <cstdint>

namespace etalon {

/// Bytes of memory that this process can ever have: the machine's, or less where a control group (version 1 or 2, any
/// of those above it) or the limit of its address space says so.
std::uint64_t memory_of_machine();

/// Bytes of address space that this process may still take; all there can be where it has no limit (ulimit -v).
std::uint64_t address_space_left();

/// Bytes that this process holds now (resident) and the most that it ever held.
std::uint64_t memory_held();
std::uint64_t memory_peak();

/// For `main`, first of all: where an allocation fails in a destructor (that of a JSON document, of a library) and the
/// program must end, it says "out of memory" and ends with the exit code of Blame::machine instead of a signal.
void exit_when_out_of_memory();

}  // namespace etalon
