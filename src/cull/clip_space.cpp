// clip-space: what each vertex refuses of the lens, then lines that bound t by the lens coordinate.
//
// Wu 2013, Clip Space Sample Culling for Stochastic Rasterization (and Wu, Way, Tsai, Shih), in two stages, each
// repaired; clip_space_as_printed.cpp has them as printed. docs/develop/algorithms.md 4.6 lists what was wrong.
//
// Stage 1. A sample is refused where all six X_j(u) (three corners, both ends) are negative, and where all are
// positive. Each of these sets is an intersection of half lines, so an open interval. As printed, the kept set was the
// interval of the roots of X_j, which is right only if all circles of confusion have one sign. X_j(u) at any s is
// between its ends, so the intervals hold for the whole shutter.
//
// Stage 2. On what stage 1 keeps of the lens, [u0, u1], corner i crosses the ray at t_i(u) = -X_i0(u) / (X_i1(u) -
// X_i0(u)). If all denominators, of three corners at both sides of the footprint, have one strict sign on [u0, u1],
// then {max X_i >= 0} and {min X_i <= 0} are opposite half lines in t, so t must lie between the smallest and the
// largest t_i. Each t_i(u) is convex or concave there: its chord and its tangent at the middle enclose it, and a line
// above all of them at both ends is above them between. For fixed u, t_i is monotone in g, so the two sides of the
// footprint suffice. If the signs differ, or a denominator is small, the axis refuses nothing in stage 2. As printed,
// signs and poles were not looked at, and the ray was that of the pixel's middle alone.
//
// Rounding: stage 1 moves X_j by the slack of 4.2 and the intervals' ends inwards by 1e-5, far more than a division of
// doubles is off. Stage 2: the exact test's X is off by 5 unit roundoffs of its magnitude, which moves a root by that
// over the denominator; 16 are allowed, and 1e-6 of the lines' ends for their float evaluation.

#include "cull/cull_axis.h"

namespace pentaprism {
namespace {

struct OpenInterval {
    double low, high;
    bool empty() const { return !(low < high); }
};

struct AxisState {
    float above0, above1, below0, below1;  // refused: lens strictly between
    bool bounded;                          // stage 2 has lines
    float lens0, per_lens;
    float first0, first_step, last0, last_step;  // t from ... to, at lens0 and on the way to the other end
    float s0, per_s;

