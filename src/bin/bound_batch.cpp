// screen_bounds(), covered_pixels() and facing() with triangles in the lanes. Those compute in double, these in float:
// slacks are wider by what that rounds. A triangle at the camera plane and an orthographic view take the scalar
// functions. Bounds may differ from one CPU target to the next; what is hit does not depend on them.
//
// This file is compiled once for each CPU target.

#include "bin/bound_batch.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "bin/bound_batch.cpp"
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4)
#include <hwy/foreach_target.h>
// foreach_target.h must come first.
#include <algorithm>
#include <bit>
#include <cmath>
#include <hwy/highway.h>

#include "bound/facing.h"
#include "frame/opacity.h"

namespace pentaprism {

// Defined once, below: one triangle's segment, whatever it is; whether nothing of it is ever there.
void bound_one(const Frame& frame, std::uint32_t triangle, int segment, const PixelRect& limits,
               std::vector<BinnedTriangle>& out);
bool is_clear(const Frame& frame, std::uint32_t triangle);

}  // namespace pentaprism

HWY_BEFORE_NAMESPACE();
namespace pentaprism {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
constexpr int kBatch = 16;
using F = hn::CappedTag<float, kBatch>;
using Vec = hn::Vec<F>;
using Mask = hn::Mask<F>;
using I = hn::RebindToSigned<F>;
constexpr int kWidth = static_cast<int>(hn::MaxLanes(F()));
constexpr float kUnitRoundoff = 1.0f / 16777216.0f;
constexpr float kLargest = 1e12f;  // edge functions times w grow like the cube: beyond it they would overflow

struct Points {
    Vec x, y, w, c;
};

// What the bounds of one segment of a batch are written to.
struct BatchBounds {
    HWY_ALIGN std::int32_t x0[kBatch], x1[kBatch], y0[kBatch], y1[kBatch], facing[kBatch];
    HWY_ALIGN float nearest_w[kBatch];
    std::uint32_t seen = 0, scalar = 0;  // by lane: bounded here; left to bound_one()
};

struct Limits {
    float x0, x1, y0, y1, half_width, half_height, w_near, ratio;
    bool sharp;
};

HWY_INLINE Vec determinant(const Vec x[3], const Vec y[3], const Vec w[3]) {
    const auto minor = [](Vec a, Vec b, Vec c, Vec d) HWY_ATTR { return hn::MulSub(a, b, hn::Mul(c, d)); };
    Vec sum = hn::Mul(x[0], minor(y[1], w[2], w[1], y[2]));
    sum = hn::NegMulAdd(y[0], minor(x[1], w[2], w[1], x[2]), sum);
    return hn::MulAdd(w[0], minor(x[1], y[2], y[1], x[2]), sum);
}

// facing(): 1 always front, -1 always back, 0 perhaps both. Bernstein coefficients as there.
HWY_INLINE Vec facing_of(F f, const Points P[3][2], bool still, const Limits& limits) {
    Vec d0[4], du[4], dv[4];
    for (int j = 0; j < 4; ++j) d0[j] = du[j] = dv[j] = hn::Zero(f);
    Vec size_x = hn::Zero(f), size_y = size_x, size_w = size_x;
    const Vec ratio = hn::Set(f, limits.ratio);
    for (int i = 0; i < 3; ++i)
        for (int end = 0; end < 2; ++end) {
            const Points& p = P[i][end];
            const Vec c = hn::Abs(p.c);
            size_x = hn::Max(size_x, hn::Add(hn::Abs(p.x), c));
            size_y = hn::Max(size_y, hn::MulAdd(ratio, c, hn::Abs(p.y)));
            size_w = hn::Max(size_w, hn::Abs(p.w));
        }
    for (int choice = 0; choice < (still ? 1 : 8); ++choice) {
        const int j = std::popcount(static_cast<unsigned>(choice));
        Vec x[3], y[3], w[3], c[3];
        for (int i = 0; i < 3; ++i) {
            const Points& p = P[i][choice >> i & 1];
            x[i] = p.x, y[i] = p.y, w[i] = p.w, c[i] = p.c;
        }
        d0[j] = hn::Add(d0[j], determinant(x, y, w));
        if (limits.sharp) continue;
        du[j] = hn::Add(du[j], determinant(c, y, w));
        dv[j] = hn::Add(dv[j], determinant(x, c, w));
    }
    // 64 as in facing(), 32 for determinants in float. Sums of three stand for their mean: tau and rho alike.
    const Vec sixteen = hn::Set(f, 16.0f);
    const Vec tau = hn::Mul(hn::Mul(hn::MulAdd(sixteen, size_w, size_x), hn::MulAdd(sixteen, size_w, size_y)),
                            hn::Mul(size_w, hn::Set(f, 96.0f * kUnitRoundoff)));
    const Vec zero = hn::Zero(f);
    Mask front = hn::Gt(tau, hn::Set(f, 1e-30f)), back = front;  // not where products underflow
    for (int j = 0; j < (still ? 1 : 4); ++j) {
        const Vec slack = j == 1 || j == 2 ? hn::Mul(tau, hn::Set(f, 3.0f)) : tau;
        // hypot(a, b) <= max + (sqrt 2 - 1) min; squares of small numbers would vanish.
        const Vec rho_x = hn::Abs(du[j]), rho_y = hn::Mul(ratio, hn::Abs(dv[j]));
        const Vec rho = hn::MulAdd(hn::Set(f, 0.4143f), hn::Min(rho_x, rho_y), hn::Max(rho_x, rho_y));
        front = hn::And(front, hn::Gt(hn::Sub(d0[j], rho), slack));
        back = hn::And(back, hn::Lt(hn::Add(d0[j], rho), hn::Neg(slack)));
    }
    const Vec one = hn::Set(f, 1.0f);
    return hn::IfThenElse(front, one, hn::IfThenElse(back, hn::Neg(one), zero));
}

HWY_INLINE std::uint32_t bits_of(F f, Mask mask) {
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(f, mask, bytes);
    return bytes[0] | (kWidth > 8 ? bytes[1] << 8 : 0);
}

// Lanes [lane, lane + kWidth) of a batch of which `wanted` exist.
HWY_INLINE void bound_lanes(F f, const Points P[3][2], bool still, const Limits& limits, int lane, BatchBounds& out) {
    const I i;
    const Vec zero = hn::Zero(f), ratio = hn::Set(f, limits.ratio), infinity = hn::Set(f, INFINITY);
    Vec largest = zero, not_finite = zero, least_w = infinity, most_w = zero;
    Vec x0 = infinity, y0 = infinity, x1 = hn::Neg(infinity), y1 = x1, scale_x = zero, scale_y = zero;
    for (int k = 0; k < 3; ++k)
        for (int end = 0; end < (still ? 1 : 2); ++end) {
            const Points& p = P[k][end];
            const Vec ax = hn::Abs(p.x), ay = hn::Abs(p.y), cx = hn::Abs(p.c), cy = hn::Mul(ratio, cx);
            largest = hn::Max(largest, hn::Max(hn::Max(ax, ay), hn::Max(hn::Abs(p.w), cx)));
            // 0, or NaN where a term is not finite: comparisons alone would lose that.
            not_finite = hn::Add(not_finite, hn::Mul(zero, hn::Add(hn::Add(p.x, p.y), hn::Add(p.w, p.c))));
            least_w = hn::Min(least_w, p.w);
            most_w = hn::Max(most_w, p.w);
            const Vec inverse = hn::Div(hn::Set(f, 1.0f), p.w);
            x0 = hn::Min(x0, hn::Mul(hn::Sub(p.x, cx), inverse));
            x1 = hn::Max(x1, hn::Mul(hn::Add(p.x, cx), inverse));
            y0 = hn::Min(y0, hn::Mul(hn::Sub(p.y, cy), inverse));
            y1 = hn::Max(y1, hn::Mul(hn::Add(p.y, cy), inverse));
            scale_x = hn::Max(scale_x, hn::Add(ax, cx));
            scale_y = hn::Max(scale_y, hn::Add(ay, cy));
        }
    const Mask usable = hn::And(hn::Le(largest, hn::Set(f, kLargest)), hn::Eq(not_finite, zero));
    const Mask in_front = hn::Ge(least_w, hn::Set(f, limits.w_near));
    // screen_bounds() has 16; the rest is for quotients in float and for the middle of the picture added below.
    const Vec slack = hn::Div(hn::Set(f, 24.0f * kUnitRoundoff), least_w);
    const auto moved = [&](Vec scale, Vec low, Vec high, float half) HWY_ATTR {
        const Vec reach = hn::Min(hn::Max(hn::Abs(low), hn::Abs(high)), hn::Set(f, 32768.0f));
        const Vec all = hn::MulAdd(most_w, hn::Add(hn::Set(f, 32.0f), reach), scale);
        return hn::MulAdd(slack, all, hn::Set(f, 4.0f * kUnitRoundoff * half));
    };
    const Vec slack_x = moved(scale_x, x0, x1, limits.half_width), slack_y = moved(scale_y, y0, y1, limits.half_height);
    const Vec half_width = hn::Set(f, limits.half_width), half_height = hn::Set(f, limits.half_height);
    const Vec one = hn::Set(f, 1.0f);
    const Vec left = hn::Floor(hn::Add(hn::Sub(x0, slack_x), half_width));
    const Vec right = hn::Add(hn::Floor(hn::Add(hn::Add(x1, slack_x), half_width)), one);
    const Vec top = hn::Floor(hn::Sub(half_height, hn::Add(y1, slack_y)));
    const Vec bottom = hn::Add(hn::Floor(hn::Sub(half_height, hn::Sub(y0, slack_y))), one);
    // Reject before clamping.
    const Vec lx0 = hn::Set(f, limits.x0), lx1 = hn::Set(f, limits.x1), ly0 = hn::Set(f, limits.y0),
              ly1 = hn::Set(f, limits.y1);
    const Mask within =
        hn::And(hn::And(hn::Lt(left, lx1), hn::Gt(right, lx0)), hn::And(hn::Lt(top, ly1), hn::Gt(bottom, ly0)));
    const Mask seen = hn::And(hn::And(usable, in_front), within);
    out.seen |= bits_of(f, seen) << lane;
    out.scalar |= bits_of(f, hn::AndNot(in_front, usable)) << lane;
    if (hn::AllFalse(f, seen)) return;
    hn::Store(hn::ConvertTo(i, hn::Max(left, lx0)), i, out.x0 + lane);
    hn::Store(hn::ConvertTo(i, hn::Min(right, lx1)), i, out.x1 + lane);
    hn::Store(hn::ConvertTo(i, hn::Max(top, ly0)), i, out.y0 + lane);
    hn::Store(hn::ConvertTo(i, hn::Min(bottom, ly1)), i, out.y1 + lane);
    hn::Store(hn::Max(hn::NegMulAdd(hn::Set(f, 3.0f * kUnitRoundoff), most_w, least_w), hn::Set(f, limits.w_near)), f,
              out.nearest_w + lane);
    hn::Store(hn::ConvertTo(i, facing_of(f, P, still, limits)), i, out.facing + lane);
}

// Up to kBatch triangles of one part, all its segments, then out in the order of triangles.
class PartBatch {
  public:
    PartBatch(const Frame& frame, const Part& part, const Limits& limits, const PixelRect& rect)
        : frame_(frame), part_(part), limits_(limits), rect_(rect), segments_(part.moves ? part.segments : 1) {
        bounds_.resize(segments_);
    }

