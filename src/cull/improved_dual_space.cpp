// improved-dual-space: bilinear bounds in (u, t) and (v, t) over a footprint of the screen.
//
// Laine & Karras 2011, Improved Dual-Space Bounds for Simultaneous Motion and Defocus Blur. For one vertex
// X(gx,u,t) = x(t) + u*c(t) - gx*w(t) is affine in each of gx, u and t. A sample can only hit if max X_i >= 0 >= min
// X_i (docs/develop/algorithms.md 1.5). With the footprint's middle gc and half width hg, the corner value over the
// footprint is X(gc) + hg*|w| at most, and interpolating the maxima over the vertices at the four (u,t) corners bounds
// max X_i inside. No division, valid for every sign of w and c. We evaluate the corners directly for each footprint
// instead of interpolating slices of the triangle's whole extent as printed (improved_dual_space_as_printed.cpp): it is
// tighter, and needs no guard for empty ranges.
//
// Rounding, in unit roundoffs of the magnitude: 5 in the exact test, 5 in the four float coefficients, 3 in each of
// lens and time as fractions, 9 in the evaluation: less than the 32 by which the corners are moved out.

#include "cull/cull_axis.h"

namespace pentaprism {
namespace {

bool prepare(const LocalTriangle& T, const Footprint& footprint, CullState& state) {
    const SegmentDomain domain = segment_domain(T, footprint.domain);
    if (domain.empty()) return false;
    Axis x, y;
    axes_at_ends(T, domain.s0, domain.s1, x, y);
    const CornerBounds cx = corner_bounds(x, x_range(footprint, domain));
    if (cx.refused()) return false;
    const CornerBounds cy = corner_bounds(y, y_range(footprint, domain));
    if (cy.refused()) return false;
    state.as<Slices>() = Slices(T, domain, cx, cy);
    return true;
}

bool keeps(const CullState& state, const LocalSample& sample) {
    return state.as<Slices>().keep(sample);
}

}  // namespace

extern const CullTest improved_dual_space_test;
const CullTest improved_dual_space_test{"improved-dual-space", "Laine & Karras 2011, Improved Dual-Space Bounds",
                                        prepare, keeps};

}  // namespace pentaprism
