// This file is compiled once for each CPU target; it holds the kernels and nothing else.

#include "cover/micropolygon_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "cover/micropolygon_kernels.cpp"
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4)
#include <hwy/foreach_target.h>
// foreach_target.h must come first.
#include <algorithm>
#include <cmath>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace pentaprism {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using F = hn::CappedTag<float, kLanes>;
using Vec = hn::Vec<F>;
using Mask = hn::Mask<F>;

// As those of 4.2: the largest term of a position times 40 unit roundoffs, over the smallest w.
LocalBox rounding_slack(const LocalTriangle& T, float ratio) {
    float scale_x = 0, scale_y = 0, least_w = INFINITY;
    for (int k = 0; k < 3; ++k)
        for (int end = 0; end < 2; ++end) {
            const float e = static_cast<float>(end), w = T.qw[k] + e * T.dw[k], c = std::abs(T.qc[k] + e * T.dc[k]);
            scale_x = std::max(scale_x, std::abs(T.qx[k] + e * T.dx[k]) + c + 17.0f * w);
            scale_y = std::max(scale_y, std::abs(T.qy[k] + e * T.dy[k]) + ratio * c + 17.0f * w);
            least_w = std::min(least_w, w);
        }
    const float x = 40.0f * 0x1p-24f * scale_x / least_w, y = 40.0f * 0x1p-24f * scale_y / least_w;
    return {-x, x, -y, y};
}

}  // namespace

// With all w > 0, (x + u*c) / w over a stratum is extreme at an end of t and of u, at a corner.
void strata_boxes(const Micropolygon& micro, std::span<const Domain> domains, LocalBox* boxes) {
    const LocalTriangle& T = micro.piece;
    if (T.behind) {  // quotients mean nothing there
        std::fill(boxes, boxes + domains.size(), micro.box);
        return;
    }
    const F f;
    float ratio = 1.0f;
    for (const Domain& d : domains) ratio = std::max({ratio, std::abs(d.v0), std::abs(d.v1)});
    const LocalBox slack = rounding_slack(T, ratio);
    const std::size_t lanes = hn::Lanes(f);
    HWY_ALIGN float u0[kLanes], u1[kLanes], v0[kLanes], v1[kLanes], t0[kLanes], t1[kLanes];
    HWY_ALIGN float bx0[kLanes], bx1[kLanes], by0[kLanes], by1[kLanes];
    for (std::size_t first = 0; first < domains.size(); first += lanes) {
        for (std::size_t k = 0; k < lanes; ++k) {
            const Domain& d = domains[std::min(first + k, domains.size() - 1)];
            u0[k] = d.u0, u1[k] = d.u1, v0[k] = d.v0, v1[k] = d.v1, t0[k] = d.t0, t1[k] = d.t1;
        }
        const Vec segments = hn::Set(f, T.segments), segment = hn::Set(f, -T.segment);
        const Vec tau0 = hn::Max(hn::MulAdd(hn::Load(f, t0), segments, segment), hn::Zero(f));
        const Vec tau1 = hn::Min(hn::MulAdd(hn::Load(f, t1), segments, segment), hn::Set(f, 1.0f));
        const Mask outside = hn::Gt(tau0, tau1);
        if (hn::AllTrue(f, outside)) {
            for (std::size_t k = first; k < std::min(first + lanes, domains.size()); ++k) boxes[k] = {1, -1, 1, -1};
            continue;
        }
        Vec x0 = hn::Set(f, INFINITY), x1 = hn::Set(f, -INFINITY), y0 = x0, y1 = x1;
        for (int end = 0; end < 2; ++end) {
            const Vec tau = end == 0 ? tau0 : tau1;
            for (int k = 0; k < 3; ++k) {
                const Vec inverse =
                    hn::Div(hn::Set(f, 1.0f), hn::MulAdd(tau, hn::Set(f, T.dw[k]), hn::Set(f, T.qw[k])));
                const Vec x = hn::Mul(hn::MulAdd(tau, hn::Set(f, T.dx[k]), hn::Set(f, T.qx[k])), inverse);
                const Vec y = hn::Mul(hn::MulAdd(tau, hn::Set(f, T.dy[k]), hn::Set(f, T.qy[k])), inverse);
                const Vec c = hn::Mul(hn::MulAdd(tau, hn::Set(f, T.dc[k]), hn::Set(f, T.qc[k])), inverse);
                const Vec xa = hn::MulAdd(hn::Load(f, u0), c, x), xb = hn::MulAdd(hn::Load(f, u1), c, x);
                const Vec ya = hn::MulAdd(hn::Load(f, v0), c, y), yb = hn::MulAdd(hn::Load(f, v1), c, y);
                x0 = hn::Min(x0, hn::Min(xa, xb)), x1 = hn::Max(x1, hn::Max(xa, xb));
                y0 = hn::Min(y0, hn::Min(ya, yb)), y1 = hn::Max(y1, hn::Max(ya, yb));
            }
        }
        x0 = hn::Add(x0, hn::Set(f, slack.x0)), x1 = hn::Add(x1, hn::Set(f, slack.x1));
        y0 = hn::Add(y0, hn::Set(f, slack.y0)), y1 = hn::Add(y1, hn::Set(f, slack.y1));
        x0 = hn::IfThenElse(outside, hn::Set(f, INFINITY), x0);
        hn::Store(hn::Max(x0, hn::Set(f, micro.box.x0)), f, bx0);
        hn::Store(hn::Min(x1, hn::Set(f, micro.box.x1)), f, bx1);
        hn::Store(hn::Max(y0, hn::Set(f, micro.box.y0)), f, by0);
        hn::Store(hn::Min(y1, hn::Set(f, micro.box.y1)), f, by1);
        for (std::size_t k = 0; k < lanes && first + k < domains.size(); ++k)
            boxes[first + k] = {bx0[k], bx1[k], by0[k], by1[k]};
    }
}