    void run(std::uint32_t first, int count, std::vector<BinnedTriangle>& out) {
        const F f;
        for (int segment = 0; segment < segments_; ++segment) bounds_[segment].seen = bounds_[segment].scalar = 0;
        for (int knot = 0; knot <= (part_.moves ? segments_ : 0); ++knot) {
            load_knot(first, count, knot, buffer_[knot % 2]);
            if (part_.moves && knot == 0) continue;
            const int segment = part_.moves ? knot - 1 : 0;
            for (int lane = 0; lane < count; lane += kWidth) {
                Points P[3][2];
                for (int i = 0; i < 3; ++i)
                    for (int end = 0; end < 2; ++end) {
                        const glm::vec4* from = buffer_[part_.moves ? (segment + end) % 2 : 0][i] + lane;
                        hn::LoadInterleaved4(f, &from->x, P[i][end].x, P[i][end].y, P[i][end].w, P[i][end].c);
                    }
                bound_lanes(f, P, !part_.moves, limits_, lane, bounds_[segment]);
            }
        }
        for (int lane = 0; lane < count; ++lane) {
            if (part_.alpha_mode != AlphaMode::kOpaque && is_clear(frame_, first + static_cast<std::uint32_t>(lane)))
                continue;
            for (int segment = 0; segment < segments_; ++segment) emit(first, lane, segment, out);
        }
    }

