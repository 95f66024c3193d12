// Gathers of bytes, four at once.

#if defined(PENTAPRISM_BASE_BYTES_AT_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef PENTAPRISM_BASE_BYTES_AT_INL_H
#undef PENTAPRISM_BASE_BYTES_AT_INL_H
#else
#define PENTAPRISM_BASE_BYTES_AT_INL_H
#endif

#include <cstdint>
#include <cstring>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace pentaprism {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// The four bytes that begin at each place, the first of them lowest; places may be any below 2^31, and three bytes more
// than there are places must be readable.
template <class I>
HWY_INLINE hn::Vec<I> bytes_at(I d, const std::uint8_t* bytes, hn::Vec<I> places) {
#if HWY_TARGET == HWY_SCALAR  // where words must lie on their own borders
    std::int32_t word;
    std::memcpy(&word, bytes + hn::GetLane(places), sizeof word);
    return hn::Set(d, word);
#else
    return hn::GatherOffset(d, reinterpret_cast<const std::int32_t*>(bytes), places);
#endif
}

}  // namespace HWY_NAMESPACE
}  // namespace pentaprism
HWY_AFTER_NAMESPACE();

#endif
