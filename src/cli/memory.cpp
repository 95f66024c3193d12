#include "cli/memory.h"

#ifdef PENTAPRISM_HAVE_MIMALLOC
#include <cstddef>
#include <mimalloc.h>
#include <new>

namespace {

void* checked(void* place) {
    if (place == nullptr) throw std::bad_alloc();
    return place;
}

}  // namespace

// mimalloc is written in C: its own operator new ends the program where memory does, instead of throwing.
void* operator new(std::size_t size) {
    return checked(mi_malloc(size));
}
void* operator new[](std::size_t size) {
    return checked(mi_malloc(size));
}
void* operator new(std::size_t size, std::align_val_t alignment) {
    return checked(mi_malloc_aligned(size, static_cast<std::size_t>(alignment)));
}
void* operator new[](std::size_t size, std::align_val_t alignment) {
    return checked(mi_malloc_aligned(size, static_cast<std::size_t>(alignment)));
}
void operator delete(void* place) noexcept {
    mi_free(place);
}
void operator delete[](void* place) noexcept {
    mi_free(place);
}
void operator delete(void* place, std::size_t) noexcept {
    mi_free(place);
}
void operator delete[](void* place, std::size_t) noexcept {
    mi_free(place);
}
void operator delete(void* place, std::align_val_t) noexcept {
    mi_free(place);
}
void operator delete[](void* place, std::align_val_t) noexcept {
    mi_free(place);
}
void operator delete(void* place, std::size_t, std::align_val_t) noexcept {
    mi_free(place);
}
void operator delete[](void* place, std::size_t, std::align_val_t) noexcept {
    mi_free(place);
}
#endif

namespace pentaprism::cli {

void ask_for_huge_pages() {
#ifdef PENTAPRISM_HAVE_MIMALLOC
    mi_option_set_enabled_default(mi_option_large_os_pages, true);
#endif
}

}  // namespace pentaprism::cli