  private:
    using Knot = glm::vec4[3][kBatch];

    void load_knot(std::uint32_t first, int count, int knot, Knot& to) const {
        const glm::vec4* points = frame_.points.data() + static_cast<std::size_t>(knot) * part_.vertex_count;
        const std::uint32_t* corners = &frame_.corners[3 * std::size_t{first}];
        for (int lane = 0; lane < count; ++lane)
            for (int i = 0; i < 3; ++i) to[i][lane] = points[corners[3 * lane + i]];
        for (int lane = count; lane < kBatch; ++lane)
            for (int i = 0; i < 3; ++i) to[i][lane] = to[i][0];
    }

    void emit(std::uint32_t first, int lane, int segment, std::vector<BinnedTriangle>& out) const {
        const BatchBounds& b = bounds_[segment];
        const std::uint32_t triangle = first + static_cast<std::uint32_t>(lane);
        if (b.scalar >> lane & 1) return bound_one(frame_, triangle, segment, rect_, out);
        if ((b.seen >> lane & 1) == 0) return;
        const int side = b.facing[lane];
        if (!part_.two_sided && side < 0) return;
        out.push_back({triangle, static_cast<std::uint16_t>(segment), static_cast<std::uint16_t>(b.x0[lane]),
                       static_cast<std::uint16_t>(b.x1[lane]), static_cast<std::uint16_t>(b.y0[lane]),
                       static_cast<std::uint16_t>(b.y1[lane]), static_cast<Facing>(side), b.nearest_w[lane]});
    }

