// Twin of cull/cull_edges.h: the slack of bounds by edge functions, and which side may be seen.

#include "bound/facing.glsl"
#include "cull/cull_axis.glsl"

// max |X_i| over footprint, lens and time: at a corner of them.
double largest_delta(Axis axis, AxisRange range) {
    double found = 0.0lf;
    for (int end = 0; end < 2; ++end)
        for (int k = 0; k < 4; ++k) {
            double lens = (k & 1) == 0 ? range.lens0 : range.lens1, g = k < 2 ? range.g0 : range.g1;
            found = max(found, largest(abs(axis.p[end] + lens * axis.c[end] - g * axis.w[end])));
        }
    return found;
}

double edge_slack(Axis x, Axis y, AxisRange rx, AxisRange ry) {
    return 24.0lf * kUnitRoundoff * (magnitude(x, rx) * largest_delta(y, ry) + magnitude(y, ry) * largest_delta(x, rx));
}

// Sides of the triangle that samples may see.
struct Sides {
    bool front, back;
};

Sides visible_sides(LocalTriangle T, SegmentDomain domain) {
    int side = facing(T, domain);
    return Sides(side != kBack, side != kFront && T.two_sided);
}
