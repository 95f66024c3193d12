// Compiled once for each CPU target; the same operations in the same order, none of them fused.

#include "shade/bound_casters.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "shade/bound_casters.cpp"
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4)
#include <hwy/foreach_target.h>
// foreach_target.h must come first.
#include <hwy/highway.h>

#include "shade/light_view-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pentaprism {
namespace HWY_NAMESPACE {

std::uint32_t bound(const WorldMotion& world, const Part& part, const LightView& view, const CasterBatch& batch,
                    CasterBounds& out) {
    static_assert(CasterBatch::kLanes == kLanes);
    const F f;
    const I d;
    const std::uint32_t shift = world.shifts[world.frame->part_of[batch.triangle[0]]];
    alignas(64) std::int32_t corner[kLanes], knot[kLanes];  // of lanes that are not used the first one's
    for (int lane = 0; lane < kLanes; ++lane) {
        const int from = lane < batch.count ? lane : 0;
        corner[lane] = static_cast<std::int32_t>(3 * batch.triangle[from]);
        knot[lane] = static_cast<std::int32_t>(batch.segment[from] * part.vertex_count + shift);
    }
    const auto* corners = reinterpret_cast<const std::int32_t*>(world.frame->corners.data());
    const hn::Vec<I> step = hn::Set(d, static_cast<std::int32_t>(part.vertex_count));
    const Vec largest = hn::Set(f, kLargestOfCasters), near = hn::Set(f, kNearestToLight), one = hn::Set(f, 1.0f);
    std::uint32_t bounded = 0;
    for (int first = 0; first < kLanes; first += kWidth) {
        Vec x0 = hn::Set(f, INFINITY), y0 = x0, least = x0, x1 = hn::Set(f, -INFINITY), y1 = x1, most = x1;
        Mask usable = hn::Eq(one, one);
        for (int k = 0; k < 3; ++k) {
            const hn::Vec<I> index = hn::Add(hn::Load(d, corner + first), hn::Set(d, k));
            hn::Vec<I> at = hn::Add(hn::GatherIndex(d, corners, index), hn::Load(d, knot + first));
            for (int end = 0; end < (part.moves ? 2 : 1); ++end, at = hn::Add(at, step)) {
                const PlacedPoints p = placed(f, view, world.points, at);
                const Vec w = view.perspective ? p.z : one, inverse = hn::Div(one, w);
                const Vec x = hn::Mul(p.x, inverse), y = hn::Mul(p.y, inverse);
                x0 = hn::Min(x0, x), x1 = hn::Max(x1, x);
                y0 = hn::Min(y0, y), y1 = hn::Max(y1, y);
                least = hn::Min(least, p.z), most = hn::Max(most, p.z);
                const Mask small = hn::And(hn::Le(hn::Abs(p.x), largest), hn::Le(hn::Abs(p.y), largest));
                usable = hn::And(usable, hn::And(small, hn::Le(hn::Abs(p.z), largest)));
                usable = hn::And(usable, hn::Ge(w, near));
            }
        }
        // As in screen_bounds(), where |x| <= w * reach; half as much again for the operations here.
        const Vec spread = view.perspective ? hn::Div(most, least) : one;
        const Vec slack = hn::Mul(hn::Set(f, 24.0f * kUnitRoundoff), spread);
        const auto slack_of = [&](Vec low, Vec high) HWY_ATTR {
            const Vec size = hn::Max(hn::Abs(low), hn::Abs(high));
            return hn::Mul(slack, hn::Add(hn::Set(f, 32.0f), hn::Add(size, size)));
        };
        const Vec slack_x = slack_of(x0, x1), slack_y = slack_of(y0, y1);
        hn::Store(hn::Sub(x0, slack_x), f, out.x0 + first);
        hn::Store(hn::Add(x1, slack_x), f, out.x1 + first);
        hn::Store(hn::Sub(y0, slack_y), f, out.y0 + first);
        hn::Store(hn::Add(y1, slack_y), f, out.y1 + first);
        const Vec deepest = hn::Max(hn::Abs(least), hn::Abs(most));
        hn::Store(hn::Sub(least, hn::Mul(hn::Set(f, kDepthRounding), deepest)), f, out.nearest + first);
        bounded |= static_cast<std::uint32_t>(bits_of(f, usable)) << first;
    }
    return bounded & ((1u << batch.count) - 1u);
}

}  // namespace HWY_NAMESPACE
}  // namespace pentaprism
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include "base/cpu_dispatch.h"

namespace pentaprism {

BoundCasters bound_casters() {
    PENTAPRISM_RETURN_FOR_CPU(bound);
    return HWY_STATIC_DISPATCH(bound);
}

}  // namespace pentaprism
#endif