namespace {

HWY_INLINE Vec edge(const Vec x[3], const Vec y[3], int i, int j) {
    return hn::Sub(hn::Mul(x[i], y[j]), hn::Mul(x[j], y[i]));
}

// Samples that are not outside any edge, by the numbers of the exact test.
HWY_INLINE Mask not_outside(F f, const LocalTriangle& T, const SampleVector& s, int lane, Vec hx, Vec hy, Vec tau) {
    const Vec u = hn::Load(f, s.u + lane), v = hn::Load(f, s.v + lane), zero = hn::Zero(f);
    Vec x[3], y[3];
    for (int k = 0; k < 3; ++k) {
        const Vec w = hn::MulAdd(tau, hn::Set(f, T.dw[k]), hn::Set(f, T.qw[k]));
        const Vec c = hn::MulAdd(tau, hn::Set(f, T.dc[k]), hn::Set(f, T.qc[k]));
        x[k] = hn::NegMulAdd(hx, w, hn::MulAdd(u, c, hn::MulAdd(tau, hn::Set(f, T.dx[k]), hn::Set(f, T.qx[k]))));
        y[k] = hn::NegMulAdd(hy, w, hn::MulAdd(v, c, hn::MulAdd(tau, hn::Set(f, T.dy[k]), hn::Set(f, T.qy[k]))));
    }
    const Vec e0 = edge(x, y, 1, 2), e1 = edge(x, y, 2, 0), e2 = edge(x, y, 0, 1);
    return hn::Or(hn::Ge(hn::Min(hn::Min(e0, e1), e2), zero), hn::Le(hn::Max(hn::Max(e0, e1), e2), zero));
}

}  // namespace

std::int64_t find_lanes(const LocalTriangle& T, const SampleVector* samples, const LocalBox* boxes,
                        std::span<MicroJob> jobs) {
    const F f;
    std::int64_t tested = 0;
    for (MicroJob& job : jobs) {
        const SampleVector& s = samples[job.vector];
        const LocalBox& box = boxes[job.box];
        std::uint32_t found = 0;
        for (int lane = 0; lane < kLanes; lane += static_cast<int>(hn::Lanes(f))) {
            const Vec hx = hn::Load(f, s.x + lane), hy = hn::Load(f, s.y + lane);
            Mask inside = hn::And(hn::And(hn::Ge(hx, hn::Set(f, box.x0)), hn::Le(hx, hn::Set(f, box.x1))),
                                  hn::And(hn::Ge(hy, hn::Set(f, box.y0)), hn::Le(hy, hn::Set(f, box.y1))));
            if (hn::AllFalse(f, inside)) continue;
            const Vec tau = hn::MulAdd(hn::Load(f, s.t + lane), hn::Set(f, T.segments), hn::Set(f, -T.segment));
            inside = hn::And(inside, hn::And(hn::Ge(tau, hn::Zero(f)), hn::Lt(tau, hn::Set(f, 1.0f))));
            if (hn::AllFalse(f, inside)) continue;
            tested += static_cast<std::int64_t>(hn::CountTrue(f, inside));
            const Mask kept = hn::And(inside, not_outside(f, T, s, lane, hx, hy, tau));
            std::uint8_t bits[8] = {};
            hn::StoreMaskBits(f, kept, bits);
            found |= (bits[0] | static_cast<std::uint32_t>(bits[1]) << 8) << lane;
        }
        job.lanes = static_cast<std::uint16_t>(found);
    }
    return tested;
}

MicropolygonKernels kernels() {
    return {strata_boxes, find_lanes};
}

}  // namespace HWY_NAMESPACE
}  // namespace pentaprism
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include "base/cpu_dispatch.h"

namespace pentaprism {
namespace {

// Without vectors: no intervals, and every sample of the box is for the exact test to decide.
void whole_boxes(const Micropolygon& micro, std::span<const Domain> domains, LocalBox* boxes) {
    std::fill(boxes, boxes + domains.size(), micro.box);
}
std::int64_t lanes_in_box(const LocalTriangle& T, const SampleVector* samples, const LocalBox* boxes,
                          std::span<MicroJob> jobs) {
    std::int64_t tested = 0;
    for (MicroJob& job : jobs) {
        const SampleVector& s = samples[job.vector];
        const LocalBox& box = boxes[job.box];
        job.lanes = 0;
        for (int lane = 0; lane < kLanes; ++lane) {
            const float tau = std::fma(s.t[lane], T.segments, -T.segment);
            if (tau >= 0.0f && tau < 1.0f && s.x[lane] >= box.x0 && s.x[lane] <= box.x1 && s.y[lane] >= box.y0 &&
                s.y[lane] <= box.y1) {
                job.lanes = static_cast<std::uint16_t>(job.lanes | 1u << lane);
                ++tested;
            }
        }
    }
    return tested;
}

}  // namespace

MicropolygonKernels micropolygon_kernels() {
    PENTAPRISM_RETURN_FOR_CPU(kernels());
    return {whole_boxes, lanes_in_box};
}

}  // namespace pentaprism
#endif
