#pragma once
// Affine bounds of the bilinear corner bounds (docs/develop/algorithms.md 4.6.4): lines in the (u, t) square with the
// whole triangle on one side. `ut-vt-lines` uses one of them for each side of each axis, `clip-space-affine` both.

#include "cull/cull_axis.h"

namespace pentaprism {

/// f(lens, s) = f0 + f_lens * (lens - lens0) + f_s * (s - s0).
struct Line {
    float f0, f_lens, f_s;
    float at(float lens, float s) const { return std::fma(f_s, s, std::fma(f_lens, lens, f0)); }
};

/// Two affine functions, each at least the bilinear interpolation of m over the rectangle; no affine function lies
/// lower on all of it. With a, s in [0, 1] the interpolation is base + k*a*s, and a*s <= min(a, s), a*s >= max(0, a + s
/// - 1).
struct LinePair {
    Line first, second;
};
inline LinePair lines_above(const double m[2][2], double lens_width, double s_width) {
    const double k = m[0][0] + m[1][1] - m[1][0] - m[0][1];
    const double along_lens = m[1][0] - m[0][0], along_s = m[0][1] - m[0][0];
    const double per_lens = lens_width > 0 ? 1.0 / lens_width : 0.0, per_s = s_width > 0 ? 1.0 / s_width : 0.0;
    const auto line = [&](double f0, double f_lens, double f_s) {
        return Line{static_cast<float>(f0), static_cast<float>(f_lens * per_lens), static_cast<float>(f_s * per_s)};
    };
    if (k > 0) return {line(m[0][0], along_lens + k, along_s), line(m[0][0], along_lens, along_s + k)};
    return {line(m[0][0], along_lens, along_s), line(m[0][0] - k, along_lens + k, along_s + k)};
}

inline LinePair lines_below(const double m[2][2], double lens_width, double s_width) {
    const double negated[2][2] = {{-m[0][0], -m[0][1]}, {-m[1][0], -m[1][1]}};
    return lines_above(negated, lens_width, s_width);  // of -min X_i
}

/// Above and below, x and y. Rounding, in unit roundoffs of the magnitude, if no |f| of a line's steps exceeds twice
/// it: 5 in the exact test, 5 in the coefficients, 4 in the sample's place, 6 in the two fused steps: below the 32
/// of 4.2.
struct LineBounds {
    LinePair sides[4];
    float u0, v0, s0;
    SegmentTime time;

    /// False: all of the footprint is refused.
    bool prepare(const LocalTriangle& T, const Footprint& footprint) {
        const SegmentDomain d = segment_domain(T, footprint.domain);
        if (d.empty()) return false;
        Axis x, y;
        axes_at_ends(T, d.s0, d.s1, x, y);
        const CornerBounds cx = corner_bounds(x, x_range(footprint, d)), cy = corner_bounds(y, y_range(footprint, d));
        if (cx.refused() || cy.refused()) return false;
        const double du = double{d.u1} - d.u0, dv = double{d.v1} - d.v0, ds = double{d.s1} - d.s0;
        sides[0] = lines_above(cx.max, du, ds);
        sides[1] = lines_below(cx.min, du, ds);
        sides[2] = lines_above(cy.max, dv, ds);
        sides[3] = lines_below(cy.min, dv, ds);
        u0 = d.u0;
        v0 = d.v0;
        s0 = d.s0;
        time = segment_time(T);
        return true;
    }
};

}  // namespace pentaprism
