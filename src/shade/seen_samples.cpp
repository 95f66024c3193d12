// Compiled once for each CPU target.

#include "shade/seen_samples.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "shade/seen_samples.cpp"
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4)
#include <hwy/foreach_target.h>
// foreach_target.h must come first.
#include <algorithm>
#include <cmath>
#include <hwy/highway.h>
#include <numbers>

HWY_BEFORE_NAMESPACE();
namespace pentaprism {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using F = hn::CappedTag<float, kLanes>;
using I = hn::RebindToSigned<F>;
using U = hn::RebindToUnsigned<F>;
using Vec = hn::Vec<F>;
using IVec = hn::Vec<I>;
using UVec = hn::Vec<U>;
using Mask = hn::Mask<F>;
constexpr int kWidth = static_cast<int>(hn::MaxLanes(F()));

HWY_INLINE Vec plus_product(Vec sum, Vec a, Vec b) {
    return hn::Add(sum, hn::Mul(a, b));
}

HWY_INLINE Vec product_difference(Vec a, Vec b, Vec c, Vec d) {
    return hn::Sub(hn::Mul(a, b), hn::Mul(c, d));
}

// Barycentrics and side of the samples whose time belongs to the triangle's segment.
HWY_INLINE void project(F f, const SeenSamples::Batch& batch, const LocalTriangle& T, int first, Vec hx, Vec hy, Vec u,
                        Vec v) {
    const I d;
    const Vec zero = hn::Zero(f), one = hn::Set(f, 1.0f);
    const Vec along = hn::Mul(hn::LoadU(f, batch.t + first), hn::Set(f, T.segments));
    const Vec segment = hn::Min(hn::ConvertTo(f, hn::ConvertTo(d, along)), hn::Set(f, T.segments - 1.0f));
    const Mask here = hn::Eq(segment, hn::Set(f, T.segment));
    const Vec tau = hn::Sub(along, hn::Set(f, T.segment));
    Vec x[3], y[3];
    for (int k = 0; k < 3; ++k) {
        const auto moved = [&](float q, float change)
                               HWY_ATTR { return plus_product(hn::Set(f, q), tau, hn::Set(f, change)); };
        const Vec w = moved(T.qw[k], T.dw[k]), c = moved(T.qc[k], T.dc[k]);
        x[k] = hn::Sub(plus_product(moved(T.qx[k], T.dx[k]), u, c), hn::Mul(hx, w));
        y[k] = hn::Sub(plus_product(moved(T.qy[k], T.dy[k]), v, c), hn::Mul(hy, w));
    }
    const Vec e[3] = {product_difference(x[1], y[2], x[2], y[1]), product_difference(x[2], y[0], x[0], y[2]),
                      product_difference(x[0], y[1], x[1], y[0])};
    const Vec sum = hn::Add(hn::Add(e[0], e[1]), e[2]);
    // Rounding, and slivers' samples, may lie just outside.
    const Vec over_sum = hn::Div(one, sum);
    Vec inside[3];
    for (int k = 0; k < 3; ++k) inside[k] = hn::Max(hn::Mul(e[k], over_sum), zero);
    const Vec total = hn::Add(hn::Add(inside[0], inside[1]), inside[2]), over_total = hn::Div(one, total);
    const Mask usable = hn::And(hn::IsFinite(total), hn::Gt(total, zero));
    for (int k = 0; k < 3; ++k)
        hn::BlendedStore(hn::IfThenElse(usable, hn::Mul(inside[k], over_total), hn::Set(f, 1.0f / 3.0f)), here, f,
                         batch.b[k] + first);
    const U unsigned_lanes;
    const UVec side =
        hn::IfThenElseZero(hn::RebindMask(unsigned_lanes, hn::Gt(sum, zero)), hn::Set(unsigned_lanes, CellKey::kFront));
    hn::BlendedStore(side, hn::RebindMask(unsigned_lanes, here), unsigned_lanes, batch.kind + first);
}

void project(const SeenSamples::Batch& batch) {
    const F f;
    for (int first = 0; first < kLanes; first += kWidth) {
        Vec x, y, u, v;
        hn::LoadInterleaved4(f, reinterpret_cast<const float*>(batch.xyuv + first), x, y, u, v);
        for (int i = 0; i < batch.triangle_count; ++i) project(f, batch, *batch.triangles[i], first, x, y, u, v);
    }
}

// log2 of a cell's side, the power of two nearest to a quarter of this length, given squared; `least` to 6.
HWY_INLINE IVec level(F f, Vec length2, int least) {
    constexpr float kBlurShare2 = 2.0f * 0.25f * 0.25f;  // so that rounding down is rounding to the nearest
    const I d;
    const Vec cells2 = hn::Mul(length2, hn::Set(f, kBlurShare2));
    const IVec exponent = hn::Sub(hn::ShiftRight<23>(hn::BitCast(d, cells2)), hn::Set(d, 127));
    const IVec halved = hn::Min(hn::Max(hn::ShiftRight<1>(exponent), hn::Set(d, least)), hn::Set(d, 6));
    return hn::IfThenElse(hn::RebindMask(d, hn::IsFinite(cells2)), halved, hn::Set(d, least));
}

// Number of the direction nearest to (x, y) or (-x, -y).
HWY_INLINE IVec sector(F f, Vec x, Vec y) {
    const I d;
    const Vec zero = hn::Zero(f);
    const Mask below = hn::Or(hn::Lt(y, zero), hn::And(hn::Eq(y, zero), hn::Lt(x, zero)));
    x = hn::IfThenElse(below, hn::Neg(x), x);
    y = hn::IfThenElse(below, hn::Neg(y), y);
    const CellDirections& all = cell_directions();
    IVec passed = hn::Zero(d);
    for (int i = 0; i < CellDirections::kCount; ++i) {
        const Vec turn = product_difference(hn::Set(f, all.border_cosine[i]), y, hn::Set(f, all.border_sine[i]), x);
        passed = hn::Sub(passed, hn::VecFromMask(d, hn::RebindMask(d, hn::Gt(turn, zero))));
    }
    return hn::And(passed, hn::Set(d, CellDirections::kCount - 1));
}

HWY_INLINE IVec floor_of(F f, Vec x, IVec level) {
    const I d;
    const Vec scale = hn::BitCast(f, hn::ShiftLeft<23>(hn::Sub(hn::Set(d, 127), level)));
    return hn::ConvertTo(d, hn::Floor(hn::Mul(x, scale)));
}

void find_cells(const SeenSamples::Batch& batch) {
    const F f;
    const I d;
    const CellTriangle& T = *batch.cells;
    for (int first = 0; first < kLanes; first += kWidth) {
        Vec b[3];
        for (int k = 0; k < 3; ++k) b[k] = hn::Load(f, batch.b[k] + first);
        const auto blend = [&](const float corner[3]) HWY_ATTR {
            return plus_product(plus_product(hn::Mul(b[0], hn::Set(f, corner[0])), b[1], hn::Set(f, corner[1])), b[2],
                                hn::Set(f, corner[2]));
        };
        const Vec w = blend(T.w), over_w = hn::Div(hn::Set(f, 1.0f), w);
        const Vec x = hn::Mul(blend(T.x), over_w), y = hn::Mul(blend(T.y), over_w);
        const Mask usable =
            hn::And(hn::Ge(w, hn::Set(f, T.w_near)), hn::Lt(hn::Max(hn::Abs(x), hn::Abs(y)), hn::Set(f, 16384.0f)));
        const Vec motion_w = blend(T.motion_w);
        const Vec vx = hn::Mul(hn::Sub(blend(T.motion_x), hn::Mul(motion_w, x)), over_w);
        const Vec vy = hn::Mul(hn::Sub(blend(T.motion_y), hn::Mul(motion_w, y)), over_w);
        const Vec coc = hn::Mul(blend(T.coc), over_w), lens2 = hn::Mul(hn::Set(f, 3.0f), hn::Mul(coc, coc));
        const IVec shorter = level(f, lens2, batch.least_level);
        const IVec longer = level(f, plus_product(plus_product(lens2, vx, vx), vy, vy), batch.least_level);

        IVec direction = hn::Zero(d);
        Vec along = x, across = y;
        if (!hn::AllTrue(d, hn::Eq(longer, shorter))) {
            direction = hn::IfThenElseZero(hn::Ne(longer, shorter), sector(f, vx, vy));
            const Vec c = hn::GatherIndex(f, cell_directions().cosine, direction);
            const Vec s = hn::GatherIndex(f, cell_directions().sine, direction);
            along = plus_product(hn::Mul(c, x), s, y);
            across = product_difference(c, y, s, x);
        }
        const IVec half = hn::Set(d, 1 << 15);
        const IVec column = hn::Add(floor_of(f, along, longer), half),
                   row = hn::Add(floor_of(f, across, shorter), half);
        const IVec side = hn::BitCast(d, hn::Load(U(), batch.kind + first));
        const IVec kind = hn::Or(hn::Or(side, hn::ShiftLeft<1>(shorter)),
                                 hn::Or(hn::ShiftLeft<4>(longer), hn::ShiftLeft<7>(direction)));
        const auto take = hn::RebindMask(d, usable);
        const IVec alone = hn::Or(side, hn::BitCast(d, hn::Set(U(), CellKey::kAlone)));
        const IVec index = hn::BitCast(d, hn::LoadU(U(), batch.places + first));
        hn::Store(hn::BitCast(U(), hn::IfThenElse(take, kind, alone)), U(), batch.kind + first);
        hn::Store(hn::BitCast(U(), hn::IfThenElse(take, hn::Or(hn::ShiftLeft<16>(column), row), index)), U(),
                  batch.place + first);
    }
}

}  // namespace