    bool keep(float lens, float s) const {
        if ((lens > above0 && lens < above1) || (lens > below0 && lens < below1)) return false;
        if (!bounded) return true;
        const float f = (lens - lens0) * per_lens, t = (s - s0) * per_s;
        return t >= std::fma(f, first_step, first0) && t <= std::fma(f, last_step, last0);
    }
};
struct State {
    AxisState x, y;
    SegmentTime time;
};

struct Stage1 {
    OpenInterval all_negative{-INFINITY, INFINITY}, all_positive{-INFINITY, INFINITY};
    double kept0, kept1;  // the hull of what is left of the lens
};

// Where slope * lens + at_zero < 0 for one more function.
void intersect(OpenInterval& interval, double at_zero, double slope) {
    if (slope > 0)
        interval.high = std::min(interval.high, -at_zero / slope);
    else if (slope < 0)
        interval.low = std::max(interval.low, -at_zero / slope);
    else if (!(at_zero < 0))
        interval.high = -INFINITY;
}

// False: nothing is kept.
bool stage1(const Axis& axis, const AxisRange& range, double slack, Stage1& out) {
    constexpr double kIn = 1e-5;
    const double middle = 0.5 * (range.g0 + range.g1), half = 0.5 * (range.g1 - range.g0);
    for (int i = 0; i < 3; ++i)
        for (int end = 0; end < 2; ++end) {
            const double x = axis.p[i][end] - middle * axis.w[i][end];
            const double reach = half * std::abs(axis.w[i][end]) + slack, c = axis.c[i][end];
            intersect(out.all_negative, x + reach, c);
            intersect(out.all_positive, -(x - reach), -c);
        }
    out.kept0 = range.lens0;
    out.kept1 = range.lens1;
    for (OpenInterval* refused : {&out.all_negative, &out.all_positive}) {
        refused->low += kIn;
        refused->high -= kIn;
    }
    for (const OpenInterval& refused : {out.all_negative, out.all_positive, out.all_negative}) {
        if (refused.empty()) continue;
        if (out.kept0 > refused.low && out.kept0 < refused.high) out.kept0 = refused.high;
        if (out.kept1 > refused.low && out.kept1 < refused.high) out.kept1 = refused.low;
    }
    return out.kept0 <= out.kept1;
}

// Lines over [lens0, lens1] between which t, a fraction of the axis' two ends, must lie. False: no such bound.
bool stage2(const Axis& axis, const AxisRange& range, double lens0, double lens1, double magnitude, AxisState& out) {
    if (!(lens0 < lens1)) return false;
    const double half = 0.5 * (lens1 - lens0);
    double first[2] = {INFINITY, INFINITY}, last[2] = {-INFINITY, -INFINITY};
    double least_d = INFINITY, largest_t = 1;
    int common_sign = 0;
    for (const double g : {range.g0, range.g1})
        for (int i = 0; i < 3; ++i) {
            const double x0 = axis.p[i][0] - g * axis.w[i][0], x1 = axis.p[i][1] - g * axis.w[i][1];
            const double c0 = axis.c[i][0], c1 = axis.c[i][1];
            const double n0 = -x0, n1 = -c0, d0 = x1 - x0, d1 = c1 - c0;
            const double da = d0 + d1 * lens0, db = d0 + d1 * lens1;
            const double enough = 1e-3 * (std::abs(x0) + std::abs(x1) + std::abs(c0) + std::abs(c1));
            const int sign = da > enough && db > enough ? 1 : da < -enough && db < -enough ? -1 : 0;
            if (sign == 0 || (common_sign != 0 && sign != common_sign)) return false;
            common_sign = sign;
            const double middle = 0.5 * (lens0 + lens1), dm = d0 + d1 * middle;
            const double ta = (n0 + n1 * lens0) / da, tb = (n0 + n1 * lens1) / db, tm = (n0 + n1 * middle) / dm;
            const double rise = (n1 * d0 - n0 * d1) / (dm * dm) * half;
            first[0] = std::min({first[0], ta, tm - rise});
            first[1] = std::min({first[1], tb, tm + rise});
            last[0] = std::max({last[0], ta, tm - rise});
            last[1] = std::max({last[1], tb, tm + rise});
            least_d = std::min({least_d, std::abs(da), std::abs(db)});
            largest_t =
                std::max({largest_t, std::abs(first[0]), std::abs(first[1]), std::abs(last[0]), std::abs(last[1])});
        }
    const double out_by = 1e-6 * largest_t + 16.0 * kUnitRoundoff * magnitude / least_d;
    if (!(out_by < INFINITY)) return false;
    out.lens0 = static_cast<float>(lens0);
    out.per_lens = static_cast<float>(1.0 / (lens1 - lens0));
    out.first0 = static_cast<float>(first[0] - out_by);
    out.first_step = static_cast<float>(first[1] - first[0]);
    out.last0 = static_cast<float>(last[0] + out_by);
    out.last_step = static_cast<float>(last[1] - last[0]);
    return true;
}

bool prepare_axis(const Axis& axis, const AxisRange& range, const SegmentDomain& domain, AxisState& out) {
    const double size = magnitude(axis, range.lens());
    Stage1 kept;
    if (!stage1(axis, range, 32.0 * kUnitRoundoff * size, kept)) return false;
    out.above0 = static_cast<float>(kept.all_negative.low);
    out.above1 = static_cast<float>(kept.all_negative.high);
    out.below0 = static_cast<float>(kept.all_positive.low);
    out.below1 = static_cast<float>(kept.all_positive.high);
    out.bounded = domain.s0 < domain.s1 && stage2(axis, range, kept.kept0, kept.kept1, size, out);
    out.s0 = domain.s0;
    out.per_s = domain.s0 < domain.s1 ? 1.0f / (domain.s1 - domain.s0) : 0.0f;
    return true;
}

bool prepare(const LocalTriangle& T, const Footprint& footprint, CullState& memory) {
    const SegmentDomain domain = segment_domain(T, footprint.domain);
    if (domain.empty()) return false;
    State& state = memory.as<State>();
    state.time = segment_time(T);
    Axis x, y;
    axes_at_ends(T, domain.s0, domain.s1, x, y);
    return prepare_axis(x, x_range(footprint, domain), domain, state.x) &&
           prepare_axis(y, y_range(footprint, domain), domain, state.y);
}

bool keeps(const CullState& memory, const LocalSample& sample) {
    const State& state = memory.as<State>();
    const float s = state.time(sample.t);
    return state.x.keep(sample.u, s) && state.y.keep(sample.v, s);
}

}  // namespace

extern const CullTest clip_space_test;
const CullTest clip_space_test{"clip-space", "Wu 2013, Clip Space Sample Culling, both stages repaired", prepare,
                               keeps};

}  // namespace pentaprism
