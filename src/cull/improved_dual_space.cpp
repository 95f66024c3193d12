// improved-dual-space: bilinear bounds in (u, t) and (v, t) over a footprint of the screen.
//
// Laine & Karras 2011, Improved Dual-Space Bounds for Simultaneous Motion and Defocus Blur. For one vertex
// X(gx,u,t) = x(t) + u*c(t) - gx*w(t) is affine in each of gx, u and t. A sample can only hit if max X_i >= 0 >= min
// X_i (docs/develop/algorithms.md 1.5). With the footprint's middle gc and half width hg, the corner value over the
// footprint is X(gc) + hg*|w| at most, and interpolating the maxima over the vertices at the four (u,t) corners bounds
// max X_i inside. No division, valid for every sign of w and c. We evaluate the corners directly for each footprint
// instead of interpolating slices of the triangle's whole extent as printed: it is tighter, and needs no guard for
// empty ranges.

#include <algorithm>
#include <cmath>

#include "cull/cull_test.h"

namespace pentaprism {
namespace {

constexpr float kUnitRoundoff = 1.0f / 16777216.0f;

// f(u, t) = A + B*u' + t'*(C + D*u') with u' in [-1, 1] and t' in [0, 1] over the domain.
struct Bilinear {
    float a, b, c, d;
    float at(float u, float t) const { return a + b * u + t * (c + d * u); }
};

struct Slices {
    float u_scale, u_shift, v_scale, v_shift, t_scale, t_shift;  // to the unit domain
    Bilinear x_max, x_min, y_max, y_min;
};

struct Corners {
    float max[2][2], min[2][2];  // [lens end][time end]
};

// One axis of the three vertices at the two ends of the time domain.
struct Axis {
    float p[3][2], c[3][2], w[3][2];
};

Corners corners(const Axis& axis, float lens0, float lens1, float middle, float half, float slack) {
    Corners m;
    for (int a = 0; a < 2; ++a)
        for (int k = 0; k < 2; ++k) {
            const float lens = a == 0 ? lens0 : lens1;
            float highest = -INFINITY, lowest = INFINITY;
            for (int i = 0; i < 3; ++i) {
                const float x = axis.p[i][k] + lens * axis.c[i][k] - middle * axis.w[i][k];
                const float reach = half * std::abs(axis.w[i][k]);
                highest = std::max(highest, x + reach);
                lowest = std::min(lowest, x - reach);
            }
            m.max[a][k] = highest + slack;
            m.min[a][k] = lowest - slack;
        }
    return m;
}

Bilinear bilinear(const float m[2][2]) {
    const float a = 0.5f * (m[0][0] + m[1][0]), b = 0.5f * (m[1][0] - m[0][0]);
    return {a, b, 0.5f * (m[0][1] + m[1][1]) - a, 0.5f * (m[1][1] - m[0][1]) - b};
}

// All four corners on the wrong side: the whole footprint is refused.
bool refused(const Corners& m) {
    return (m.max[0][0] < 0 && m.max[0][1] < 0 && m.max[1][0] < 0 && m.max[1][1] < 0) ||
           (m.min[0][0] > 0 && m.min[0][1] > 0 && m.min[1][0] > 0 && m.min[1][1] > 0);
}

float scale(const Axis& axis, float lens) {
    float largest = 0;
    for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 2; ++k)
            largest = std::max(largest,
                               std::abs(axis.p[i][k]) + lens * std::abs(axis.c[i][k]) + 17.0f * std::abs(axis.w[i][k]));
    return largest;
}

void to_unit(float low, float high, float& scale, float& shift, float from) {
    // u' = from + (1 - from) * (u - low) / (high - low) for from = 0, and 2 * ... - 1 for from = -1.
    const float width = high - low;
    scale = width > 0 ? (1.0f - from) / width : 0.0f;
    shift = from - scale * low;
}

bool prepare(const LocalTriangle& T, const Footprint& footprint, CullState& state) {
    // The part of the time domain that belongs to this segment, as fractions of the segment.
    const Domain& domain = footprint.domain;
    const float t0 = std::max(0.0f, std::fma(domain.t0, T.segments, -T.segment));
    const float t1 = std::min(1.0f, std::fma(domain.t1, T.segments, -T.segment));
    if (!(t0 <= t1)) return false;
    Axis x, y;
    for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 2; ++k) {
            const float tau = k == 0 ? t0 : t1;
            x.p[i][k] = std::fma(tau, T.dx[i], T.qx[i]);
            y.p[i][k] = std::fma(tau, T.dy[i], T.qy[i]);
            x.w[i][k] = y.w[i][k] = std::fma(tau, T.dw[i], T.qw[i]);
            x.c[i][k] = y.c[i][k] = std::fma(tau, T.dc[i], T.qc[i]);
        }
    const float lens_u = std::max(std::abs(domain.u0), std::abs(domain.u1)),
                lens_v = std::max(std::abs(domain.v0), std::abs(domain.v1));
    const Corners cx = corners(x, domain.u0, domain.u1, 0.5f * (footprint.x0 + footprint.x1),
                               0.5f * (footprint.x1 - footprint.x0), 32.0f * kUnitRoundoff * scale(x, lens_u));
    if (refused(cx)) return false;
    const Corners cy = corners(y, domain.v0, domain.v1, 0.5f * (footprint.y0 + footprint.y1),
                               0.5f * (footprint.y1 - footprint.y0), 32.0f * kUnitRoundoff * scale(y, lens_v));
    if (refused(cy)) return false;

    Slices& slices = state.as<Slices>();
    to_unit(domain.u0, domain.u1, slices.u_scale, slices.u_shift, -1.0f);
    to_unit(domain.v0, domain.v1, slices.v_scale, slices.v_shift, -1.0f);
    // t of the picture -> fraction of the segment -> fraction of [t0, t1].
    float scale_tau, shift_tau;
    to_unit(t0, t1, scale_tau, shift_tau, 0.0f);
    slices.t_scale = scale_tau * T.segments;
    slices.t_shift = shift_tau - scale_tau * T.segment;
    slices.x_max = bilinear(cx.max);
    slices.x_min = bilinear(cx.min);
    slices.y_max = bilinear(cy.max);
    slices.y_min = bilinear(cy.min);
    return true;
}

bool keeps(const CullState& state, const LocalSample& sample) {
    const Slices& slices = state.as<Slices>();
    const float u = std::fma(sample.u, slices.u_scale, slices.u_shift),
                v = std::fma(sample.v, slices.v_scale, slices.v_shift);
    const float t = std::fma(sample.t, slices.t_scale, slices.t_shift);
    return slices.x_max.at(u, t) >= 0 && slices.x_min.at(u, t) <= 0 && slices.y_max.at(v, t) >= 0 &&
           slices.y_min.at(v, t) <= 0;
}

}  // namespace

extern const CullTest improved_dual_space_test;
const CullTest improved_dual_space_test{"improved-dual-space", "Laine & Karras 2011, Improved Dual-Space Bounds",
                                        prepare, keeps};

}  // namespace pentaprism
