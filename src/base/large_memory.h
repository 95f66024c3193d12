#pragma once
// Memory of megabytes, in huge pages where the system gives them to who asks: a fault for each of thousands of small
// pages may cost more than the work on what is in them (docs/develop/performance.md, Against Embree).

#include <cstddef>

namespace pentaprism {

void* allocate_large(std::size_t bytes);
void free_large(void* place);

/// From here on it pays; one huge page.
inline constexpr std::size_t kLargeMemory = 2 << 20;

}  // namespace pentaprism
