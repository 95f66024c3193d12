#pragma once
// What bounds by edge functions share (docs/develop/algorithms.md 4.2, 4.8, 4.9): the slack, and which side may be
// seen.

#include "bound/facing.h"
#include "cull/cull_axis.h"

namespace pentaprism {

/// max |X_i| over footprint, lens and time: at a corner of them.
inline double largest_delta(const Axis& axis, const AxisRange& range) {
    double largest = 0;
    for (int i = 0; i < 3; ++i)
        for (int end = 0; end < 2; ++end)
            for (const double lens : {range.lens0, range.lens1})
                for (const double g : {range.g0, range.g1})
                    largest = std::max(largest, std::abs(axis.p[i][end] + lens * axis.c[i][end] - g * axis.w[i][end]));
    return largest;
}

/// How far an edge function of the exact test may be off: X_i Y_j - X_j Y_i, where each X is off by 5 unit roundoffs of
/// its magnitude and no larger than `largest_delta`; three more roundings, each of a number below twice the product of
/// the deltas, which the magnitudes exceed. At most 2*5 + 3*2 of the sum below; the rest is for the middle of s, which
/// a test may round.
inline double edge_slack(const Axis& x, const Axis& y, const AxisRange& rx, const AxisRange& ry) {
    return 24.0 * kUnitRoundoff *
           (magnitude(x, rx.lens()) * largest_delta(y, ry) + magnitude(y, ry.lens()) * largest_delta(x, rx));
}

/// Sides of the triangle that samples may see. An edge function that is negative refuses the front alone, so of a
/// triangle of which both sides may be seen each needs an edge that refuses it.
struct Sides {
    bool front, back;
};
inline Sides visible_sides(const LocalTriangle& T, const SegmentDomain& domain) {
    const Facing side = facing(T, domain);
    return {side != Facing::kBack, side != Facing::kFront && T.two_sided};
}

}  // namespace pentaprism
