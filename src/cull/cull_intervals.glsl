// Twin of cull/cull_intervals.h: the part of lens and shutter in which a footprint can be hit, one interval for each of u,
// v and s (Laine, Aila, Karras, Lehtinen 2011; docs/develop/algorithms.md 4.4).

#include "cull/cull_axis.glsl"

// f is affine, a at `low` and b at `high`; narrows to where f >= 0. False: nowhere between.
bool narrow(double a, double b, double low, double high, inout float out_low, inout float out_high) {
    const double kOut = 1e-5lf;
    if (a < 0.0lf && b < 0.0lf) return false;
    double root = low + (high - low) * (a / (a - b));
    if (a < 0.0lf) out_low = max(out_low, float(root - kOut));
    if (b < 0.0lf) out_high = min(out_high, float(root + kOut));
    return true;
}

// Narrows the lens coordinate and s by one axis' corner bounds. False: the footprint cannot be hit.
bool narrow_axis(CornerBounds m, inout float lens0, inout float lens1, inout float s0, inout float s1) {
    double l0 = lens0, l1 = lens1, t0 = s0, t1 = s1;
    dvec2 upper_in_time = max(m.upper[0], m.upper[1]), lower_in_time = min(m.lower[0], m.lower[1]);
    return narrow(upper_in_time[0], upper_in_time[1], t0, t1, s0, s1) &&
           narrow(-lower_in_time[0], -lower_in_time[1], t0, t1, s0, s1) &&
           narrow(max(m.upper[0][0], m.upper[0][1]), max(m.upper[1][0], m.upper[1][1]), l0, l1, lens0, lens1) &&
           narrow(-min(m.lower[0][0], m.lower[0][1]), -min(m.lower[1][0], m.lower[1][1]), l0, l1, lens0, lens1);
}

// Narrows the domain to what of it can hit the footprint. False: nothing can.
bool narrow_domain(LocalTriangle T, Footprint footprint, inout SegmentDomain domain) {
    if (is_empty(domain)) return false;
    Axis x, y;
    axes_at_ends(T, domain.s0, domain.s1, x, y);
    CornerBounds cx = corner_bounds(x, x_range(footprint, domain)), cy = corner_bounds(y, y_range(footprint, domain));
    SegmentDomain by_x = domain, by_y = domain;
    if (!narrow_axis(cx, by_x.u0, by_x.u1, by_x.s0, by_x.s1)) return false;
    if (!narrow_axis(cy, by_y.v0, by_y.v1, by_y.s0, by_y.s1)) return false;
    domain = SegmentDomain(by_x.u0, by_x.u1, by_y.v0, by_y.v1, max(by_x.s0, by_y.s0), min(by_x.s1, by_y.s1));
    return !is_empty(domain);
}

bool is_within(SegmentDomain d, LocalSample sampled, float s) {
    return s >= d.s0 && s <= d.s1 && sampled.u >= d.u0 && sampled.u <= d.u1 && sampled.v >= d.v0 && sampled.v <= d.v1;
}
