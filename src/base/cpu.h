#pragma once
// Which CPU target the vector kernels run on.

#include <cstdint>
#include <string>

namespace pentaprism {

enum class Isa : std::uint8_t { kScalar, kNeon, kAvx2, kAvx512 };

/// The environment's PENTAPRISM_ISA (avx512, avx2, neon, scalar), else the best that both this processor and this build
/// have. Throws Error(kUsage) for a name that is unknown or not to be had. Read once for each frame, so tests may
/// change it.
Isa cpu_isa();

const char* isa_name(Isa isa);

}  // namespace pentaprism
