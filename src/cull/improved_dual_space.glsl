// Twin of improved_dual_space.cpp: bilinear bounds in (u, t) and (v, t) over a footprint. Laine & Karras 2011, Improved
// Dual-Space Bounds for Simultaneous Motion and Defocus Blur.

#include "cull/cull_axis.glsl"

bool improved_dual_space_keeps(LocalTriangle T, Footprint footprint, LocalSample sampled) {
    SegmentDomain d = segment_domain(T, footprint.domain);
    if (is_empty(d)) return false;
    Axis x, y;
    axes_at_ends(T, d.s0, d.s1, x, y);
    CornerBounds cx = corner_bounds(x, x_range(footprint, d)), cy = corner_bounds(y, y_range(footprint, d));
    if (is_refused(cx) || is_refused(cy)) return false;
    float u = to_unit(sampled.u, d.u0, d.u1, -1.0lf), v = to_unit(sampled.v, d.v0, d.v1, -1.0lf);
    float s = to_unit(segment_time(T, sampled.t), d.s0, d.s1, 0.0lf);
    return bilinear(cx.upper, u, s) >= 0.0 && bilinear(cx.lower, u, s) <= 0.0 && bilinear(cy.upper, v, s) >= 0.0 &&
           bilinear(cy.lower, v, s) <= 0.0;
}
