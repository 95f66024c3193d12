// Twin of cull/cull_axis.h: the corner values that culling tests start from (docs/develop/algorithms.md 4.1), in double as
// there.

#include "bound/local_triangle.glsl"

// One axis of the three corners at both ends of a part of the shutter, index [end].
struct Axis {
    dvec3 p[2], c[2], w[2];
};

void axes_at_ends(LocalTriangle T, float s0, float s1, out Axis x, out Axis y) {
    for (int end = 0; end < 2; ++end) {
        double s = end == 0 ? s0 : s1;
        x.p[end] = dvec3(T.qx) + s * dvec3(T.dx);
        y.p[end] = dvec3(T.qy) + s * dvec3(T.dy);
        x.w[end] = y.w[end] = dvec3(T.qw) + s * dvec3(T.dw);
        x.c[end] = y.c[end] = dvec3(T.qc) + s * dvec3(T.dc);
    }
}

// The part of one axis that is asked about.
struct AxisRange {
    double g0, g1, lens0, lens1;
};

AxisRange x_range(Footprint f, SegmentDomain d) {
    return AxisRange(f.x0, f.x1, d.u0, d.u1);
}
AxisRange y_range(Footprint f, SegmentDomain d) {
    return AxisRange(f.y0, f.y1, d.v0, d.v1);
}

double magnitude(Axis axis, AxisRange range) {
    double lens = max(abs(range.lens0), abs(range.lens1)), found = 0.0lf;
    for (int end = 0; end < 2; ++end)
        found = max(found, largest(abs(axis.p[end]) + lens * abs(axis.c[end]) + 17.0lf * abs(axis.w[end])));
    return found;
}

// max X_i is at most the bilinear interpolation of `upper`, min X_i at least that of `lower`, index [lens end][time end].
struct CornerBounds {
    dvec2 upper[2], lower[2];
};

bool is_refused(CornerBounds m) {
    return max(max(m.upper[0].x, m.upper[0].y), max(m.upper[1].x, m.upper[1].y)) < 0.0lf ||
           min(min(m.lower[0].x, m.lower[0].y), min(m.lower[1].x, m.lower[1].y)) > 0.0lf;
}

CornerBounds corner_bounds(Axis axis, AxisRange range) {
    double middle = 0.5lf * (range.g0 + range.g1), half_width = 0.5lf * (range.g1 - range.g0);
    double slack = 32.0lf * kUnitRoundoff * magnitude(axis, range);
    CornerBounds m;
    for (int a = 0; a < 2; ++a)
        for (int k = 0; k < 2; ++k) {
            double lens = a == 0 ? range.lens0 : range.lens1;
            dvec3 x = axis.p[k] + lens * axis.c[k] - middle * axis.w[k], reach = half_width * abs(axis.w[k]);
            m.upper[a][k] = largest(x + reach) + slack;
            m.lower[a][k] = least(x - reach) - slack;
        }
    return m;
}

// Where a value is between the ends of a range: low -> from, high -> 1. A range without width gives `from`.
float to_unit(float value, double low, double high, double from) {
    double scale = high > low ? (1.0lf - from) / (high - low) : 0.0lf;
    return fused(value, float(scale), float(from - scale * low));
}

// The bilinear interpolation of corner values, by the lens in [-1, 1] and the shutter in [0, 1].
float bilinear(dvec2 m[2], float lens, float time) {
    double a = 0.5lf * (m[0][0] + m[1][0]), b = 0.5lf * (m[1][0] - m[0][0]);
    float c = float(0.5lf * (m[0][1] + m[1][1]) - a), d = float(0.5lf * (m[1][1] - m[0][1]) - b);
    precise float value = float(a) + float(b) * lens + time * (c + d * lens);
    return value;
}
