#pragma once
// The part of lens and shutter in which a footprint can be hit, one interval for each of u, v and s: the bounds of
// Laine, Aila, Karras, Lehtinen 2011 in the form of docs/develop/algorithms.md 4.4. `dual-space` tests samples against
// them; `hyperplane` and `hierarchical` narrow their domain by them first.

#include "cull/cull_axis.h"

namespace pentaprism {

/// f is affine, a at `low` and b at `high`; narrows [out_low, out_high] to where f >= 0. False: nowhere between.
/// Rounding is far below 1e-5: a quotient of numbers of different sign, in [0, 1], times a range of at most a few
/// units.
inline bool narrow(double a, double b, double low, double high, float& out_low, float& out_high) {
    constexpr double kOut = 1e-5;
    if (a < 0 && b < 0) return false;
    const double root = low + (high - low) * (a / (a - b));
    if (a < 0) out_low = std::max(out_low, static_cast<float>(root - kOut));
    if (b < 0) out_high = std::min(out_high, static_cast<float>(root + kOut));
    return true;
}

/// Narrows the lens coordinate and s by one axis' corner bounds. For s alone, the larger of the two lens ends bounds
/// max X_i from above whatever the lens coordinate is; for the lens coordinate alone, the larger of the two ends of s.
/// False: the footprint cannot be hit.
inline bool narrow_axis(const CornerBounds& m, float& lens0, float& lens1, float& s0, float& s1) {
    const double l0 = lens0, l1 = lens1, t0 = s0, t1 = s1;
    return narrow(std::max(m.max[0][0], m.max[1][0]), std::max(m.max[0][1], m.max[1][1]), t0, t1, s0, s1) &&
           narrow(-std::min(m.min[0][0], m.min[1][0]), -std::min(m.min[0][1], m.min[1][1]), t0, t1, s0, s1) &&
           narrow(std::max(m.max[0][0], m.max[0][1]), std::max(m.max[1][0], m.max[1][1]), l0, l1, lens0, lens1) &&
           narrow(-std::min(m.min[0][0], m.min[0][1]), -std::min(m.min[1][0], m.min[1][1]), l0, l1, lens0, lens1);
}

/// Narrows the domain to what of it can hit the footprint. False: nothing can.
inline bool narrow_domain(const LocalTriangle& T, const Footprint& footprint, SegmentDomain& domain) {
    if (domain.empty()) return false;
    Axis x, y;
    axes_at_ends(T, domain.s0, domain.s1, x, y);
    const CornerBounds cx = corner_bounds(x, x_range(footprint, domain)),
                       cy = corner_bounds(y, y_range(footprint, domain));
    SegmentDomain by_x = domain, by_y = domain;
    if (!narrow_axis(cx, by_x.u0, by_x.u1, by_x.s0, by_x.s1)) return false;
    if (!narrow_axis(cy, by_y.v0, by_y.v1, by_y.s0, by_y.s1)) return false;
    domain = {by_x.u0, by_x.u1, by_y.v0, by_y.v1, std::max(by_x.s0, by_y.s0), std::min(by_x.s1, by_y.s1)};
    return !domain.empty();
}

/// A narrowed domain as a test of samples.
struct Intervals {
    SegmentDomain domain;
    SegmentTime time;
    bool keep(const LocalSample& sample) const {
        const float s = time(sample.t);
        return s >= domain.s0 && s <= domain.s1 && sample.u >= domain.u0 && sample.u <= domain.u1 &&
               sample.v >= domain.v0 && sample.v <= domain.v1;
    }
};

}  // namespace pentaprism
