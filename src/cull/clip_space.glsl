// Twin of clip_space.cpp: what each vertex refuses of the lens, then lines that bound t by the lens coordinate. Wu 2013,
// Clip Space Sample Culling for Stochastic Rasterization, both stages repaired (docs/develop/algorithms.md 4.6).

#include "cull/cull_axis.glsl"

struct OpenInterval {
    double low, high;
};

bool is_empty(OpenInterval i) {
    return !(i.low < i.high);
}

// Where slope * lens + at_zero < 0 for one more function.
void intersect(inout OpenInterval interval, double at_zero, double slope) {
    if (slope > 0.0lf)
        interval.high = min(interval.high, -at_zero / slope);
    else if (slope < 0.0lf)
        interval.low = max(interval.low, -at_zero / slope);
    else if (!(at_zero < 0.0lf))
        interval.high = -kHuge;
}

// Part of the lens in which all six X_j are negative, and that in which all are positive.
struct Stage1 {
    OpenInterval all_negative, all_positive;
    double kept0, kept1;  // the hull of what is left of the lens
};

void keep_outside(OpenInterval refused, inout Stage1 s) {
    if (is_empty(refused)) return;
    if (s.kept0 > refused.low && s.kept0 < refused.high) s.kept0 = refused.high;
    if (s.kept1 > refused.low && s.kept1 < refused.high) s.kept1 = refused.low;
}

// False: nothing is kept.
bool stage1(Axis axis, AxisRange range, double slack, out Stage1 s) {
    const double kIn = 1e-5lf;
    s = Stage1(OpenInterval(-kHuge, kHuge), OpenInterval(-kHuge, kHuge), range.lens0, range.lens1);
    double middle = 0.5lf * (range.g0 + range.g1), half_width = 0.5lf * (range.g1 - range.g0);
    for (int end = 0; end < 2; ++end)
        for (int i = 0; i < 3; ++i) {
            double x = axis.p[end][i] - middle * axis.w[end][i], c = axis.c[end][i];
            double reach = half_width * abs(axis.w[end][i]) + slack;
            intersect(s.all_negative, x + reach, c);
            intersect(s.all_positive, -(x - reach), -c);
        }
    s.all_negative = OpenInterval(s.all_negative.low + kIn, s.all_negative.high - kIn);
    s.all_positive = OpenInterval(s.all_positive.low + kIn, s.all_positive.high - kIn);
    keep_outside(s.all_negative, s);
    keep_outside(s.all_positive, s);
    keep_outside(s.all_negative, s);
    return s.kept0 <= s.kept1;
}

// Lines over what stage 1 keeps of the lens between which t lies.
struct Stage2 {
    bool bounded;
    float lens0, per_lens, first0, first_step, last0, last_step;
};

const Stage2 kUnbounded = Stage2(false, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0);

Stage2 stage2(Axis axis, AxisRange range, double lens0, double lens1, double size) {
    if (!(lens0 < lens1)) return kUnbounded;
    double half_width = 0.5lf * (lens1 - lens0), middle = 0.5lf * (lens0 + lens1);
    dvec2 first = dvec2(kHuge), last = dvec2(-kHuge);
    double least_d = kHuge, largest_t = 1.0lf;
    int common_sign = 0;
    for (int side = 0; side < 2; ++side)
        for (int i = 0; i < 3; ++i) {
            double g = side == 0 ? range.g0 : range.g1;
            double x0 = axis.p[0][i] - g * axis.w[0][i], x1 = axis.p[1][i] - g * axis.w[1][i];
            double c0 = axis.c[0][i], c1 = axis.c[1][i];
            double n0 = -x0, n1 = -c0, d0 = x1 - x0, d1 = c1 - c0;
            double da = d0 + d1 * lens0, db = d0 + d1 * lens1;
            double enough = 1e-3lf * (abs(x0) + abs(x1) + abs(c0) + abs(c1));
            int s = da > enough && db > enough ? 1 : da < -enough && db < -enough ? -1 : 0;
            if (s == 0 || (common_sign != 0 && s != common_sign)) return kUnbounded;
            common_sign = s;
            double dm = d0 + d1 * middle;
            double ta = (n0 + n1 * lens0) / da, tb = (n0 + n1 * lens1) / db, tm = (n0 + n1 * middle) / dm;
            double rise = (n1 * d0 - n0 * d1) / (dm * dm) * half_width;
            first = min(first, min(dvec2(ta, tb), dvec2(tm - rise, tm + rise)));
            last = max(last, max(dvec2(ta, tb), dvec2(tm - rise, tm + rise)));
            least_d = min(least_d, min(abs(da), abs(db)));
            largest_t = max(largest_t, max(max(abs(first.x), abs(first.y)), max(abs(last.x), abs(last.y))));
        }
    double out_by = 1e-6lf * largest_t + 16.0lf * kUnitRoundoff * size / least_d;
    if (!(out_by < kHuge)) return kUnbounded;
    return Stage2(true, float(lens0), float(1.0lf / (lens1 - lens0)), float(first.x - out_by), float(first.y - first.x),
                  float(last.x + out_by), float(last.y - last.x));
}

bool axis_keeps(Axis axis, AxisRange range, SegmentDomain domain, float lens, float s) {
    double size = magnitude(axis, range);
    Stage1 lens_kept;
    if (!stage1(axis, range, 32.0lf * kUnitRoundoff * size, lens_kept)) return false;
    OpenInterval above = lens_kept.all_negative, below = lens_kept.all_positive;
    if ((lens > float(above.low) && lens < float(above.high)) || (lens > float(below.low) && lens < float(below.high)))
        return false;
    if (!(domain.s0 < domain.s1)) return true;
    Stage2 lines = stage2(axis, range, lens_kept.kept0, lens_kept.kept1, size);
    if (!lines.bounded) return true;
    precise float f = (lens - lines.lens0) * lines.per_lens, t = (s - domain.s0) * (1.0 / (domain.s1 - domain.s0));
    return t >= fused(f, lines.first_step, lines.first0) && t <= fused(f, lines.last_step, lines.last0);
}

bool clip_space_keeps(LocalTriangle T, Footprint footprint, LocalSample sampled) {
    SegmentDomain domain = segment_domain(T, footprint.domain);
    if (is_empty(domain)) return false;
    Axis x, y;
    axes_at_ends(T, domain.s0, domain.s1, x, y);
    float s = segment_time(T, sampled.t);
    return axis_keeps(x, x_range(footprint, domain), domain, sampled.u, s) &&
           axis_keeps(y, y_range(footprint, domain), domain, sampled.v, s);
}
