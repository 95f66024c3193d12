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
#include "shade/shadow_setup-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pentaprism {
namespace HWY_NAMESPACE {
namespace {

constexpr int kSamples = ShadowSamples::kSamples;

// One motion segment of a triangle, of those that were set up. Nothing is asked of its opacity unless it is mixed.
struct Triangle {
    const ShadowSetup& setup;
    int lane;
    float segments, segment;
    std::uint32_t number;
    bool mixed;
};

// Those of the hits that are opaque, as the camera's coverage stage decides it. `terms`: of the triangle, when asked.
Mask opaque(const ShadowCellWork& work, std::uint32_t triangle, std::optional<OpacityTerms>& terms, int first,
            const Vec e[3], Vec sum, Mask hit) {
    const Frame& frame = *work.casters.world->frame;
    if (!terms) terms = opacity_terms(frame, triangle);
    const TileWork tile_work{frame, work.samples.table(), {}, {}, Tile{}};
    return decide_opacity(F(), tile_work, triangle, *terms, e, sum, hit, [&](int lane) {
        const int index = first + lane, texel = index / kSamples;
        return SampleOfPixel{work.cx * kCellSize + texel % kCellSize, work.cy * kCellSize + texel / kCellSize,
                             index % kSamples};
    });
}

template <bool kMoves, bool kPerspective>
HWY_INLINE void test(const ShadowCellWork& work, const ShadowSamples::Cell& samples, const Triangle& T,
                     std::optional<OpacityTerms>& terms, int first, float* depths, float* bounds) {
    const F f;
    const ShadowSetup& S = T.setup;
    const int lane = T.lane;
    const Vec stored = hn::Load(f, depths + first);
    if (hn::AllTrue(f, hn::Le(stored, hn::Set(f, S.nearest[lane])))) return;
    const Vec hx = hn::Load(f, samples.x + first), hy = hn::Load(f, samples.y + first);
    Vec s = hn::Zero(f);
    if constexpr (kMoves)
        s = hn::Sub(hn::Mul(hn::Load(f, samples.t + first), hn::Set(f, T.segments)), hn::Set(f, T.segment));
    const auto at = [&](const float q[kLanes], const float change[kLanes]) HWY_ATTR {
        if constexpr (kMoves) return hn::Add(hn::Set(f, q[lane]), hn::Mul(s, hn::Set(f, change[lane])));
        (void)change;
        return hn::Set(f, q[lane]);
    };
    Vec x[3], y[3], z[3];
    for (int k = 0; k < 3; ++k) {
        z[k] = at(S.z[k], S.dz[k]);
        const Vec w = kPerspective ? z[k] : hn::Set(f, 1.0f);
        x[k] = hn::Sub(at(S.x[k], S.dx[k]), hn::Mul(hx, w));
        y[k] = hn::Sub(at(S.y[k], S.dy[k]), hn::Mul(hy, w));
    }
    const Vec e[3] = {difference_of_products(x[1], y[2], x[2], y[1]), difference_of_products(x[2], y[0], x[0], y[2]),
                      difference_of_products(x[0], y[1], x[1], y[0])};
    const Vec zero = hn::Zero(f);
    const Mask front = hn::Ge(hn::Min(e[0], hn::Min(e[1], e[2])), zero);
    const Mask back = hn::Le(hn::Max(e[0], hn::Max(e[1], e[2])), zero);
    Mask hit = hn::Or(front, back);
    if (hn::AllFalse(f, hit)) return;
    const Vec sum = hn::Add(hn::Add(e[0], e[1]), e[2]);
    const Vec weighted = hn::Add(hn::Add(hn::Mul(e[0], z[0]), hn::Mul(e[1], z[1])), hn::Mul(e[2], z[2]));
    const Vec depth = hn::Div(weighted, sum);
    hit = hn::And(hit, hn::Lt(depth, stored));  // not for a depth that is no number: seen edge-on
    if constexpr (kPerspective) hit = hn::And(hit, hn::Ge(depth, hn::Set(f, kNearestToLight)));
    if constexpr (kMoves)
        if (T.segments > 1.0f) hit = hn::And(hit, hn::And(hn::Ge(s, zero), hn::Lt(s, hn::Set(f, 1.0f))));
    if (hn::AllFalse(f, hit)) return;
    if (T.mixed) hit = opaque(work, T.number, terms, first, e, sum, hit);
    hn::Store(hn::IfThenElse(hit, depth, stored), f, depths + first);
    const Vec farthest = hn::Max(hn::Max(z[0], z[1]), z[2]);
    const Vec bound = hn::Max(depth, hn::Min(hn::Add(depth, hn::Set(f, S.recedes[lane])), farthest));
    hn::Store(hn::IfThenElse(hit, bound, hn::Load(f, bounds + first)), f, bounds + first);
}

// Vectors of a small box are tested at once; in a larger one strips between parallels to the sides leave out what lies
// beside the triangle.
template <bool kMoves, bool kPerspective>
HWY_NOINLINE void draw_triangle(const ShadowCellWork& work, const Triangle& T, float* depths, float* bounds) {
    constexpr int kSmall = 8;
    const ShadowSamples::Cell& samples = work.samples.cell(work.cx, work.cy);
    const ShadowSetup& S = T.setup;
    std::optional<OpacityTerms> terms;
    const auto draw_row = [&](int row, int x0, int x1) HWY_ATTR {
        const int begin = (row * kCellSize + x0) * kSamples, end = (row * kCellSize + x1 + 1) * kSamples;
        for (int first = begin / kWidth * kWidth; first < end; first += kWidth)
            test<kMoves, kPerspective>(work, samples, T, terms, first, depths, bounds);
    };
    const int x0 = S.x0[T.lane], x1 = S.x1[T.lane], y0 = S.y0[T.lane], y1 = S.y1[T.lane];
    if ((x1 - x0 + kSamples) / kSamples * (y1 - y0 + 1) <= kSmall) {
        for (int row = y0; row <= y1; ++row) draw_row(row, x0, x1);
        return;
    }
    ShadowSpans spans;
    find_spans(S, T.lane, spans);
    for (int row = y0; row <= y1; ++row)
        if (spans.first[row] <= spans.last[row]) draw_row(row, spans.first[row], spans.last[row]);
}

}  // namespace

void draw_cell(const ShadowCellWork& work, float* depths, float* bounds) {
    std::fill_n(depths, ShadowSamples::kPerCell, INFINITY);
    std::fill_n(bounds, ShadowSamples::kPerCell, INFINITY);
    const WorldMotion& world = *work.casters.world;
    const bool perspective = work.casters.view.perspective;
    ShadowSetup setup;
    for (std::size_t begin = 0; begin < work.list.size(); begin += kLanes) {
        const int count = static_cast<int>(std::min<std::size_t>(kLanes, work.list.size() - begin));
        std::uint32_t list[kLanes];
        for (int lane = 0; lane < kLanes; ++lane) list[lane] = work.list[begin + std::min(lane, count - 1)];
        set_up(work, list, setup);
        for (int lane = 0; lane < count; ++lane) {
            const Casters::Boxes& boxes = work.casters.boxes[list[lane] / kLanes];
            const std::uint32_t at = list[lane] % kLanes, triangle = boxes.triangle(at);
            const Part& part = world.part_of(triangle);
            const Triangle T{setup,
                             lane,
                             static_cast<float>(part.segments),
                             static_cast<float>(boxes.segment[at]),
                             triangle,
                             boxes.is_mixed(at)};
            if (part.moves)
                perspective ? draw_triangle<true, true>(work, T, depths, bounds)
                            : draw_triangle<true, false>(work, T, depths, bounds);
            else
                perspective ? draw_triangle<false, true>(work, T, depths, bounds)
                            : draw_triangle<false, false>(work, T, depths, bounds);
        }
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
      cells_(std::make_unique<Cell[]>(kPeriod * kPeriod)),
      words_(kPeriod * kPeriod * kPerCell),
      times_(words_.size() + 3) {
    std::vector<SampleVector> room;
    // The part of [0, 1) in which `place` lies, and its middle.
    const auto move = [](float& place, int bits) {
        const auto parts = static_cast<float>(1 << bits);
        const float part = std::clamp(std::floor(place * parts), 0.0f, parts - 1.0f);
        place = (part + 0.5f) / parts;
        return static_cast<std::uint32_t>(part);
    };
    for (int cy = 0; cy < kPeriod; ++cy)
        for (int cx = 0; cx < kPeriod; ++cx) {
            const std::size_t index = index_of(cx, cy);
            Cell& cell = cells_[index];
            const std::span<const SampleVector> vectors = table_.cell(cx, cy, room);
            for (int i = 0; i < kPerCell; ++i) {
                const int texel = i / kSamples, column = texel % kCellSize, row = texel / kCellSize;
                const int block = row / kBlockSize * kCellBlocks + column / kBlockSize;
                const int lane = row % kBlockSize * kBlockSize + column % kBlockSize;
                // Grouped by time, slots are by time.
                const SampleVector& vector = vectors[block * kSamples + i % kSamples];
                const auto left = static_cast<float>(column - kCellSize / 2),
                           bottom = static_cast<float>(kCellSize / 2 - 1 - row),
                           quarter = static_cast<float>(i % kSamples);
                float x = vector.x[lane] - left, y = vector.y[lane] - bottom,
                      t = vector.t[lane] * static_cast<float>(kSamples) - quarter;
                const std::uint32_t time = move(t, kTimeBits);
                const std::uint32_t word =
                    move(x, kPlaceBits) | move(y, kPlaceBits) << kPlaceBits | time << 2 * kPlaceBits;
                words_[index * kPerCell + i] = static_cast<std::int32_t>(word);
                times_[index * kPerCell + i] = static_cast<std::uint8_t>(time);
                cell.x[i] = left + x, cell.y[i] = bottom + y;
                cell.t[i] = (quarter + t) / static_cast<float>(kSamples);
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
