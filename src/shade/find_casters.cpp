// Three levels, sixteen boxes at a time. Compiled once for each CPU target.

#include "shade/find_casters.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "shade/find_casters.cpp"
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4)
#include <hwy/foreach_target.h>
// foreach_target.h must come first.
#include <bit>
#include <hwy/highway.h>

#include "cover/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pentaprism {
namespace HWY_NAMESPACE {
namespace {

static_assert(Casters::kLanes == kLanes);

// A bit for each of the sixteen that touch what is asked for.
HWY_INLINE std::uint32_t touching(const Casters::Extents& extents, const CasterQuery& query) {
    const F f;
    const I d;
    const hn::Rebind<std::uint8_t, I> bytes;
    std::uint32_t bits = 0;
    for (int first = 0; first < kLanes; first += kWidth) {
        const Mask x = hn::And(hn::Le(hn::LoadU(f, extents.x0 + first), hn::Set(f, query.x1)),
                               hn::Ge(hn::LoadU(f, extents.x1 + first), hn::Set(f, query.x0)));
        const Mask y = hn::And(hn::Le(hn::LoadU(f, extents.y0 + first), hn::Set(f, query.y1)),
                               hn::Ge(hn::LoadU(f, extents.y1 + first), hn::Set(f, query.y0)));
        const hn::Vec<I> limit = hn::PromoteTo(d, hn::LoadU(bytes, extents.limit + first));
        const Mask before = hn::RebindMask(f, hn::Lt(limit, hn::Set(d, query.limit + 1)));
        bits |= static_cast<std::uint32_t>(bits_of(f, hn::And(hn::And(x, y), before))) << first;
    }
    return bits;
}

}  // namespace

std::size_t find(const Casters& casters, const CasterQuery& query, std::vector<std::uint32_t>& out) {
    std::size_t count = 0;
    const auto for_each = [](std::uint32_t bits, std::size_t first, const auto& visit) HWY_ATTR {
        for (; bits != 0; bits &= bits - 1) visit(first + static_cast<std::size_t>(std::countr_zero(bits)));
    };
    const auto visit_boxes = [&](std::size_t i) HWY_ATTR {
        if (out.size() < count + kLanes) out.resize(2 * (count + kLanes));
        // Even if none is: a branch that is guessed wrong would wait for memory.
        const std::uint32_t bits = touching(casters.boxes[i], query);
        count += write_lanes(static_cast<std::uint32_t>(i * kLanes), bits, out.data() + count);
    };
    const auto visit_group = [&](std::size_t i)
                                 HWY_ATTR { for_each(touching(casters.groups[i], query), i * kLanes, visit_boxes); };
    for (std::size_t i = 0; i < casters.groups_of_groups.size(); ++i)
        for_each(touching(casters.groups_of_groups[i], query), i * kLanes, visit_group);
    return count;
}

}  // namespace HWY_NAMESPACE
}  // namespace pentaprism
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include "base/cpu_dispatch.h"

namespace pentaprism {

FindCasters find_casters() {
    PENTAPRISM_RETURN_FOR_CPU(find);
    return HWY_STATIC_DISPATCH(find);
}

}  // namespace pentaprism
#endif
