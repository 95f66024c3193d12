#include "base/large_memory.h"

#include <new>
#include <sys/mman.h>

namespace pentaprism {
namespace {

constexpr std::align_val_t kHugePage{kLargeMemory};

}  // namespace

void* allocate_large(std::size_t bytes) {
    void* place = ::operator new(bytes, kHugePage);
    madvise(place, bytes, MADV_HUGEPAGE);  // a wish: what the system says does not matter
    return place;
}

void free_large(void* place) {
    ::operator delete(place, kHugePage);
}

}  // namespace pentaprism
