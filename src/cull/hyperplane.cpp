// hyperplane: for each edge of the triangle two planes in (x, y, u, v, t), over a tile.
//
// The second test of Munkberg & Akenine-Moller 2012, Hyperplane Culling for Stochastic Rasterization, known to us by
// its abstract and claims; the planes are our own derivation (docs/develop/algorithms.md 4.8). About the middle of
// footprint, lens and shutter, an edge function is
//
//     e = cr(A,B) + a*cr(Cu,B) + b*cr(A,Cv) - dx*cr(W,B) - dy*cr(A,W) - a*dy*cr(Cu,W) + b*dx*cr(Cv,W)
//
// with cr(p,q) = p1*q2 - p2*q1, a quadratic in s. Its linear part is a plane; how far the rest can be on the domain
// moves it up to a plane above e and down to one below. A sample at which the upper plane of one edge is negative does
// not see the front, one at which a lower plane is positive does not see the back. Planes know the edges, where all
// bounds by x and y alone know the triangle's extents only: the one family that gets past 42 % of a large triangle's
// box.
//
// The domain is first cut to the intervals of dual-space (4.4): the rest shrinks with its square.
//
// Rounding: edge_slack() for the exact test; the planes' numbers are made in double and rounded to float, and their
// evaluation adds six roundings of no more than the sum of all terms: 8 unit roundoffs of that are added.

#include "cull/cull_edges.h"
#include "cull/cull_intervals.h"

