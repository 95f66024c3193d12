#pragma once
// What the numbers were measured on, and how much memory it took.

#include <pentaprism/bench.h>

namespace pentaprism {

BenchMachine this_machine();

/// Forgets the largest resident memory so far, where the system can (Linux).
void reset_peak_memory();

/// Largest resident memory since then, else since the process began; bytes.
std::int64_t peak_memory();

}  // namespace pentaprism
