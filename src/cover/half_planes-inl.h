// Seven half-planes that hold all that a moving, defocused triangle covers: left, right, below, above, and one along
// each edge. They are affine in (x, y, u, v, t), so one evaluation costs five multiply-adds where the exact test takes
// over forty operations: most vectors that hit nothing are refused by the edges' three.
//
// After the xyuvt hyperplanes of Munkberg & Akenine-Moller 2012 (Hyperplane Culling for Stochastic Rasterization). Ours
// are supports of the six projected corners in a fixed direction of the screen (docs/develop/algorithms.md 3.5), not
// tangents in clip space: setup is one pass over the corners with directions in lanes.

#if defined(PENTAPRISM_COVER_HALF_PLANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef PENTAPRISM_COVER_HALF_PLANES_INL_H
#undef PENTAPRISM_COVER_HALF_PLANES_INL_H
#else
#define PENTAPRISM_COVER_HALF_PLANES_INL_H
#endif

#include <algorithm>
#include <cmath>

#include "cover/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pentaprism {
namespace HWY_NAMESPACE {

// A sample that is covered has nx * hx + ny * hy <= f + e * t + ku * u + kv * v, for each plane.
struct HalfPlanes {
    enum { kRight, kLeft, kAbove, kBelow, kEdges, kCount = 7, kPadded = 8 };
    HWY_ALIGN float nx[kPadded], ny[kPadded], ku[kPadded], kv[kPadded], e[kPadded], f[kPadded];
    float smaller_side;  // of the bounding box at mid-segment through the middle of the lens, pixels
};

// The corners on the screen, in pixels from the middle of the cell, at both ends of the segment; k: radius of the
// circle of confusion, signed.
struct ScreenCorners {
    float x[3][2], y[3][2], k[3][2];
    // In perspective a corner moves along its chord by a fraction that differs from that of time by at most this.
    float bend[3];
    // How far off the exact test's numbers may be from these, pixels.
    float slack_x, slack_y;
};

// Only for triangles in front of the camera plane: divides by w.
inline ScreenCorners screen_corners(const LocalTriangle& T, float ratio) {
    ScreenCorners S;
    float scale_x = 0, scale_y = 0, least_w = INFINITY;
    for (int i = 0; i < 3; ++i) {
        const float w[2] = {T.qw[i], T.qw[i] + T.dw[i]};
        const float x[2] = {T.qx[i], T.qx[i] + T.dx[i]}, y[2] = {T.qy[i], T.qy[i] + T.dy[i]};
        const float c[2] = {T.qc[i], T.qc[i] + T.dc[i]};
        for (int end = 0; end < 2; ++end) {
            const float inverse = 1.0f / w[end];
            S.x[i][end] = x[end] * inverse;
            S.y[i][end] = y[end] * inverse;
            S.k[i][end] = c[end] * inverse;
            scale_x = std::max(scale_x, std::abs(x[end]) + std::abs(c[end]) + 17.0f * w[end]);
            scale_y = std::max(scale_y, std::abs(y[end]) + ratio * std::abs(c[end]) + 17.0f * w[end]);
        }
        // The fraction is s = t w1 / ((1 - t) w0 + t w1); s - t is largest at |sqrt w1 - sqrt w0| / (sqrt w0 + sqrt w1)
        // = |w1 - w0| / (w0 + w1 + 2 sqrt(w0 w1)).
        const float less = std::min(w[0], w[1]);
        S.bend[i] = 1.0001f * std::abs(w[1] - w[0]) / (w[0] + w[1] + 2.0f * less);
        least_w = std::min(least_w, less);
    }
    S.slack_x = 40.0f * kUnitRoundoff * scale_x / least_w;
    S.slack_y = 40.0f * kUnitRoundoff * scale_y / least_w;
    return S;
}

// Why they hold every hit: corner i is seen at P_i(s) + k_i(s) * (u, v), and P_i and k_i move along straight chords
// (with the same fraction, both being something affine over w). For a direction n and m = n.(u, v), |m| <= L:
//     n.P_i + k_i m  <=  k m + (1 - s) (n.P_i0 + L |k_i0 - k|) + s (n.P_i1 + L |k_i1 - k|)
// for any k; the largest of the three corners is a convex function of s, so below the chord between its ends. To
// replace s by t costs at most bend * (|n.(P_i1 - P_i0)| + L |k_i1 - k_i0|).
HWY_INLINE HalfPlanes half_planes(const LocalTriangle& T, float ratio) {
    const ScreenCorners S = screen_corners(T, ratio);
    HalfPlanes H = {{1, -1, 0, 0, 0, 0, 0, 0}, {0, 0, 1, -1, 0, 0, 0, 0}, {}, {}, {}, {}, 0};
    float mx[3], my[3];  // twice the corners at mid-segment
    for (int i = 0; i < 3; ++i) {
        mx[i] = S.x[i][0] + S.x[i][1];
        my[i] = S.y[i][0] + S.y[i][1];
    }
    H.smaller_side = 0.5f * std::min(std::max({mx[0], mx[1], mx[2]}) - std::min({mx[0], mx[1], mx[2]}),
                                     std::max({my[0], my[1], my[2]}) - std::min({my[0], my[1], my[2]}));
    const float area = (mx[1] - mx[0]) * (my[2] - my[0]) - (mx[2] - mx[0]) * (my[1] - my[0]);
    const float outward = area < 0 ? -0.5f : 0.5f;
    for (int edge = 0; edge < 3; ++edge) {
        const int i = (edge + 1) % 3, j = (edge + 2) % 3;
        H.nx[HalfPlanes::kEdges + edge] = outward * (my[j] - my[i]);
        H.ny[HalfPlanes::kEdges + edge] = outward * (mx[i] - mx[j]);
    }

    const hn::CappedTag<float, HalfPlanes::kPadded> d;
    using V = hn::Vec<decltype(d)>;
    for (int first = 0; first < HalfPlanes::kPadded; first += static_cast<int>(hn::Lanes(d))) {
        const V nx = hn::Load(d, H.nx + first), ny = hn::Load(d, H.ny + first);
        const V anx = hn::Abs(nx), any = hn::Abs(ny), rny = hn::Mul(any, hn::Set(d, ratio));
        // L: hypot(a, b) <= max + (sqrt 2 - 1) min; squares of small numbers would vanish.
        const V lens = hn::MulAdd(hn::Set(d, 0.4143f), hn::Min(anx, rny), hn::Max(anx, rny));
        V at[3][2], k = hn::Zero(d);
        for (int end = 0; end < 2; ++end) {
            V most = hn::Set(d, -INFINITY), k_most = hn::Zero(d);
            for (int i = 0; i < 3; ++i) {
                at[i][end] = hn::MulAdd(nx, hn::Set(d, S.x[i][end]), hn::Mul(ny, hn::Set(d, S.y[i][end])));
                k_most = hn::IfThenElse(hn::Gt(at[i][end], most), hn::Set(d, S.k[i][end]), k_most);
                most = hn::Max(most, at[i][end]);
            }
            k = hn::MulAdd(hn::Set(d, 0.5f), k_most, k);  // that of the farthest corner: the others matter less
        }
        V support[2], bend = hn::Zero(d);
        for (int end = 0; end < 2; ++end) {
            support[end] = hn::Set(d, -INFINITY);
            for (int i = 0; i < 3; ++i) {
                const V off = hn::Abs(hn::Sub(hn::Set(d, S.k[i][end]), k));
                support[end] = hn::Max(support[end], hn::MulAdd(lens, off, at[i][end]));
            }
        }
        for (int i = 0; i < 3; ++i) {
            const V path = hn::Abs(hn::Sub(at[i][1], at[i][0]));
            const V change = hn::MulAdd(lens, hn::Set(d, std::abs(S.k[i][1] - S.k[i][0])), path);
            bend = hn::Max(bend, hn::Mul(change, hn::Set(d, S.bend[i])));
        }
        const V segments = hn::Set(d, T.segments), segment = hn::Set(d, T.segment);
        const V change = hn::Sub(support[1], support[0]), e = hn::Mul(change, segments);
        V size = hn::Add(hn::Add(hn::Abs(support[0]), hn::Abs(support[1])), hn::Abs(e));
        size = hn::Add(size, hn::MulAdd(lens, hn::Abs(k), hn::Mul(hn::Set(d, 32.0f), hn::Add(anx, any))));
        V f = hn::Add(hn::NegMulAdd(change, segment, support[0]), bend);
        f = hn::MulAdd(anx, hn::Set(d, S.slack_x), hn::MulAdd(any, hn::Set(d, S.slack_y), f));
        f = hn::MulAdd(size, hn::Set(d, 16.0f * kUnitRoundoff), f);
        f = hn::Add(f, hn::Set(d, 1e-35f));  // an edge so short that products underflow refuses nothing
        hn::Store(hn::Mul(k, nx), d, H.ku + first);
        hn::Store(hn::Mul(k, ny), d, H.kv + first);
        hn::Store(e, d, H.e + first);
        hn::Store(f, d, H.f + first);
    }
    return H;
}

}  // namespace HWY_NAMESPACE
}  // namespace pentaprism
HWY_AFTER_NAMESPACE();

#endif