    const Frame& frame_;
    const Part& part_;
    const Limits& limits_;
    const PixelRect& rect_;
    int segments_;
    std::vector<BatchBounds> bounds_;  // by segment
    alignas(64) Knot buffer_[2];
};

}  // namespace

void bound_all(const Frame& frame, std::uint32_t first, std::uint32_t last, const PixelRect& rect,
               std::vector<BinnedTriangle>& out) {
    const View& view = frame.view;
    float w_near = static_cast<float>(view.w_near());
    if (w_near < view.w_near()) w_near = std::nextafter(w_near, INFINITY);
    const Limits limits{static_cast<float>(rect.x0),
                        static_cast<float>(rect.x1),
                        static_cast<float>(rect.y0),
                        static_cast<float>(rect.y1),
                        0.5f * static_cast<float>(view.width),
                        0.5f * static_cast<float>(view.height),
                        w_near,
                        static_cast<float>(view.lens.ratio),
                        view.lens.pinhole()};
    while (first < last) {
        const Part& part = frame.parts[frame.part_of[first]];
        const std::uint32_t end = std::min(last, part.first_triangle + part.triangle_count);
        PartBatch batch(frame, part, limits, rect);
        for (; first < end; first += std::min<std::uint32_t>(kBatch, end - first))
            batch.run(first, static_cast<int>(std::min<std::uint32_t>(kBatch, end - first)), out);
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace pentaprism
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include "base/cpu_dispatch.h"

namespace pentaprism {
namespace {

bool is_usable(const MovingTriangle& m) {
    constexpr float kLargest = 1e12f;
    for (int i = 0; i < 3; ++i)
        for (int end = 0; end < 2; ++end)
            for (const float v : {m.x[i][end], m.y[i][end], m.w[i][end], m.c[i][end], m.z[i][end]})
                if (!(std::abs(v) <= kLargest)) return false;
    return true;
}

void bound_one_by_one(const Frame& frame, std::uint32_t first, std::uint32_t last, const PixelRect& limits,
                      std::vector<BinnedTriangle>& out) {
    for (std::uint32_t triangle = first; triangle < last; ++triangle) {
        if (is_clear(frame, triangle)) continue;
        const Part& part = frame.parts[frame.part_of[triangle]];
        for (int segment = 0; segment < (part.moves ? part.segments : 1); ++segment)
            bound_one(frame, triangle, segment, limits, out);
    }
}

}  // namespace

bool is_clear(const Frame& frame, std::uint32_t triangle) {
    return opacity_class(frame, triangle) == OpacityClass::kClear;
}

void bound_one(const Frame& frame, std::uint32_t triangle, int segment, const PixelRect& limits,
               std::vector<BinnedTriangle>& out) {
    const View& view = frame.view;
    const MovingTriangle m = moving_triangle(frame, triangle, segment);
    if (!is_usable(m)) return;
    const ScreenBox box = screen_bounds(m, view.w_near(), view.lens.ratio);
    const PixelRect rect = covered_pixels(box, view.width, view.height, limits);
    if (rect.empty()) return;
    const Facing side = facing(m, view.lens.ratio);
    if (!frame.parts[frame.part_of[triangle]].two_sided && side == Facing::kBack) return;
    out.push_back({triangle, static_cast<std::uint16_t>(segment), static_cast<std::uint16_t>(rect.x0),
                   static_cast<std::uint16_t>(rect.x1), static_cast<std::uint16_t>(rect.y0),
                   static_cast<std::uint16_t>(rect.y1), side, static_cast<float>(box.nearest_w)});
}

void bound_triangles(const Frame& frame, std::uint32_t first, std::uint32_t last, const PixelRect& limits,
                     std::vector<BinnedTriangle>& out) {
    if (!frame.view.perspective) return bound_one_by_one(frame, first, last, limits, out);
    PENTAPRISM_RETURN_FOR_CPU(bound_all(frame, first, last, limits, out));
    return bound_one_by_one(frame, first, last, limits, out);
}

}  // namespace pentaprism
#endif
