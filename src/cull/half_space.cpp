// half-space: half planes of the lens, for each edge of the triangle and corner of a tile.
//
// Akenine-Moller, Toth, Munkberg, Hasselgren 2012, Efficient Depth of Field Rasterization using a Tile Test based on
// Half-Space Culling, known to us by its abstract. Of a triangle that stands still, an edge function at one place g is
// affine in (u, v): the plane through the edge and g cuts the lens into two half planes. It is affine in g as well, so
// its largest value over a tile is at one of the four corners: lens points on the wrong side for all four refuse the
// tile's samples (docs/develop/algorithms.md 4.9).
//
// For moving triangles, where the paper does not go, the coefficients are quadratics in s; any value between is a mean
// of the three Bernstein coefficients, so twelve half planes an edge must all refuse: conservative but weak.
//
// Rounding: edge_slack() for the exact test; 8 unit roundoffs of the three terms for the numbers' own.

#include "cull/cull_edges.h"

namespace pentaprism {
namespace {

// f0 + u*fu + v*fv of an edge at a corner of the tile, for one Bernstein coefficient in s.
struct HalfPlane {
    float f0, fu, fv;
};
struct State {
    bool front, back;
    int per_edge;  // 4 corners, times 3 if anything moves
    float slack[3];
    HalfPlane planes[3][12];
};

// Bernstein coefficients of p_i(s)*q_j(s) - p_j(s)*q_i(s), values given at both ends.
struct Bernstein {
    double b[3];
};
Bernstein cross(const double pi[2], const double pj[2], const double qi[2], const double qj[2]) {
    return {{pi[0] * qj[0] - pj[0] * qi[0], 0.5 * (pi[0] * qj[1] + pi[1] * qj[0] - pj[0] * qi[1] - pj[1] * qi[0]),
             pi[1] * qj[1] - pj[1] * qi[1]}};
}

bool stands_still(const LocalTriangle& T) {
    for (int i = 0; i < 3; ++i)
        if (T.dx[i] != 0 || T.dy[i] != 0 || T.dw[i] != 0 || T.dc[i] != 0) return false;
    return true;
}

bool prepare(const LocalTriangle& T, const Footprint& footprint, CullState& memory) {
    const SegmentDomain domain = segment_domain(T, footprint.domain);
    if (domain.empty()) return false;
    State& state = memory.as<State>();
    Axis x, y;
    axes_at_ends(T, domain.s0, domain.s1, x, y);
    const AxisRange rx = x_range(footprint, domain), ry = y_range(footprint, domain);
    const double slack = edge_slack(x, y, rx, ry);
    const Sides sides = visible_sides(T, domain);
    state.front = sides.front;
    state.back = sides.back;
    const int degree_count = stands_still(T) ? 1 : 3;
    state.per_edge = 4 * degree_count;
    for (int k = 0; k < 3; ++k) {
        double largest = 0;
        for (int corner = 0; corner < 4; ++corner) {
            const double gx = corner % 2 == 0 ? rx.g0 : rx.g1, gy = corner / 2 == 0 ? ry.g0 : ry.g1;
            double X[2][2], Y[2][2], C[2][2];  // [corner of the edge][end]
            for (int n = 0; n < 2; ++n)
                for (int end = 0; end < 2; ++end) {
                    const int i = (k + 1 + n) % 3;
                    X[n][end] = x.p[i][end] - gx * x.w[i][end];
                    Y[n][end] = y.p[i][end] - gy * y.w[i][end];
                    C[n][end] = x.c[i][end];
                }
            const Bernstein e0 = cross(X[0], X[1], Y[0], Y[1]), eu = cross(C[0], C[1], Y[0], Y[1]),
                            ev = cross(X[0], X[1], C[0], C[1]);
            for (int b = 0; b < degree_count; ++b) {
                state.planes[k][corner * degree_count + b] = {static_cast<float>(e0.b[b]), static_cast<float>(eu.b[b]),
                                                              static_cast<float>(ev.b[b])};
                largest = std::max(largest,
                                   std::abs(e0.b[b]) + rx.lens() * std::abs(eu.b[b]) + ry.lens() * std::abs(ev.b[b]));
            }
        }
        state.slack[k] = static_cast<float>(slack + 8.0 * kUnitRoundoff * largest);
    }
    return state.front || state.back;
}

bool keeps(const CullState& memory, const LocalSample& sample) {
    const State& state = memory.as<State>();
    bool front = state.front, back = state.back;
    for (int k = 0; k < 3; ++k) {
        float highest = -INFINITY, lowest = INFINITY;
        for (int n = 0; n < state.per_edge; ++n) {
            const HalfPlane& p = state.planes[k][n];
            const float e = std::fma(sample.v, p.fv, std::fma(sample.u, p.fu, p.f0));
            highest = std::max(highest, e);
            lowest = std::min(lowest, e);
        }
        if (highest < -state.slack[k]) front = false;
        if (lowest > state.slack[k]) back = false;
    }
    return front || back;
}

}  // namespace

extern const CullTest half_space_test;
const CullTest half_space_test{"half-space", "Akenine-Moller, Toth, Munkberg, Hasselgren 2012, Half-Space Culling",
                               prepare, keeps, Grain::kTile};

}  // namespace pentaprism
