#pragma once
// The corner values that most culling tests start from (docs/develop/algorithms.md 4.1): over a footprint, what the
// deltas X_i of a triangle are at most and at least at the four corners of lens and shutter.

#include <algorithm>
#include <cmath>

#include "cull/cull_test.h"

namespace pentaprism {

inline constexpr double kUnitRoundoff = 1.0 / 16777216.0;

/// One axis of the three corners at both ends of a part of the shutter: x or y, the circle of confusion and w, index
/// [corner][end]. In double: what is left of rounding is that of the exact test and of the float numbers made of these.
struct Axis {
    double p[3][2], c[3][2], w[3][2];
};

inline void axes_at_ends(const LocalTriangle& T, float s0, float s1, Axis& x, Axis& y) {
    for (int i = 0; i < 3; ++i)
        for (int end = 0; end < 2; ++end) {
            const double s = end == 0 ? s0 : s1;
            x.p[i][end] = T.qx[i] + s * T.dx[i];
            y.p[i][end] = T.qy[i] + s * T.dy[i];
            x.w[i][end] = y.w[i][end] = T.qw[i] + s * T.dw[i];
            x.c[i][end] = y.c[i][end] = T.qc[i] + s * T.dc[i];
        }
}

/// The part of one axis that is asked about: pixels g0..g1 and lens coordinates lens0..lens1.
struct AxisRange {
    double g0, g1, lens0, lens1;
    double lens() const { return std::max(std::abs(lens0), std::abs(lens1)); }
};
inline AxisRange x_range(const Footprint& f, const SegmentDomain& d) {
    return {f.x0, f.x1, d.u0, d.u1};
}
inline AxisRange y_range(const Footprint& f, const SegmentDomain& d) {
    return {f.y0, f.y1, d.v0, d.v1};
}

/// Magnitude of an axis: no number that the exact test adds up for a sample with |g| <= reach is larger, and it errs by
/// at most 5 unit roundoffs of it: one for the place at s, one for the circle of confusion at s, one for each of the
/// two fused steps, one to spare. Bounds are moved out by some more: what cancels may not be the measure.
inline double magnitude(const Axis& axis, double lens, double reach = 17.0) {
    double largest = 0;
    for (int i = 0; i < 3; ++i)
        for (int end = 0; end < 2; ++end)
            largest = std::max(
                largest, std::abs(axis.p[i][end]) + lens * std::abs(axis.c[i][end]) + reach * std::abs(axis.w[i][end]));
    return largest;
}

/// max X_i is at most the bilinear interpolation of `max`, min X_i at least that of `min`, index [lens end][time end].
/// Proof: X_i is affine in g, so it is at most its value at the middle plus half the width times |w| at each corner;
/// between the corners it is bilinear for fixed g, and the interpolation of larger values is larger.
struct CornerBounds {
    double max[2][2], min[2][2];

    /// All four corners on the wrong side of zero: nothing between them can be on the right one.
    bool refused() const {
        return (max[0][0] < 0 && max[0][1] < 0 && max[1][0] < 0 && max[1][1] < 0) ||
               (min[0][0] > 0 && min[0][1] > 0 && min[1][0] > 0 && min[1][1] > 0);
    }
};

/// `slack` in unit roundoffs of the magnitude.
inline CornerBounds corner_bounds(const Axis& axis, const AxisRange& range, double slack = 32.0) {
    const double middle = 0.5 * (range.g0 + range.g1), half = 0.5 * (range.g1 - range.g0);
    const double out = slack * kUnitRoundoff * magnitude(axis, range.lens());
    CornerBounds m;
    for (int a = 0; a < 2; ++a)
        for (int k = 0; k < 2; ++k) {
            const double lens = a == 0 ? range.lens0 : range.lens1;
            double highest = -INFINITY, lowest = INFINITY;
            for (int i = 0; i < 3; ++i) {
                const double x = axis.p[i][k] + lens * axis.c[i][k] - middle * axis.w[i][k];
                const double reach = half * std::abs(axis.w[i][k]);
                highest = std::max(highest, x + reach);
                lowest = std::min(lowest, x - reach);
            }
            m.max[a][k] = highest + out;
            m.min[a][k] = lowest - out;
        }
    return m;
}

/// Where a sample is between the ends of a range, made once for the range: scale * value + shift.
struct ToUnit {
    float scale, shift;
    float operator()(float value) const { return std::fma(value, scale, shift); }
};
/// low -> from, high -> 1. A range without width gives `from`.
inline ToUnit to_unit(double low, double high, double from) {
    const double scale = high > low ? (1.0 - from) / (high - low) : 0.0;
    return {static_cast<float>(scale), static_cast<float>(from - scale * low)};
}

/// The fraction of its segment at which a sample is. Exact: t is a multiple of 2^-24.
struct SegmentTime {
    float segments, segment;
    float operator()(float t) const { return std::fma(t, segments, -segment); }
};
inline SegmentTime segment_time(const LocalTriangle& T) {
    return {T.segments, T.segment};
}

/// The bilinear interpolation itself, by the lens in [-1, 1] and the shutter in [0, 1].
struct Bilinear {
    float a, b, c, d;
    float at(float lens, float time) const { return a + b * lens + time * (c + d * lens); }
};
inline Bilinear bilinear(const double m[2][2]) {
    const double a = 0.5 * (m[0][0] + m[1][0]), b = 0.5 * (m[1][0] - m[0][0]);
    return {static_cast<float>(a), static_cast<float>(b), static_cast<float>(0.5 * (m[0][1] + m[1][1]) - a),
            static_cast<float>(0.5 * (m[1][1] - m[0][1]) - b)};
}

/// Upper and lower bilinear bounds of both axes over a footprint and what takes a sample there.
struct Slices {
    ToUnit u, v, s;
    SegmentTime time;
    Bilinear x_max, x_min, y_max, y_min;

    Slices() = default;
    Slices(const LocalTriangle& T, const SegmentDomain& d, const CornerBounds& x, const CornerBounds& y)
        : u(to_unit(d.u0, d.u1, -1.0)),
          v(to_unit(d.v0, d.v1, -1.0)),
          s(to_unit(d.s0, d.s1, 0.0)),
          time(segment_time(T)),
          x_max(bilinear(x.max)),
          x_min(bilinear(x.min)),
          y_max(bilinear(y.max)),
          y_min(bilinear(y.min)) {}

    bool keep(const LocalSample& sample) const {
        const float a = u(sample.u), b = v(sample.v), t = s(time(sample.t));
        return x_max.at(a, t) >= 0 && x_min.at(a, t) <= 0 && y_max.at(b, t) >= 0 && y_min.at(b, t) <= 0;
    }
};

}  // namespace pentaprism
