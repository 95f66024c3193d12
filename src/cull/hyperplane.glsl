// Twin of hyperplane.cpp: for each edge of the triangle two planes in (x, y, u, v, t). The second test of Munkberg &
// Akenine-Moller 2012, Hyperplane Culling for Stochastic Rasterization; docs/develop/algorithms.md 4.8.

#include "cull/cull_edges.glsl"
#include "cull/cull_intervals.glsl"

struct Planes {
    float kx, ky, ku, kv, ks;
    float above, below;  // constants of the two planes
};

// p(s) = mean + s * difference, s in [-1/2, 1/2], for the two corners of an edge.
struct Pair {
    double mean1, difference1, mean2, difference2;
};

struct Quadratic {
    double z0, z1, z2;
};

double largest_of(Quadratic q) {
    return abs(q.z0) + 0.5lf * abs(q.z1) + 0.25lf * abs(q.z2);
}
double middle_of(Quadratic q) {  // the constant that is closest: s^2 is in [0, 1/4]
    return q.z0 + 0.125lf * q.z2;
}
double off_middle(Quadratic q) {
    return 0.5lf * abs(q.z1) + 0.125lf * abs(q.z2);
}

Quadratic cross_of(Pair p, Pair q) {
    return Quadratic(p.mean1 * q.mean2 - p.mean2 * q.mean1,
                     p.mean1 * q.difference2 + p.difference1 * q.mean2 - p.mean2 * q.difference1 -
                         p.difference2 * q.mean1,
                     p.difference1 * q.difference2 - p.difference2 * q.difference1);
}

// The middle and the half widths of all that is asked about.
struct Middle {
    double x, y, u, v, hx, hy, hu, hv;
};

// A quantity of corners i and j, given at each end.
Pair pair_of(int i, int j, dvec3 at_start, dvec3 at_end) {
    return Pair(0.5lf * (at_start[i] + at_end[i]), at_end[i] - at_start[i], 0.5lf * (at_start[j] + at_end[j]),
                at_end[j] - at_start[j]);
}

float per(double k, double width) {
    return width > 0.0lf ? float(k / width) : 0.0;
}

Planes planes_of_edge(Axis x, Axis y, Middle m, int i, int j, double slack, double width_s) {
    Pair A = pair_of(i, j, x.p[0] + m.u * x.c[0] - m.x * x.w[0], x.p[1] + m.u * x.c[1] - m.x * x.w[1]);
    Pair B = pair_of(i, j, y.p[0] + m.v * y.c[0] - m.y * y.w[0], y.p[1] + m.v * y.c[1] - m.y * y.w[1]);
    Pair Cu = pair_of(i, j, m.hu * x.c[0], m.hu * x.c[1]), Cv = pair_of(i, j, m.hv * y.c[0], m.hv * y.c[1]);
    Pair W = pair_of(i, j, x.w[0], x.w[1]);
    Quadratic ab = cross_of(A, B), ub = cross_of(Cu, B), av = cross_of(A, Cv), wb = cross_of(W, B), aw = cross_of(A, W),
              uw = cross_of(Cu, W), vw = cross_of(Cv, W);
    double rest = off_middle(ub) + off_middle(av) + m.hx * off_middle(wb) + m.hy * off_middle(aw) +
                  m.hy * largest_of(uw) + m.hx * largest_of(vw);
    double kx = -middle_of(wb), ky = -middle_of(aw), ku = middle_of(ub), kv = middle_of(av), ks = ab.z1;
    double above = ab.z0 + 0.25lf * max(ab.z2, 0.0lf) + rest, below = ab.z0 + 0.25lf * min(ab.z2, 0.0lf) - rest;
    double terms =
        max(abs(above), abs(below)) + m.hx * abs(kx) + m.hy * abs(ky) + abs(ku) + abs(kv) + 0.5lf * abs(ks);
    double out_by = slack + 8.0lf * kUnitRoundoff * terms;
    return Planes(float(kx), float(ky), per(ku, m.hu), per(kv, m.hv), per(ks, width_s), float(above + out_by),
                  float(below - out_by));
}

// What the linear part of the plane is at most, over the whole domain; generous, for the whole footprint at once.
float reach(Planes p, Middle m, double width_s) {
    return float(1.0001lf * (m.hx * abs(p.kx) + m.hy * abs(p.ky) + m.hu * abs(p.ku) + m.hv * abs(p.kv) +
                             0.5lf * width_s * abs(p.ks)));
}

double half_about(float middle, float low, float high) {
    return max(double(high) - double(middle), double(middle) - double(low));
}

bool hyperplane_keeps(LocalTriangle T, Footprint f, LocalSample sampled) {
    SegmentDomain d = segment_domain(T, f.domain);
    float time = segment_time(T, sampled.t);
    if (!narrow_domain(T, f, d) || !is_within(d, sampled, time)) return false;
    float x0 = 0.5 * (f.x0 + f.x1), y0 = 0.5 * (f.y0 + f.y1), u0 = 0.5 * (d.u0 + d.u1), v0 = 0.5 * (d.v0 + d.v1);
    float s0 = 0.5 * (d.s0 + d.s1);
    Middle m = Middle(x0, y0, u0, v0, half_about(x0, f.x0, f.x1), half_about(y0, f.y0, f.y1),
                      half_about(u0, d.u0, d.u1), half_about(v0, d.v0, d.v1));
    // s - middle lies in [-1/2, 1/2] times this width; the ends of the axes are those of that range.
    double width_s = 2.0lf * half_about(s0, d.s0, d.s1);
    Axis x, y;
    axes_at_ends(T, d.s0, d.s1, x, y);
    double slack = edge_slack(x, y, x_range(f, d), y_range(f, d));
    Sides sides = visible_sides(T, d);
    for (int k = 0; k < 3; ++k) {
        Planes p = planes_of_edge(x, y, m, (k + 1) % 3, (k + 2) % 3, slack, width_s);
        float r = reach(p, m, width_s);
        float at = fused(p.kx, sampled.hx - x0,
                         fused(p.ky, sampled.hy - y0,
                               fused(p.ku, sampled.u - u0, fused(p.kv, sampled.v - v0, p.ks * (time - s0)))));
        if (p.above + r < 0.0 || p.above + at < 0.0) sides.front = false;
        if (p.below - r > 0.0 || p.below + at > 0.0) sides.back = false;
    }
    return sides.front || sides.back;
}
