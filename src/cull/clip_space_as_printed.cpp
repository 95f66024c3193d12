// clip-space-as-printed: NOT conservative. The two stages of Wu 2013 as the texts have them, to be measured.
//
// Wu 2013, Clip Space Sample Culling for Stochastic Rasterization (and Wu, Way, Tsai, Shih): clip_space.cpp is what it
// should be, docs/develop/algorithms.md 4.6 the list of flaws. Kept here on purpose:
//   - stage 1 keeps u between the smallest and the largest root of the six X_j(u), whatever the signs of c: where a
//     triangle crosses the plane of focus, it refuses exactly the wrong part;
//   - stage 2 keeps t between the smallest and the largest line end over the three corners, whatever the signs of the
//     denominators and with poles inside;
//   - both are built for the ray through the pixel's middle, while samples lie all over the pixel.
// Where the texts divide by zero we skip a stage: no motion, no stage 2; no defocus, no stage 1.

#include "cull/cull_axis.h"

namespace pentaprism {
namespace {

struct AxisState {
    float low, high;                             // of the lens coordinate
    float first0, first_step, last0, last_step;  // of t, over the lens from its lowest
    float lens0, per_lens;
};
struct State {
    AxisState x, y;
    SegmentTime time;
    ToUnit s;
};

void stage1(const Axis& axis, double g, AxisState& out) {
    double low = INFINITY, high = -INFINITY;
    bool sharp = true;
    for (int i = 0; i < 3; ++i)
        for (int end = 0; end < 2; ++end) {
            const double c = axis.c[i][end];
            sharp = sharp && c == 0;
            const double root = (g * axis.w[i][end] - axis.p[i][end]) / c;
            low = std::min(low, root);
            high = std::max(high, root);
        }
    out.low = sharp ? -INFINITY : static_cast<float>(low);
    out.high = sharp ? INFINITY : static_cast<float>(high);
}

void stage2(const Axis& axis, double g, const AxisRange& range, AxisState& out) {
    double first[2] = {INFINITY, INFINITY}, last[2] = {-INFINITY, -INFINITY};
    const double middle = 0.5 * (range.lens0 + range.lens1), half = 0.5 * (range.lens1 - range.lens0);
    bool still = true;
    for (int i = 0; i < 3; ++i) {
        const double n0 = g * axis.w[i][0] - axis.p[i][0], n1 = -axis.c[i][0];
        const double d0 = axis.p[i][1] - axis.p[i][0] - g * (axis.w[i][1] - axis.w[i][0]),
                     d1 = axis.c[i][1] - axis.c[i][0];
        still = still && d0 == 0 && d1 == 0;
        const auto t = [&](double lens) { return (n0 + n1 * lens) / (d0 + d1 * lens); };
        const double dm = d0 + d1 * middle, rise = (n1 * d0 - n0 * d1) / (dm * dm) * half;
        for (int end = 0; end < 2; ++end) {
            const double chord = t(end == 0 ? range.lens0 : range.lens1);
            const double tangent = t(middle) + (end == 0 ? -rise : rise);
            first[end] = std::min({first[end], chord, tangent});
            last[end] = std::max({last[end], chord, tangent});
        }
    }
    if (still) first[0] = first[1] = -INFINITY, last[0] = last[1] = INFINITY;
    out.first0 = static_cast<float>(first[0]);
    out.last0 = static_cast<float>(last[0]);
    out.first_step = still ? 0.0f : static_cast<float>(first[1] - first[0]);
    out.last_step = still ? 0.0f : static_cast<float>(last[1] - last[0]);
    out.lens0 = static_cast<float>(range.lens0);
    out.per_lens = range.lens1 > range.lens0 ? static_cast<float>(1.0 / (range.lens1 - range.lens0)) : 0.0f;
}

bool prepare(const LocalTriangle& T, const Footprint& footprint, CullState& memory) {
    const SegmentDomain domain = segment_domain(T, footprint.domain);
    if (domain.empty()) return false;
    State& state = memory.as<State>();
    state.time = segment_time(T);
    state.s = to_unit(domain.s0, domain.s1, 0.0);
    Axis x, y;
    axes_at_ends(T, domain.s0, domain.s1, x, y);
    const double gx = 0.5 * (footprint.x0 + footprint.x1), gy = 0.5 * (footprint.y0 + footprint.y1);
    stage1(x, gx, state.x);
    stage1(y, gy, state.y);
    stage2(x, gx, x_range(footprint, domain), state.x);
    stage2(y, gy, y_range(footprint, domain), state.y);
    return true;
}

bool keeps_axis(const AxisState& axis, float lens, float t) {
    const float f = (lens - axis.lens0) * axis.per_lens;
    return lens >= axis.low && lens <= axis.high && t >= axis.first0 + f * axis.first_step &&
           t <= axis.last0 + f * axis.last_step;
}

bool keeps(const CullState& memory, const LocalSample& sample) {
    const State& state = memory.as<State>();
    const float t = state.s(state.time(sample.t));
    return keeps_axis(state.x, sample.u, t) && keeps_axis(state.y, sample.v, t);
}

}  // namespace

extern const CullTest clip_space_as_printed_test;
const CullTest clip_space_as_printed_test{"clip-space-as-printed",
                                          "Wu 2013, Clip Space Sample Culling, as printed: loses samples",
                                          prepare,
                                          keeps,
                                          Grain::kPixel,
                                          nullptr,
                                          false};

}  // namespace pentaprism
