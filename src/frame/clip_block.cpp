// The same numbers on every CPU target: products, sums and quotients of doubles, one rounding each, in the order that
// is written here. This file is compiled once for each target.

#include "frame/clip_block.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "frame/clip_block.cpp"
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
constexpr std::size_t kSize = PointBlock::kSize;
using D = hn::CappedTag<double, kSize>;
using Vec = hn::Vec<D>;
using Mask = hn::Mask<D>;

// Row `row` of matrix * (x, y, z, 1), for one column of constants each.
struct Row {
    Vec x, y, z, one;
    Row(D d, const glm::dmat4& m, int row)
        : x(hn::Set(d, m[0][row])), y(hn::Set(d, m[1][row])), z(hn::Set(d, m[2][row])), one(hn::Set(d, m[3][row])) {}
};

void transform_block(const glm::dmat4& matrix, const PointBlock& points, PointBlock& out) {
    const D d;
    const Row rows[3] = {{d, matrix, 0}, {d, matrix, 1}, {d, matrix, 2}};
    double* const to[3] = {out.x, out.y, out.z};
    for (std::size_t i = 0; i < kSize; i += hn::Lanes(d)) {
        const Vec x = hn::Load(d, points.x + i), y = hn::Load(d, points.y + i), z = hn::Load(d, points.z + i);
        for (int k = 0; k < 3; ++k) {
            const Row& r = rows[k];
            const Vec sum = hn::Add(hn::Add(hn::Mul(r.x, x), hn::Mul(r.y, y)), hn::Mul(r.z, z));
            hn::Store(hn::Add(sum, r.one), d, to[k] + i);
        }
    }
}

// With circles of confusion a + b * z.
void to_clip_straight(const View& view, const glm::dmat4& to_camera, const PointBlock& world, ClipBlock& out) {
    const D d;
    const Row rows[3] = {{d, to_camera, 0}, {d, to_camera, 1}, {d, to_camera, 2}};
    const Vec fx = hn::Set(d, view.fx), fy = hn::Set(d, view.fy), one = hn::Set(d, 1.0);
    const Vec a = hn::Set(d, view.lens.a), b = hn::Set(d, view.lens.b);
    const Vec tilt_x = hn::Set(d, view.lens.tilt.x), tilt_y = hn::Set(d, view.lens.tilt.y);
    const bool leans = view.lens.tilt != glm::dvec2(0.0);
    for (std::size_t i = 0; i < kSize; i += hn::Lanes(d)) {
        const Vec wx = hn::Load(d, world.x + i), wy = hn::Load(d, world.y + i), wz = hn::Load(d, world.z + i);
        const auto camera = [&](const Row& r) HWY_ATTR {
            return hn::Add(hn::Add(hn::Mul(r.x, wx), hn::Mul(r.y, wy)), hn::Add(hn::Mul(r.z, wz), r.one));
        };
        const Vec x = hn::Mul(fx, camera(rows[0])), y = hn::Mul(fy, camera(rows[1])), depth = hn::Neg(camera(rows[2]));
        Vec z = depth;  // along the axis of a plane of focus that leans
        if (leans) z = hn::Add(hn::Add(depth, hn::Div(hn::Mul(tilt_x, x), fx)), hn::Div(hn::Mul(tilt_y, y), fy));
        hn::Store(x, d, out.x + i);
        hn::Store(y, d, out.y + i);
        hn::Store(view.perspective ? depth : one, d, out.w + i);
        hn::Store(depth, d, out.z + i);
        hn::Store(hn::Add(a, hn::Mul(b, z)), d, out.c + i);
    }
}

void to_clip_block(const View& view, const glm::dmat4& to_camera, const PointBlock& world, ClipBlock& out) {
    to_clip_straight(view, to_camera, world, out);
    if (view.lens.straight()) return;
    for (std::size_t i = 0; i < kSize; ++i) out.c[i] = view.coc(out.x[i], out.y[i], out.z[i]);
}

bool is_block_equal(const ClipBlock& p, const ClipBlock& q) {
    const D d;
    for (std::size_t i = 0; i < kSize; i += hn::Lanes(d)) {
        const auto same = [&](const double* a, const double* b)
                              HWY_ATTR { return hn::Eq(hn::Load(d, a + i), hn::Load(d, b + i)); };
        const Mask equal = hn::And(hn::And(hn::And(same(p.x, q.x), same(p.y, q.y)), same(p.w, q.w)),
                                   hn::And(same(p.z, q.z), same(p.c, q.c)));
        if (!hn::AllTrue(d, equal)) return false;
    }
    return true;
}

double worst_path_error(const View& view, const ClipBlock& p, const ClipBlock& q, const ClipBlock& truth, double s) {
    const D d;
    const Vec reach = hn::Set(d, 2.0 * std::max(view.width, view.height)), near = hn::Set(d, view.w_near());
    const Vec fraction = hn::Set(d, s);
    const bool blur_bends = !view.has_straight_sight();
    Vec worst = hn::Zero(d);
    for (std::size_t i = 0; i < kSize; i += hn::Lanes(d)) {
        const auto straight = [&](const double* from, const double* to) HWY_ATTR {
            const Vec a = hn::Load(d, from + i);
            return hn::Add(a, hn::Mul(fraction, hn::Sub(hn::Load(d, to + i), a)));
        };
        const Vec w = straight(p.w, q.w), true_w = hn::Load(d, truth.w + i);
        const Vec x = hn::Div(hn::Load(d, truth.x + i), true_w), y = hn::Div(hn::Load(d, truth.y + i), true_w);
        Mask counts = hn::And(hn::Ge(true_w, near), hn::Ge(w, near));
        counts = hn::And(counts, hn::And(hn::Lt(hn::Abs(x), reach), hn::Lt(hn::Abs(y), reach)));
        const auto keep_worse = [&](Vec squared) HWY_ATTR {
            worst = hn::IfThenElse(hn::And(counts, hn::Gt(squared, worst)), squared, worst);
        };
        const Vec dx = hn::Sub(hn::Div(straight(p.x, q.x), w), x), dy = hn::Sub(hn::Div(straight(p.y, q.y), w), y);
        keep_worse(hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy)));
        if (!blur_bends) continue;
        const Vec dr = hn::Sub(hn::Div(straight(p.c, q.c), w), hn::Div(hn::Load(d, truth.c + i), true_w));
        keep_worse(hn::Mul(dr, dr));
    }
    return std::sqrt(hn::GetLane(hn::MaxOfLanes(d, worst)));
}

}  // namespace

ClipKernels block_kernels() {
    return {transform_block, to_clip_block, is_block_equal, worst_path_error};
}

}  // namespace HWY_NAMESPACE
}  // namespace pentaprism
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include "base/cpu_dispatch.h"

namespace pentaprism {

ClipKernels clip_kernels() {
    PENTAPRISM_RETURN_FOR_CPU(block_kernels());
    return HWY_STATIC_DISPATCH(block_kernels)();
}

}  // namespace pentaprism
#endif