namespace pentaprism {
namespace {

struct Planes {
    float kx, ky, ku, kv, ks;
    float above, below;  // constants of the two planes
};
struct State {
    Intervals intervals;
    float x, y, u, v, s;  // the middle
    bool front, back;
    Planes edges[3];
};

// p(s) = mean + s * difference, s in [-1/2, 1/2], for the two corners of an edge.
struct Pair {
    double mean1, difference1, mean2, difference2;
};

struct Quadratic {
    double z0, z1, z2;
    double largest() const { return std::abs(z0) + 0.5 * std::abs(z1) + 0.25 * std::abs(z2); }
    double middle() const { return z0 + 0.125 * z2; }  // the constant that is closest: s^2 is in [0, 1/4]
    double off_middle() const { return 0.5 * std::abs(z1) + 0.125 * std::abs(z2); }
};

Quadratic cross(const Pair& p, const Pair& q) {
    return {p.mean1 * q.mean2 - p.mean2 * q.mean1,
            p.mean1 * q.difference2 + p.difference1 * q.mean2 - p.mean2 * q.difference1 - p.difference2 * q.mean1,
            p.difference1 * q.difference2 - p.difference2 * q.difference1};
}

// The middle and the half widths of all that is asked about.
struct Box {
    double x, y, u, v, hx, hy, hu, hv;
};

// A quantity of corners i and j, made from the axis' numbers at each end.
template <class Value>
Pair pair_of(int i, int j, Value&& value) {
    const double i0 = value(i, 0), i1 = value(i, 1), j0 = value(j, 0), j1 = value(j, 1);
    return {0.5 * (i0 + i1), i1 - i0, 0.5 * (j0 + j1), j1 - j0};
}

Planes planes_of_edge(const Axis& x, const Axis& y, const Box& box, int i, int j, double slack, double width_s) {
    const Pair A = pair_of(i, j, [&](int k, int e) { return x.p[k][e] + box.u * x.c[k][e] - box.x * x.w[k][e]; });
    const Pair B = pair_of(i, j, [&](int k, int e) { return y.p[k][e] + box.v * y.c[k][e] - box.y * y.w[k][e]; });
    const Pair Cu = pair_of(i, j, [&](int k, int e) { return box.hu * x.c[k][e]; });
    const Pair Cv = pair_of(i, j, [&](int k, int e) { return box.hv * y.c[k][e]; });
    const Pair W = pair_of(i, j, [&](int k, int e) { return x.w[k][e]; });
    const Quadratic ab = cross(A, B), ub = cross(Cu, B), av = cross(A, Cv), wb = cross(W, B), aw = cross(A, W),
                    uw = cross(Cu, W), vw = cross(Cv, W);
    const double rest = ub.off_middle() + av.off_middle() + box.hx * wb.off_middle() + box.hy * aw.off_middle() +
                        box.hy * uw.largest() + box.hx * vw.largest();
    const double kx = -wb.middle(), ky = -aw.middle(), ku = ub.middle(), kv = av.middle(), ks = ab.z1;
    const double above = ab.z0 + 0.25 * std::max(ab.z2, 0.0) + rest, below = ab.z0 + 0.25 * std::min(ab.z2, 0.0) - rest;
    const double terms = std::max(std::abs(above), std::abs(below)) + box.hx * std::abs(kx) + box.hy * std::abs(ky) +
                         std::abs(ku) + std::abs(kv) + 0.5 * std::abs(ks);
    const double out = slack + 8.0 * kUnitRoundoff * terms;
    const auto per = [](double k, double width) { return static_cast<float>(width > 0 ? k / width : 0.0); };
    return {static_cast<float>(kx),
            static_cast<float>(ky),
            per(ku, box.hu),
            per(kv, box.hv),
            per(ks, width_s),
            static_cast<float>(above + out),
            static_cast<float>(below - out)};
}

// What the linear part of the plane is at most, over the whole domain; generous, for the whole footprint at once.
float reach(const Planes& p, const Box& box, double width_s) {
    return static_cast<float>(1.0001 * (box.hx * std::abs(p.kx) + box.hy * std::abs(p.ky) + box.hu * std::abs(p.ku) +
                                        box.hv * std::abs(p.kv) + 0.5 * width_s * std::abs(p.ks)));
}

bool prepare(const LocalTriangle& T, const Footprint& footprint, CullState& memory) {
    SegmentDomain domain = segment_domain(T, footprint.domain);
    if (!narrow_domain(T, footprint, domain)) return false;
    State& state = memory.as<State>();
    state.intervals = {domain, segment_time(T)};
    state.x = 0.5f * (footprint.x0 + footprint.x1);
    state.y = 0.5f * (footprint.y0 + footprint.y1);
    state.u = 0.5f * (domain.u0 + domain.u1);
    state.v = 0.5f * (domain.v0 + domain.v1);
    state.s = 0.5f * (domain.s0 + domain.s1);
    // Half widths about the rounded middle.
    const auto half = [](float middle, float low, float high) {
        return std::max(double{high} - middle, double{middle} - low);
    };
    const Box box{state.x,
                  state.y,
                  state.u,
                  state.v,
                  half(state.x, footprint.x0, footprint.x1),
                  half(state.y, footprint.y0, footprint.y1),
                  half(state.u, domain.u0, domain.u1),
                  half(state.v, domain.v0, domain.v1)};
    // s - middle lies in [-1/2, 1/2] times this width; the ends of the axes are those of that range.
    const double width_s = 2.0 * half(state.s, domain.s0, domain.s1);
    Axis x, y;
    axes_at_ends(T, domain.s0, domain.s1, x, y);
    const AxisRange rx = x_range(footprint, domain), ry = y_range(footprint, domain);
    const double slack = edge_slack(x, y, rx, ry);
    const Sides sides = visible_sides(T, domain);
    state.front = sides.front;
    state.back = sides.back;
    for (int k = 0; k < 3; ++k) {
        state.edges[k] = planes_of_edge(x, y, box, (k + 1) % 3, (k + 2) % 3, slack, width_s);
        const float r = reach(state.edges[k], box, width_s);
        if (state.edges[k].above + r < 0) state.front = false;
        if (state.edges[k].below - r > 0) state.back = false;
    }
    return state.front || state.back;
}

bool keeps(const CullState& memory, const LocalSample& sample) {
    const State& state = memory.as<State>();
    if (!state.intervals.keep(sample)) return false;
    const float x = sample.hx - state.x, y = sample.hy - state.y, u = sample.u - state.u, v = sample.v - state.v,
                s = state.intervals.time(sample.t) - state.s;
    bool front = state.front, back = state.back;
    for (const Planes& p : state.edges) {
        const float linear = std::fma(p.kx, x, std::fma(p.ky, y, std::fma(p.ku, u, std::fma(p.kv, v, p.ks * s))));
        if (p.above + linear < 0) front = false;
        if (p.below + linear > 0) back = false;
    }
    return front || back;
}

}  // namespace

extern const CullTest hyperplane_test;
const CullTest hyperplane_test{"hyperplane", "Munkberg & Akenine-Moller 2012, Hyperplane Culling", prepare, keeps,
                               Grain::kTile};

}  // namespace pentaprism
