// dual-space: an interval of u, one of v and one of t for each footprint.
//
// Laine, Aila, Karras, Lehtinen 2011, Clipless Dual-Space Bounds for Faster Stochastic Rasterization. Known to us by
// its abstract and slides: lens bounds from the screen position being affine in u, time bounds from the deltas being
// affine in t, each for the whole range of the other. We take both from the corner values of
// docs/develop/algorithms.md 4.1 (form and proof: cull_intervals.h). Tight where only one of motion and defocus blurs;
// where both do, each interval must allow for all of the other, and little is refused: what the improved bounds are
// for.
//
// Rounding: the corners carry the slack of 4.2, the interval's ends that of the division.

#include "cull/cull_intervals.h"

namespace pentaprism {
namespace {

bool prepare(const LocalTriangle& T, const Footprint& footprint, CullState& state) {
    SegmentDomain domain = segment_domain(T, footprint.domain);
    if (!narrow_domain(T, footprint, domain)) return false;
    state.as<Intervals>() = {domain, segment_time(T)};
    return true;
}

bool keeps(const CullState& state, const LocalSample& sample) {
    return state.as<Intervals>().keep(sample);
}

}  // namespace

extern const CullTest dual_space_test;
const CullTest dual_space_test{"dual-space", "Laine, Aila, Karras, Lehtinen 2011, Clipless Dual-Space Bounds", prepare,
                               keeps};

}  // namespace pentaprism