void see_batch(const SeenSamples::Batch& batch) {
    project(batch);
    if (batch.cells != nullptr) find_cells(batch);
}

}  // namespace HWY_NAMESPACE
}  // namespace pentaprism
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include "base/cpu_dispatch.h"

namespace pentaprism {
namespace {

using SeeBatch = void (*)(const SeenSamples::Batch&);

SeeBatch see_batch() {
    PENTAPRISM_RETURN_FOR_CPU(see_batch);
    return HWY_STATIC_DISPATCH(see_batch);
}

}  // namespace

const CellDirections& cell_directions() {
    static const CellDirections made = [] {
        CellDirections all;
        for (int i = 0; i < CellDirections::kCount; ++i) {
            const double angle = std::numbers::pi * i / CellDirections::kCount,
                         border = angle + 0.5 * std::numbers::pi / CellDirections::kCount;
            all.cosine[i] = static_cast<float>(std::cos(angle));
            all.sine[i] = static_cast<float>(std::sin(angle));
            all.border_cosine[i] = static_cast<float>(std::cos(border));
            all.border_sine[i] = static_cast<float>(std::sin(border));
        }
        return all;
    }();
    return made;
}

ShadingCell CellKey::cell() const {
    const int shorter = kind >> 1 & 7, longer = kind >> 4 & 7, direction = kind >> 7 & (CellDirections::kCount - 1);
    const double c = cell_directions().cosine[direction], s = cell_directions().sine[direction];
    const double width = 1 << longer, height = 1 << shorter;
    const double x = (static_cast<int>(place >> 16) - (1 << 15) + 0.5) * width;
    const double y = (static_cast<int>(place & 0xffff) - (1 << 15) + 0.5) * height;
    ShadingCell cell;
    cell.centre = {c * x - s * y, s * x + c * y};
    cell.along = glm::vec2(c * width, s * width);
    cell.across = glm::vec2(-s * height, c * height);
    return cell;
}

void SeenSamples::start(const Frame& frame, const CellCentre& centre, int least_level) {
    least_level_ = least_level;
    frame_ = &frame;
    centre_ = centre;
    see_batch_ = see_batch();
}

const LocalTriangle& SeenSamples::local(int segment) {
    if (!ready_[segment]) locals_[segment] = localize(*frame_, triangle_, segment, centre_);
    ready_[segment] = 1;
    return locals_[segment];
}

void SeenSamples::see(std::uint32_t triangle, const SampleRun& samples, const CellTriangle* cells) {
    triangle_ = triangle;
    const Part& part = frame_->parts[frame_->part_of[triangle]];
    const int segments = part.moves ? part.segments : 1;
    ready_.assign(segments, 0);
    if (static_cast<int>(locals_.size()) < segments) locals_.resize(segments);

    const std::size_t count = samples.places.size(), padded = (count + kLanes - 1) / kLanes * kLanes;
    if (kind_.size() < padded) {
        for (auto& b : b_) b.resize(padded);
        kind_.resize(padded);
        place_.resize(padded);
    }
    const LocalTriangle* triangles[kLanes];
    for (std::size_t first = 0; first < count; first += kLanes) {
        Batch batch{samples.xyuv + first,
                    samples.t + first,
                    samples.places.data() + first,
                    triangles,
                    0,
                    cells,
                    least_level_,
                    {&b_[0][first], &b_[1][first], &b_[2][first]},
                    &kind_[first],
                    &place_[first]};
        std::uint64_t done = 0;  // segments: at most 64 (camera/settings.cpp)
        const int lanes = segments == 1 ? 1 : static_cast<int>(std::min<std::size_t>(kLanes, count - first));
        for (int lane = 0; lane < lanes; ++lane) {
            const int segment = std::min(static_cast<int>(batch.t[lane] * static_cast<float>(segments)), segments - 1);
            if ((done >> segment & 1) != 0) continue;
            done |= std::uint64_t{1} << segment;
            triangles[batch.triangle_count++] = &local(segment);
        }
        see_batch_(batch);
    }
}

}  // namespace pentaprism
#endif
