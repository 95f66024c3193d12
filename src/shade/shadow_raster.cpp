// Compiled once for each CPU target; the same operations in the same order, none of them fused.

#include "shade/shadow_raster.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "shade/shadow_raster.cpp"
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4)
#include <hwy/foreach_target.h>
// foreach_target.h must come first.
#include <algorithm>
#include <cmath>
#include <hwy/highway.h>
#include <optional>

#include "cover/vector_opacity-inl.h"
#include "sample/net.h"

HWY_BEFORE_NAMESPACE();
namespace pentaprism {
namespace HWY_NAMESPACE {
namespace {

constexpr int kSamples = ShadowSamples::kSamples;

// Texels to each side, between a point and a sample that it asks, as a rule.
constexpr float kReach = 0.5f;

HWY_INLINE Vec product_difference(Vec a, Vec b, Vec c, Vec d) {
    return hn::Sub(hn::Mul(a, b), hn::Mul(c, d));
}

// One motion segment of a triangle, x and y in texels and sheared to the cell's middle. [corner]
struct Sheared {
    float x[3], y[3], z[3];
    float dx[3], dy[3], dz[3];
    float segments, segment, nearest;
    float recedes;  // how much deeper its plane is within kReach
    std::uint32_t triangle;
    bool moves, mixed;  // mixed: its opacity is to be asked
};

// How much deeper the plane through these corners is kReach texels to each side, at mid-segment.
float receding_of(const Sheared& T, bool perspective) {
    float x[3], y[3], z[3];
    for (int k = 0; k < 3; ++k) {
        z[k] = T.moves ? T.z[k] + 0.5f * T.dz[k] : T.z[k];
        const float w = perspective ? 1.0f / z[k] : 1.0f;
        x[k] = (T.moves ? T.x[k] + 0.5f * T.dx[k] : T.x[k]) * w;
        y[k] = (T.moves ? T.y[k] + 0.5f * T.dy[k] : T.y[k]) * w;
    }
    const float ax = x[1] - x[0], ay = y[1] - y[0], az = z[1] - z[0];
    const float bx = x[2] - x[0], by = y[2] - y[0], bz = z[2] - z[0];
    const float area = ax * by - bx * ay;
    const float recedes = kReach * (std::abs(az * by - bz * ay) + std::abs(bz * ax - az * bx)) / std::abs(area);
    return std::isfinite(recedes) ? recedes : 0.0f;  // seen edge-on
}

Sheared shear(const ShadowCellWork& work, const Casters::Box& box) {
    const Frame& frame = work.casters.frame;
    const Part& part = frame.parts[frame.part_of[box.triangle]];
    const bool perspective = frame.view.perspective;
    const float middle = 0.5f * static_cast<float>(work.width) - 0.5f * kCellSize;
    const float centre_x = static_cast<float>(work.cx * kCellSize) - middle;
    const float centre_y = middle - static_cast<float>(work.cy * kCellSize);
    Sheared T;
    T.triangle = box.triangle;
    T.moves = part.moves;
    T.segments = static_cast<float>(part.segments);
    T.segment = static_cast<float>(box.segment);
    T.mixed = box.mixed;
    T.nearest = box.nearest;
    for (int k = 0; k < 3; ++k) {
        const std::size_t at =
            frame.corners[3 * std::size_t{box.triangle} + k] + std::size_t{box.segment} * part.vertex_count;
        const auto place = [&](std::size_t i, float& x, float& y, float& z) {
            const glm::vec4& p = frame.points[i];
            x = p.x * work.scale - centre_x * p.z;
            y = p.y * work.scale - centre_y * p.z;
            z = perspective ? p.z : frame.depths[i];
        };
        place(at, T.x[k], T.y[k], T.z[k]);
        if (!T.moves) continue;
        place(at + part.vertex_count, T.dx[k], T.dy[k], T.dz[k]);
        T.dx[k] -= T.x[k], T.dy[k] -= T.y[k], T.dz[k] -= T.z[k];
    }
    T.recedes = receding_of(T, perspective);
    return T;
}

// Those of the hits that are opaque, as the camera's coverage stage decides it. `terms`: of the triangle, when asked.
Mask opaque(const ShadowCellWork& work, std::uint32_t triangle, std::optional<OpacityTerms>& terms, int first,
            const Vec e[3], Vec sum, Mask hit) {
    const Frame& frame = work.casters.frame;
    if (!terms) terms = opacity_terms(frame, triangle);
    const TileWork tile_work{frame, work.samples.table(), {}, {}, Tile{}};
    return decide_opacity(F(), tile_work, triangle, *terms, e, sum, hit, [&](int lane) {
        const int index = first + lane, texel = index / kSamples;
        return SampleOfPixel{work.cx * kCellSize + texel % kCellSize, work.cy * kCellSize + texel / kCellSize,
                             index % kSamples};
    });
}

template <bool kMoves, bool kPerspective>
HWY_INLINE void test(const ShadowCellWork& work, const ShadowSamples::Cell& samples, const Sheared& T,
                     std::optional<OpacityTerms>& terms, int first, float* depths, float* bounds) {
    const F f;
    const Vec stored = hn::Load(f, depths + first);
    if (hn::AllTrue(f, hn::Le(stored, hn::Set(f, T.nearest)))) return;
    const Vec hx = hn::Load(f, samples.x + first), hy = hn::Load(f, samples.y + first);
    Vec s = hn::Zero(f);
    if constexpr (kMoves)
        s = hn::Sub(hn::Mul(hn::Load(f, samples.t + first), hn::Set(f, T.segments)), hn::Set(f, T.segment));
    const auto at = [&](float q, const float* change, int k) HWY_ATTR {
        if constexpr (kMoves) return hn::Add(hn::Set(f, q), hn::Mul(s, hn::Set(f, change[k])));
        (void)change, (void)k;
        return hn::Set(f, q);
    };
    Vec x[3], y[3], z[3];
    for (int k = 0; k < 3; ++k) {
        z[k] = at(T.z[k], T.dz, k);
        const Vec w = kPerspective ? z[k] : hn::Set(f, 1.0f);
        x[k] = hn::Sub(at(T.x[k], T.dx, k), hn::Mul(hx, w));
        y[k] = hn::Sub(at(T.y[k], T.dy, k), hn::Mul(hy, w));
    }
    const Vec e[3] = {product_difference(x[1], y[2], x[2], y[1]), product_difference(x[2], y[0], x[0], y[2]),
                      product_difference(x[0], y[1], x[1], y[0])};
    const Vec zero = hn::Zero(f);
    const Mask front = hn::Ge(hn::Min(e[0], hn::Min(e[1], e[2])), zero);
    const Mask back = hn::Le(hn::Max(e[0], hn::Max(e[1], e[2])), zero);
    Mask hit = hn::Or(front, back);
    if (hn::AllFalse(f, hit)) return;
    const Vec sum = hn::Add(hn::Add(e[0], e[1]), e[2]);
    const Vec weighted = hn::Add(hn::Add(hn::Mul(e[0], z[0]), hn::Mul(e[1], z[1])), hn::Mul(e[2], z[2]));
    const Vec depth = hn::Div(weighted, sum);
    hit = hn::And(hit, hn::Lt(depth, stored));  // not for a depth that is no number: seen edge-on
    if constexpr (kPerspective)
        hit = hn::And(hit, hn::Ge(depth, hn::Set(f, static_cast<float>(work.casters.frame.view.w_near()))));
    if constexpr (kMoves)
        if (T.segments > 1.0f) hit = hn::And(hit, hn::And(hn::Ge(s, zero), hn::Lt(s, hn::Set(f, 1.0f))));
    if (hn::AllFalse(f, hit)) return;
    if (T.mixed) hit = opaque(work, T.triangle, terms, first, e, sum, hit);
    hn::Store(hn::IfThenElse(hit, depth, stored), f, depths + first);
    const Vec farthest = hn::Max(hn::Max(z[0], z[1]), z[2]);
    const Vec bound = hn::Max(depth, hn::Min(hn::Add(depth, hn::Set(f, T.recedes)), farthest));
    hn::Store(hn::IfThenElse(hit, bound, hn::Load(f, bounds + first)), f, bounds + first);
}

// Texels of the box in the cell, first and last.
struct Rect {
    int x0, x1, y0, y1;
    bool empty() const { return x0 > x1 || y0 > y1; }
};

Rect rect_of(const ShadowCellWork& work, const Casters::Box& box) {
    const double scale = work.scale, half = 0.5 * work.width;
    const int left = work.cx * kCellSize, top = work.cy * kCellSize;
    const auto texel = [](double x, int from, int most) {
        return static_cast<int>(std::floor(std::clamp(x - from, -1.0, most + 0.0)));
    };
    return {std::max(0, texel(box.x0 * scale + half, left, kCellSize)),
            std::min(kCellSize - 1, texel(box.x1 * scale + half, left, kCellSize)),
            std::max(0, texel(half - box.y1 * scale, top, kCellSize)),
            std::min(kCellSize - 1, texel(half - box.y0 * scale, top, kCellSize))};
}

template <bool kMoves, bool kPerspective>
void draw_triangle(const ShadowCellWork& work, const Sheared& T, const Rect& rect, float* depths, float* bounds) {
    const ShadowSamples::Cell& samples = work.samples.cell(work.cx, work.cy);
    std::optional<OpacityTerms> terms;
    for (int row = rect.y0; row <= rect.y1; ++row) {
        const int begin = (row * kCellSize + rect.x0) * kSamples, end = (row * kCellSize + rect.x1 + 1) * kSamples;
        for (int first = begin / kWidth * kWidth; first < end; first += kWidth)
            test<kMoves, kPerspective>(work, samples, T, terms, first, depths, bounds);
    }
}

}  // namespace

void draw_cell(const ShadowCellWork& work, float* depths, float* bounds) {
    std::fill_n(depths, ShadowSamples::kPerCell, INFINITY);
    std::fill_n(bounds, ShadowSamples::kPerCell, INFINITY);
    const bool perspective = work.casters.frame.view.perspective;
    for (const std::uint32_t i : work.list) {
        const Casters::Box& box = work.casters.boxes[i];
        const Rect rect = rect_of(work, box);
        if (rect.empty()) continue;
        const Sheared T = shear(work, box);
        if (T.moves)
            perspective ? draw_triangle<true, true>(work, T, rect, depths, bounds)
                        : draw_triangle<true, false>(work, T, rect, depths, bounds);
        else
            perspective ? draw_triangle<false, true>(work, T, rect, depths, bounds)
                        : draw_triangle<false, false>(work, T, rect, depths, bounds);
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace pentaprism
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include "base/cpu_dispatch.h"

namespace pentaprism {

ShadowSamples::ShadowSamples(std::uint32_t seed)
    : seed_(seed),
      table_(kSamples, seed, Lens{}, Grouping::kTime),
      cells_(std::make_unique<Cell[]>(kPeriod * kPeriod)) {
    std::vector<SampleVector> room;
    for (int cy = 0; cy < kPeriod; ++cy)
        for (int cx = 0; cx < kPeriod; ++cx) {
            Cell& cell = cells_[index_of(cx, cy)];
            const std::span<const SampleVector> vectors = table_.cell(cx, cy, room);
            for (int i = 0; i < kPerCell; ++i) {
                const int texel = i / kSamples, column = texel % kCellSize, row = texel / kCellSize;
                const int block = row / kBlockSize * kCellBlocks + column / kBlockSize;
                const int lane = row % kBlockSize * kBlockSize + column % kBlockSize;
                // Grouped by time, slots are by time.
                const SampleVector& vector = vectors[block * kSamples + i % kSamples];
                cell.x[i] = vector.x[lane], cell.y[i] = vector.y[lane], cell.t[i] = vector.t[lane];
            }
        }
}

// Each period is shifted, so that repetitions do not line up (SampleTable).
std::size_t ShadowSamples::index_of(int cx, int cy) const {
    const std::uint32_t hash =
        mix(mix(static_cast<std::uint32_t>(cx / kPeriod) + seed_) + static_cast<std::uint32_t>(cy / kPeriod));
    const std::uint32_t x = static_cast<std::uint32_t>(cx) + (hash & 0xff),
                        y = static_cast<std::uint32_t>(cy) + (hash >> 8 & 0xff);
    return y % kPeriod * kPeriod + x % kPeriod;
}

DrawShadowCell draw_shadow_cell() {
    PENTAPRISM_RETURN_FOR_CPU(draw_cell);
    return HWY_STATIC_DISPATCH(draw_cell);
}

}  // namespace pentaprism
#endif
