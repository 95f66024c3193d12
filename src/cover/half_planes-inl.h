// Seven half-planes that hold all that a moving, defocused triangle covers: left, right, below, above, and one along
// each edge. They are affine in (x, y, u, v, t), so one evaluation costs five multiply-adds where the exact test takes
// over forty operations: most vectors that hit nothing are refused by the edges' three.
//
// After the xyuvt hyperplanes of Munkberg & Akenine-Moller 2012 (Hyperplane Culling for Stochastic Rasterization). Ours
// are supports of the six projected corners in a fixed direction of the screen (docs/develop/algorithms.md 3.5), not
// tangents in clip space. Set up for as many triangles at once as a vector has lanes.

#if defined(PENTAPRISM_COVER_HALF_PLANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef PENTAPRISM_COVER_HALF_PLANES_INL_H
#undef PENTAPRISM_COVER_HALF_PLANES_INL_H
#else
#define PENTAPRISM_COVER_HALF_PLANES_INL_H
#endif

#include <cmath>

#include "cover/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pentaprism {
namespace HWY_NAMESPACE {

// Of the triangles k of a batch. A sample that is covered has nx * hx + ny * hy <= f + e * t + ku * u + kv * v, for
// each plane.
struct HalfPlanes {
    enum { kRight, kLeft, kAbove, kBelow, kEdges, kCount = 7 };
    HWY_ALIGN float nx[kCount][kLanes], ny[kCount][kLanes], ku[kCount][kLanes], kv[kCount][kLanes], e[kCount][kLanes],
        f[kCount][kLanes];
    HWY_ALIGN float smaller_side[kLanes];  // of the bounding box at mid-segment through the middle of the lens, pixels
};

// Corners as localize() has them, at both ends of the segment.
struct CornerLanes {
    Vec x[3][2], y[3][2], w[3][2], c[3][2];
};

// The corners on the screen, in pixels from the middle of the cell; k: radius of the circle of confusion, signed.
struct ScreenCorners {
    Vec x[3][2], y[3][2], k[3][2];
    // In perspective a corner moves along its chord by a fraction that differs from that of time by at most this.
    Vec bend[3];
    // How far off the exact test's numbers may be from these, pixels.
    Vec slack_x, slack_y;
};

// Only for triangles in front of the camera plane: divides by w.
HWY_INLINE ScreenCorners screen_corners(F f, const CornerLanes& C, float ratio) {
    ScreenCorners S;
    const Vec seventeen = hn::Set(f, 17.0f);
    Vec scale_x = hn::Zero(f), scale_y = hn::Zero(f), least_w = hn::Set(f, INFINITY);
    for (int i = 0; i < 3; ++i) {
        for (int end = 0; end < 2; ++end) {
            const Vec w = C.w[i][end], inverse = hn::Div(hn::Set(f, 1.0f), w), reach = hn::Abs(C.c[i][end]);
            S.x[i][end] = hn::Mul(C.x[i][end], inverse);
            S.y[i][end] = hn::Mul(C.y[i][end], inverse);
            S.k[i][end] = hn::Mul(C.c[i][end], inverse);
            scale_x = hn::Max(scale_x, hn::MulAdd(seventeen, w, hn::Add(hn::Abs(C.x[i][end]), reach)));
            scale_y =
                hn::Max(scale_y, hn::MulAdd(seventeen, w, hn::MulAdd(hn::Set(f, ratio), reach, hn::Abs(C.y[i][end]))));
        }
        // The fraction is s = t w1 / ((1 - t) w0 + t w1); s - t is largest at |sqrt w1 - sqrt w0| / (sqrt w0 + sqrt w1)
        // = |w1 - w0| / (w0 + w1 + 2 sqrt(w0 w1)).
        const Vec w0 = C.w[i][0], w1 = C.w[i][1], less = hn::Min(w0, w1);
        S.bend[i] = hn::Div(hn::Mul(hn::Set(f, 1.0001f), hn::Abs(hn::Sub(w1, w0))),
                            hn::MulAdd(hn::Set(f, 2.0f), less, hn::Add(w0, w1)));
        least_w = hn::Min(least_w, less);
    }
    const Vec rounding = hn::Div(hn::Set(f, 40.0f * kUnitRoundoff), least_w);
    S.slack_x = hn::Mul(rounding, scale_x);
    S.slack_y = hn::Mul(rounding, scale_y);
    return S;
}

// Plane p of direction (nx, ny) for the triangles from `lane` on. Why it holds every hit: corner i is seen at P_i(s) +
// k_i(s) * (u, v), and P_i and k_i move along straight chords (with the same fraction, both being something affine over
// w). For a direction n and m = n.(u, v), |m| <= L:
//     n.P_i + k_i m  <=  k m + (1 - s) (n.P_i0 + L |k_i0 - k|) + s (n.P_i1 + L |k_i1 - k|)
// for any k; the largest of the three corners is a convex function of s, so below the chord between its ends. To
// replace s by t costs at most bend * (|n.(P_i1 - P_i0)| + L |k_i1 - k_i0|).
HWY_INLINE void make_half_plane(F d, const ScreenCorners& S, Vec nx, Vec ny, float ratio, Vec segments, Vec segment,
                                HalfPlanes& H, int p, int lane) {
    const Vec anx = hn::Abs(nx), any = hn::Abs(ny), rny = hn::Mul(any, hn::Set(d, ratio));
    // L: hypot(a, b) <= max + (sqrt 2 - 1) min; squares of small numbers would vanish.
    const Vec lens = hn::MulAdd(hn::Set(d, 0.4143f), hn::Min(anx, rny), hn::Max(anx, rny));
    Vec at[3][2], k = hn::Zero(d);
    for (int end = 0; end < 2; ++end) {
        Vec most = hn::Set(d, -INFINITY), k_most = hn::Zero(d);
        for (int i = 0; i < 3; ++i) {
            at[i][end] = hn::MulAdd(nx, S.x[i][end], hn::Mul(ny, S.y[i][end]));
            k_most = hn::IfThenElse(hn::Gt(at[i][end], most), S.k[i][end], k_most);
            most = hn::Max(most, at[i][end]);
        }
        k = hn::MulAdd(hn::Set(d, 0.5f), k_most, k);  // that of the farthest corner: the others matter less
    }
    Vec support[2], bend = hn::Zero(d);
    for (int end = 0; end < 2; ++end) {
        support[end] = hn::Set(d, -INFINITY);
        for (int i = 0; i < 3; ++i)
            support[end] = hn::Max(support[end], hn::MulAdd(lens, hn::Abs(hn::Sub(S.k[i][end], k)), at[i][end]));
    }
    for (int i = 0; i < 3; ++i) {
        const Vec path = hn::Abs(hn::Sub(at[i][1], at[i][0]));
        const Vec change = hn::MulAdd(lens, hn::Abs(hn::Sub(S.k[i][1], S.k[i][0])), path);
        bend = hn::Max(bend, hn::Mul(change, S.bend[i]));
    }
    const Vec change = hn::Sub(support[1], support[0]), e = hn::Mul(change, segments);
    Vec size = hn::Add(hn::Add(hn::Abs(support[0]), hn::Abs(support[1])), hn::Abs(e));
    size = hn::Add(size, hn::MulAdd(lens, hn::Abs(k), hn::Mul(hn::Set(d, 32.0f), hn::Add(anx, any))));
    Vec f = hn::Add(hn::NegMulAdd(change, segment, support[0]), bend);
    f = hn::MulAdd(anx, S.slack_x, hn::MulAdd(any, S.slack_y, f));
    f = hn::MulAdd(size, hn::Set(d, 16.0f * kUnitRoundoff), f);
    f = hn::Add(f, hn::Set(d, 1e-35f));  // an edge so short that products underflow refuses nothing
    hn::Store(nx, d, H.nx[p] + lane);
    hn::Store(ny, d, H.ny[p] + lane);
    hn::Store(hn::Mul(k, nx), d, H.ku[p] + lane);
    hn::Store(hn::Mul(k, ny), d, H.kv[p] + lane);
    hn::Store(e, d, H.e[p] + lane);
    hn::Store(f, d, H.f[p] + lane);
}

// All seven. Numbers of triangles that reach the camera plane come out meaningless.
HWY_INLINE void make_half_planes(F f, const CornerLanes& C, float ratio, Vec segments, Vec segment, HalfPlanes& H,
                                 int lane) {
    const ScreenCorners S = screen_corners(f, C, ratio);
    Vec mx[3], my[3];  // twice the corners at mid-segment
    for (int i = 0; i < 3; ++i) {
        mx[i] = hn::Add(S.x[i][0], S.x[i][1]);
        my[i] = hn::Add(S.y[i][0], S.y[i][1]);
    }
    const auto side = [](const Vec m[3]) HWY_ATTR {
        return hn::Sub(hn::Max(hn::Max(m[0], m[1]), m[2]), hn::Min(hn::Min(m[0], m[1]), m[2]));
    };
    hn::Store(hn::Mul(hn::Set(f, 0.5f), hn::Min(side(mx), side(my))), f, H.smaller_side + lane);
    const Vec zero = hn::Zero(f), one = hn::Set(f, 1.0f), minus_one = hn::Set(f, -1.0f);
    make_half_plane(f, S, one, zero, ratio, segments, segment, H, HalfPlanes::kRight, lane);
    make_half_plane(f, S, minus_one, zero, ratio, segments, segment, H, HalfPlanes::kLeft, lane);
    make_half_plane(f, S, zero, one, ratio, segments, segment, H, HalfPlanes::kAbove, lane);
    make_half_plane(f, S, zero, minus_one, ratio, segments, segment, H, HalfPlanes::kBelow, lane);
    const Vec area = hn::Sub(hn::Mul(hn::Sub(mx[1], mx[0]), hn::Sub(my[2], my[0])),
                             hn::Mul(hn::Sub(mx[2], mx[0]), hn::Sub(my[1], my[0])));
    const Vec outward = hn::CopySign(hn::Set(f, 0.5f), area);
    for (int edge = 0; edge < 3; ++edge) {
        const int i = (edge + 1) % 3, j = (edge + 2) % 3;
        make_half_plane(f, S, hn::Mul(outward, hn::Sub(my[j], my[i])), hn::Mul(outward, hn::Sub(mx[i], mx[j])), ratio,
                        segments, segment, H, HalfPlanes::kEdges + edge, lane);
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace pentaprism
HWY_AFTER_NAMESPACE();

#endif
