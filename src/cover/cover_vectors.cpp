// The fast path of the coverage stage: sixteen samples at a time, the same decisions as cover/exact.cpp bit for bit.
//
// The tile's triangles are walked roughly front to back, so that what is hidden is refused early; equal depths go to
// the lower triangle whatever the order. For each triangle:
//   1. interval bounds of the triangle for each stratum of (u, v, t), strata in lanes
//   (docs/develop/algorithms.md 4.11), give
//      the 4x4-pixel blocks in which the stratum's samples can hit; triangles that reach the camera plane take the
//      improved dual-space test on each block instead;
//   2. (block, slot) pairs that survive, and whose farthest depth so far is beyond the triangle, form a work list;
//   3. a pass over the list does the edge functions and keeps the vectors that hit something, without branching on it;
//   4. a pass over those does depth, opacity and writes.
// This file is compiled once for each CPU target; it holds the kernels and nothing else.

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "cover/cover_vectors.cpp"
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4)
#include <hwy/foreach_target.h>
// foreach_target.h must come first.
#include <algorithm>
#include <bit>
#include <cmath>
#include <hwy/highway.h>

#include "base/cpu.h"
#include "cover/cover.h"
#include "cover/exact.h"
#include "frame/opacity.h"

HWY_BEFORE_NAMESPACE();
namespace pentaprism {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using F = hn::CappedTag<float, kLanes>;
using Vec = hn::Vec<F>;
using Mask = hn::Mask<F>;
using I = hn::RebindToSigned<F>;
using U = hn::RebindToUnsigned<F>;
constexpr float kUnitRoundoff = 1.0f / 16777216.0f;
// Edges are asked for triangles of this many pixels and bins of this many blocks: measured
// (docs/develop/performance.md).
constexpr float kLargeTriangle = 12.0f;
constexpr int kWorthRefining = 6;

// One vector of samples: its place in SampleTable::cell() and in Hits.
using Job = std::uint32_t;

// The tile's state that lives longer than a triangle.
struct TileState {
    TileState(const TileWork& w, Hits& h, CoverCounts& c)
        : work(w), hits(h), counts(c), centre(cell_centre(w.frame.view, w.tile.cell_x(), w.tile.cell_y())) {}

    const TileWork& work;
    Hits& hits;
    CoverCounts& counts;
    CellCentre centre;
    std::span<const SampleTable::Stratum> strata;
    std::span<const Domain> domains;
    std::uint64_t tile_blocks = 0;          // blocks of the cell that belong to the tile
    const SampleVector* samples = nullptr;  // of the cell, by job
    std::vector<float> farthest;            // by job: largest depth stored so far
    std::vector<Job> jobs, survivors;
    float tile_farthest = INFINITY;  // no smaller than any of `farthest`
    // Domains of the strata, structure of arrays, padded to whole vectors with empty ones.
    HWY_ALIGN float u0[64], u1[64], v0[64], v1[64], t0[64], t1[64];
    int stratum_count = 0;
};

// Where the three vertices are seen from sixteen samples (docs/develop/algorithms.md 1.5).
struct Deltas {
    Vec x[3], y[3], w[3], z[3];
    Vec tau;
};

// What of the general test a triangle needs. Adding u*0 or t*0 is exact: the shorter kernels give the same bits.
template <bool kMotionT, bool kDefocusT, bool kTwoSidedT>
struct Kind {
    static constexpr bool kMotion = kMotionT, kDefocus = kDefocusT, kTwoSided = kTwoSidedT;
};

template <class K>
HWY_INLINE Deltas deltas(F f, const LocalTriangle& T, const SampleVector& s, int lane) {
    Deltas D;
    const Vec hx = hn::Load(f, s.x + lane), hy = hn::Load(f, s.y + lane);
    Vec tau = hn::Zero(f);
    if constexpr (K::kMotion) tau = hn::MulAdd(hn::Load(f, s.t + lane), hn::Set(f, T.segments), hn::Set(f, -T.segment));
    D.tau = tau;
    for (int i = 0; i < 3; ++i) {
        Vec x = hn::Set(f, T.qx[i]), y = hn::Set(f, T.qy[i]), w = hn::Set(f, T.qw[i]), c = hn::Set(f, T.qc[i]);
        if constexpr (K::kMotion) {
            x = hn::MulAdd(tau, hn::Set(f, T.dx[i]), x);
            y = hn::MulAdd(tau, hn::Set(f, T.dy[i]), y);
            w = hn::MulAdd(tau, hn::Set(f, T.dw[i]), w);
            if constexpr (K::kDefocus) c = hn::MulAdd(tau, hn::Set(f, T.dc[i]), c);
        }
        if constexpr (K::kDefocus) {
            x = hn::MulAdd(hn::Load(f, s.u + lane), c, x);
            y = hn::MulAdd(hn::Load(f, s.v + lane), c, y);
        }
        D.x[i] = hn::NegMulAdd(hx, w, x);
        D.y[i] = hn::NegMulAdd(hy, w, y);
        D.w[i] = w;
        D.z[i] = T.orthographic ? hn::MulAdd(tau, hn::Set(f, T.dz[i]), hn::Set(f, T.qz[i])) : w;
    }
    return D;
}

HWY_INLINE Vec edge(const Deltas& D, int i, int j) {
    return hn::Sub(hn::Mul(D.x[i], D.y[j]), hn::Mul(D.x[j], D.y[i]));
}

struct Edges {
    Vec e[3];
};
HWY_INLINE Edges edges(const Deltas& D) {
    return {{edge(D, 1, 2), edge(D, 2, 0), edge(D, 0, 1)}};
}

// Samples of other segments of the same path belong to those.
template <class K>
HWY_INLINE Mask in_segment(F f, const Deltas& D, Mask mask) {
    if constexpr (!K::kMotion) return mask;
    return hn::And(mask, hn::And(hn::Ge(D.tau, hn::Zero(f)), hn::Lt(D.tau, hn::Set(f, 1.0f))));
}

// Lanes that are not outside any edge: all that can be hit, and those with a sample exactly on an edge.
template <class K>
HWY_INLINE Mask not_outside(F f, const Edges& E) {
    const Vec zero = hn::Zero(f);
    const Mask front = hn::Ge(hn::Min(hn::Min(E.e[0], E.e[1]), E.e[2]), zero);
    if constexpr (!K::kTwoSided) return front;
    return hn::Or(front, hn::Le(hn::Max(hn::Max(E.e[0], E.e[1]), E.e[2]), zero));
}

// Of them the lanes that are inside for certain; the scalar test decides the others.
template <class K>
HWY_INLINE Mask strictly_inside(F f, const Edges& E) {
    const Vec zero = hn::Zero(f);
    const Mask front = hn::Gt(hn::Min(hn::Min(E.e[0], E.e[1]), E.e[2]), zero);
    if constexpr (!K::kTwoSided) return front;
    return hn::Or(front, hn::Lt(hn::Max(hn::Max(E.e[0], E.e[1]), E.e[2]), zero));
}

HWY_INLINE float block_x(int block) {
    return static_cast<float>(block % kCellBlocks * kBlockSize - kCellSize / 2);
}
HWY_INLINE float block_y(int block) {
    return static_cast<float>(kCellSize / 2 - block / kCellBlocks * kBlockSize);
}

// Pass 1: which vectors of the work list have a sample inside all edges.
template <class K>
std::size_t find_survivors(TileState& state, const LocalTriangle& T, std::size_t job_count) {
    const F f;
    Job* HWY_RESTRICT survivors = state.survivors.data();
    std::size_t count = 0;
    for (std::size_t j = 0; j < job_count; ++j) {
        const Job job = state.jobs[j];
        const SampleVector& s = state.samples[job];
        bool any = false;
        for (int lane = 0; lane < kLanes; lane += static_cast<int>(hn::Lanes(f))) {
            const Deltas D = deltas<K>(f, T, s, lane);
            any |= !hn::AllFalse(f, in_segment<K>(f, D, not_outside<K>(f, edges(D))));
        }
        survivors[count] = job;
        count += any;
    }
    return count;
}

HWY_INLINE Mask straddles_zero(F f, const Vec v[3]) {
    const Vec zero = hn::Zero(f);
    return hn::And(hn::Le(hn::Min(hn::Min(v[0], v[1]), v[2]), zero), hn::Ge(hn::Max(hn::Max(v[0], v[1]), v[2]), zero));
}

// What the scalar test says of the lanes in `tied`; returns those it accepts, with their depth.
HWY_NOINLINE Mask decide_ties(F f, const TileState& state, const LocalTriangle& T, const SampleVector& s, int lane,
                              Mask tied, Vec& depth) {
    HWY_ALIGN std::int32_t ask[kLanes];
    HWY_ALIGN float depths[kLanes];
    const I i;
    hn::Store(hn::VecFromMask(i, hn::RebindMask(i, tied)), i, ask);
    hn::Store(depth, f, depths);
    for (std::size_t k = 0; k < hn::Lanes(f); ++k) {
        if (ask[k] == 0) continue;
        const LocalSample sample{s.x[lane + k], s.y[lane + k], s.u[lane + k], s.v[lane + k], s.t[lane + k]};
        const SampleHit hit = cover_sample(T, sample, state.centre);
        ask[k] = hit.hit ? -1 : 0;
        if (hit.hit) depths[k] = hit.depth;
    }
    depth = hn::Load(f, depths);
    return hn::RebindMask(f, hn::Lt(hn::Load(i, ask), hn::Zero(i)));
}

// The lanes whose surface is really there: alpha masks and stochastic transparency.
HWY_NOINLINE Mask decide_opacity(F f, const TileState& state, const LocalTriangle& T, const Edges& E, Vec sum, int lane,
                                 Job job, Mask hit) {
    HWY_ALIGN std::int32_t ask[kLanes];
    HWY_ALIGN float b[3][kLanes];
    const I i;
    hn::Store(hn::VecFromMask(i, hn::RebindMask(i, hit)), i, ask);
    for (int k = 0; k < 3; ++k) hn::Store(hn::Div(E.e[k], sum), f, b[k]);
    const Tile& tile = state.work.tile;
    const int slots = state.work.samples.slots(), block = static_cast<int>(job) / slots,
              slot = static_cast<int>(job) % slots;
    const int bx = tile.cell_x() * kCellBlocks + block % kCellBlocks,
              by = tile.cell_y() * kCellBlocks + block / kCellBlocks;
    const auto indices = state.work.samples.indices(bx, by);
    for (int k = 0; k < static_cast<int>(hn::Lanes(f)); ++k) {
        if (ask[k] == 0) continue;
        const float barycentrics[3] = {b[0][k], b[1][k], b[2][k]};
        const int px = bx * kBlockSize + (lane + k) % kBlockSize, py = by * kBlockSize + (lane + k) / kBlockSize;
        if (!is_opaque_at(state.work.frame, T.triangle, barycentrics, px, py, indices[slot * kLanes + lane + k],
                          state.work.samples.spp()))
            ask[k] = 0;
    }
    return hn::RebindMask(f, hn::Lt(hn::Load(i, ask), hn::Zero(i)));
}

// Lanes within the screen bounds of a triangle that reaches the camera plane.
HWY_INLINE Mask in_box(F f, const TileState& state, const LocalTriangle& T, const SampleVector& s, int lane) {
    const Vec gx = hn::Add(hn::Set(f, state.centre.x), hn::Load(f, s.x + lane));
    const Vec gy = hn::Add(hn::Set(f, state.centre.y), hn::Load(f, s.y + lane));
    return hn::And(hn::And(hn::Ge(gx, hn::Set(f, T.box[0])), hn::Le(gx, hn::Set(f, T.box[1]))),
                   hn::And(hn::Ge(gy, hn::Set(f, T.box[2])), hn::Le(gy, hn::Set(f, T.box[3]))));
}

// Pass 2: depth, opacity and writes of the vectors that hit.
template <class K>
void write_hits(TileState& state, const LocalTriangle& T, std::size_t count) {
    const F f;
    const U u;
    const Vec zero = hn::Zero(f);
    std::int64_t covered = 0;
    for (std::size_t j = 0; j < count; ++j) {
        const Job job = state.survivors[j];
        const SampleVector& s = state.samples[job];
        float* depths = &state.hits.depth[std::size_t{job} * kLanes];
        std::uint32_t* triangles = &state.hits.triangle[std::size_t{job} * kLanes];
        Vec farthest = zero;
        for (int lane = 0; lane < kLanes; lane += static_cast<int>(hn::Lanes(f))) {
            const Deltas D = deltas<K>(f, T, s, lane);
            const Edges E = edges(D);
            const Mask candidates = in_segment<K>(f, D, not_outside<K>(f, E)), inside = strictly_inside<K>(f, E);
            Mask hit = hn::And(hn::And(candidates, inside), hn::And(straddles_zero(f, D.x), straddles_zero(f, D.y)));
            if (T.behind) hit = hn::And(hit, in_box(f, state, T, s, lane));
            const Vec sum = hn::Add(hn::Add(E.e[0], E.e[1]), E.e[2]);
            Vec depth = hn::Add(hn::Add(hn::Mul(E.e[0], D.z[0]), hn::Mul(E.e[1], D.z[1])), hn::Mul(E.e[2], D.z[2]));
            depth = hn::Div(depth, sum);
            depth = hn::Min(hn::Max(depth, hn::Min(hn::Min(D.z[0], D.z[1]), D.z[2])),
                            hn::Max(hn::Max(D.z[0], D.z[1]), D.z[2]));
            hit = hn::And(hit, hn::And(hn::Ne(sum, zero), hn::And(hn::Ge(depth, hn::Set(f, T.z_near)),
                                                                  hn::Le(depth, hn::Set(f, T.z_far)))));
            const Mask tied = hn::AndNot(inside, candidates);
            if (HWY_UNLIKELY(!hn::AllFalse(f, tied))) hit = hn::Or(hit, decide_ties(f, state, T, s, lane, tied, depth));
            covered += static_cast<std::int64_t>(hn::CountTrue(f, hit));
            // Hits are ordinary vectors: not aligned.
            const Vec stored = hn::LoadU(f, depths + lane);
            const auto stored_triangle = hn::LoadU(u, triangles + lane), triangle = hn::Set(u, T.triangle);
            const Mask lower = hn::RebindMask(f, hn::Lt(hn::BitCast(I(), triangle), hn::BitCast(I(), stored_triangle)));
            hit = hn::And(hit, hn::Or(hn::Lt(depth, stored), hn::And(hn::Eq(depth, stored), lower)));
            if (T.alpha_tested && !hn::AllFalse(f, hit)) hit = decide_opacity(f, state, T, E, sum, lane, job, hit);
            const Vec nearest = hn::IfThenElse(hit, depth, stored);
            hn::StoreU(nearest, f, depths + lane);
            hn::StoreU(hn::IfThenElse(hn::RebindMask(u, hit), triangle, stored_triangle), u, triangles + lane);
            farthest = hn::Max(farthest, nearest);
        }
        state.farthest[job] = hn::GetLane(hn::MaxOfLanes(f, farthest));
    }
    state.counts.covered += covered;
}

template <class K>
void cover_jobs(TileState& state, const LocalTriangle& T, std::size_t jobs) {
    const std::size_t survivors = find_survivors<K>(state, T, jobs);
    write_hits<K>(state, T, survivors);
}

// Bits of the columns and rows of blocks that the ranges touch; ranges in block units, already clamped to 0..7.
HWY_INLINE std::uint64_t block_mask(int column0, int column1, int row0, int row1) {
    const std::uint64_t columns = (0xffull >> (7 - column1)) & (0xffull << column0);
    const std::uint64_t rows = (~0ull >> (8 * (7 - row1))) & (~0ull << (8 * row0));
    return columns * 0x0101010101010101ull & rows;
}

// The triangle's six points (three vertices at both ends of a stratum's part of the shutter) on the screen, strata in
// lanes: all that a stratum's samples see lies in the hull of these, each moved by k * (u, v) with (u, v) in the
// stratum.
struct StrataPoints {
    Vec x[6], y[6], k[6];
    Vec outside;  // all ones: the stratum has no time in this segment
};

HWY_INLINE StrataPoints strata_points(F f, const TileState& state, const LocalTriangle& T, int first) {
    StrataPoints P;
    const Vec segments = hn::Set(f, T.segments), segment = hn::Set(f, -T.segment);
    const Vec tau0 = hn::Max(hn::MulAdd(hn::Load(f, state.t0 + first), segments, segment), hn::Zero(f));
    const Vec tau1 = hn::Min(hn::MulAdd(hn::Load(f, state.t1 + first), segments, segment), hn::Set(f, 1.0f));
    P.outside = hn::VecFromMask(f, hn::Gt(tau0, tau1));
    for (int i = 0; i < 6; ++i) {
        const int v = i / 2;
        const Vec tau = i % 2 == 0 ? tau0 : tau1;
        const Vec inverse = hn::Div(hn::Set(f, 1.0f), hn::MulAdd(tau, hn::Set(f, T.dw[v]), hn::Set(f, T.qw[v])));
        P.x[i] = hn::Mul(hn::MulAdd(tau, hn::Set(f, T.dx[v]), hn::Set(f, T.qx[v])), inverse);
        P.y[i] = hn::Mul(hn::MulAdd(tau, hn::Set(f, T.dy[v]), hn::Set(f, T.qy[v])), inverse);
        P.k[i] = hn::Mul(hn::MulAdd(tau, hn::Set(f, T.dc[v]), hn::Set(f, T.qc[v])), inverse);
    }
    return P;
}

// How far off the numbers above and what follows from them may be, in pixels on the screen.
struct Slack {
    float x, y;
};
Slack rounding_slack(const LocalTriangle& T, float ratio) {
    float scale_x = 0, scale_y = 0, least_w = INFINITY;
    for (int k = 0; k < 3; ++k)
        for (int end = 0; end < 2; ++end) {
            const float e = static_cast<float>(end), w = T.qw[k] + e * T.dw[k], c = std::abs(T.qc[k] + e * T.dc[k]);
            scale_x = std::max(scale_x, std::abs(T.qx[k] + e * T.dx[k]) + c + 17.0f * w);
            scale_y = std::max(scale_y, std::abs(T.qy[k] + e * T.dy[k]) + ratio * c + 17.0f * w);
            least_w = std::min(least_w, w);
        }
    return {40.0f * kUnitRoundoff * scale_x / least_w, 40.0f * kUnitRoundoff * scale_y / least_w};
}

// Step 1, triangle in front of the camera: for each stratum the blocks in which its samples can hit. Interval bounds:
// with all w > 0, (x + u*c) / w over the stratum is extreme at an end of t and of u, at a vertex.
HWY_NOINLINE void stratum_blocks(const TileState& state, const LocalTriangle& T, const Slack& slack,
                                 std::uint64_t* masks) {
    const F f;
    const I i;
    const Vec slack_x = hn::Set(f, slack.x), slack_y = hn::Set(f, slack.y);
    const Vec half = hn::Set(f, kCellSize / 2), to_blocks = hn::Set(f, 1.0f / kBlockSize);
    HWY_ALIGN std::int32_t column0[64], column1[64], row0[64], row1[64];
    for (int first = 0; first < state.stratum_count; first += static_cast<int>(hn::Lanes(f))) {
        const StrataPoints P = strata_points(f, state, T, first);
        const Vec u0 = hn::Load(f, state.u0 + first), u1 = hn::Load(f, state.u1 + first);
        const Vec v0 = hn::Load(f, state.v0 + first), v1 = hn::Load(f, state.v1 + first);
        Vec x0 = hn::Set(f, INFINITY), x1 = hn::Set(f, -INFINITY), y0 = x0, y1 = x1;
        for (int p = 0; p < 6; ++p) {
            const Vec xa = hn::MulAdd(u0, P.k[p], P.x[p]), xb = hn::MulAdd(u1, P.k[p], P.x[p]);
            const Vec ya = hn::MulAdd(v0, P.k[p], P.y[p]), yb = hn::MulAdd(v1, P.k[p], P.y[p]);
            x0 = hn::Min(x0, hn::Min(xa, xb));
            x1 = hn::Max(x1, hn::Max(xa, xb));
            y0 = hn::Min(y0, hn::Min(ya, yb));
            y1 = hn::Max(y1, hn::Max(ya, yb));
        }
        x0 = hn::Sub(x0, slack_x);
        x1 = hn::Add(x1, slack_x);
        y0 = hn::Sub(y0, slack_y);
        y1 = hn::Add(y1, slack_y);
        // Reject before clamping: a clamped bound would keep or lose the cell's last half pixel.
        const Mask outside =
            hn::Or(hn::Or(hn::Gt(x0, half), hn::Lt(x1, hn::Neg(half))),
                   hn::Or(hn::Or(hn::Gt(y0, half), hn::Lt(y1, hn::Neg(half))), hn::MaskFromVec(P.outside)));
        const Vec zero = hn::Zero(f), seven = hn::Set(f, kCellBlocks - 1);
        auto store = [&](Vec v, std::int32_t* out) HWY_ATTR {
            hn::Store(hn::ConvertTo(i, hn::Min(hn::Max(hn::Mul(v, to_blocks), zero), seven)), i, out + first);
        };
        store(hn::Add(x0, half), column0);
        store(hn::Add(x1, half), column1);
        store(hn::Sub(half, y1), row0);
        store(hn::Sub(half, y0), row1);
        // An outside stratum has no rows: row0 = 8.
        const auto out = hn::RebindMask(i, outside);
        hn::Store(hn::IfThenElse(out, hn::Set(i, kCellBlocks), hn::Load(i, row0 + first)), i, row0 + first);
    }
    for (int s = 0; s < state.stratum_count; ++s)
        masks[s] = row0[s] == kCellBlocks ? 0 : block_mask(column0[s], column1[s], row0[s], row1[s]);
}

// A direction across the screen, outward over one edge of the triangle.
struct Direction {
    float x, y;
};

// Smaller side of the triangle's bounding box at mid-segment through the middle of the lens, pixels.
float smaller_side(const LocalTriangle& T) {
    float x0 = INFINITY, x1 = -INFINITY, y0 = INFINITY, y1 = -INFINITY;
    for (int i = 0; i < 3; ++i) {
        const float inverse = 1.0f / (T.qw[i] + 0.5f * T.dw[i]);
        const float x = (T.qx[i] + 0.5f * T.dx[i]) * inverse, y = (T.qy[i] + 0.5f * T.dy[i]) * inverse;
        x0 = std::min(x0, x), x1 = std::max(x1, x), y0 = std::min(y0, y), y1 = std::max(y1, y);
    }
    return std::min(x1 - x0, y1 - y0);
}

// Unit normals of the edges at mid-segment through the middle of the lens: where the triangle's image is narrow. Any
// directions are safe below, these are useful.
void edge_normals(const LocalTriangle& T, Direction out[3]) {
    float x[3], y[3];
    for (int i = 0; i < 3; ++i) {
        const float inverse = 1.0f / (T.qw[i] + 0.5f * T.dw[i]);
        x[i] = (T.qx[i] + 0.5f * T.dx[i]) * inverse;
        y[i] = (T.qy[i] + 0.5f * T.dy[i]) * inverse;
    }
    const float area = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
    for (int k = 0; k < 3; ++k) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        const float dx = y[j] - y[i], dy = x[i] - x[j], length = std::sqrt(dx * dx + dy * dy);
        const float scale = length > 0 ? (area < 0 ? -1.0f : 1.0f) / length : 0.0f;
        out[k] = {dx * scale, dy * scale};
    }
}

// Step 1 for triangles that many vectors would be tested against: blocks beyond an edge, over all of a stratum, are
// refused. For an outward normal N, no sample of the stratum hits a point with N.g > h = max over the six points of N.p
// + k * N.(u,v) (docs/develop/algorithms.md 3.5). In each row of blocks that leaves a run of columns.
HWY_NOINLINE void refine_by_edges(const TileState& state, const LocalTriangle& T, const Slack& slack, int row0,
                                  int row1, std::uint64_t* masks) {
    const F f;
    const I i;
    Direction normals[3];
    edge_normals(T, normals);
    constexpr float kSteep = 0.05f;  // an edge as good as level bounds no columns
    HWY_ALIGN std::int32_t upper[kLanes], lower[kLanes];
    for (int first = 0; first < state.stratum_count; first += static_cast<int>(hn::Lanes(f))) {
        const StrataPoints P = strata_points(f, state, T, first);
        const Vec u0 = hn::Load(f, state.u0 + first), u1 = hn::Load(f, state.u1 + first);
        const Vec v0 = hn::Load(f, state.v0 + first), v1 = hn::Load(f, state.v1 + first);
        Vec start[3];   // column bound in row 0, in blocks
        float step[3];  // and how it changes from row to row
        for (int e = 0; e < 3; ++e) {
            const Direction N = normals[e];
            if (std::abs(N.x) < kSteep) continue;
            const Vec nx = hn::Set(f, N.x), ny = hn::Set(f, N.y);
            const Vec a = hn::Mul(nx, u0), b = hn::Mul(nx, u1), c = hn::Mul(ny, v0), d = hn::Mul(ny, v1);
            const Vec most = hn::Add(hn::Max(a, b), hn::Max(c, d)), least = hn::Add(hn::Min(a, b), hn::Min(c, d));
            Vec h = hn::Set(f, -INFINITY);
            for (int p = 0; p < 6; ++p) {
                const Vec lens = hn::Max(hn::Mul(P.k[p], most), hn::Mul(P.k[p], least));
                h = hn::Max(h, hn::Add(hn::MulAdd(nx, P.x[p], hn::Mul(ny, P.y[p])), lens));
            }
            h = hn::Add(h, hn::Set(f, std::abs(N.x) * slack.x + std::abs(N.y) * slack.y));
            // The corner of the block that lies deepest inside, in row 0: N.x * x + N.y * y <= h for x = 4 * column -
            // 16 (or
            // - 12) and y = 12 (or 16) - 4 * row.
            const float corner_x = N.x > 0 ? -16.0f : -12.0f, corner_y = N.y > 0 ? 12.0f : 16.0f;
            const float inverse = 1.0f / (kBlockSize * N.x);
            const float rounding = N.x > 0 ? 1e-4f : -1e-4f;
            start[e] =
                hn::MulAdd(h, hn::Set(f, inverse), hn::Set(f, -(N.x * corner_x + N.y * corner_y) * inverse + rounding));
            step[e] = N.y / N.x;
        }
        auto low = hn::Zero(i), high = hn::Zero(i);  // rows 0..3 and 4..7, eight bits each
        for (int row = row0; row <= row1; ++row) {
            Vec last = hn::Set(f, kCellBlocks - 1), begin = hn::Zero(f);
            const Vec r = hn::Set(f, static_cast<float>(row));
            for (int e = 0; e < 3; ++e) {
                if (std::abs(normals[e].x) < kSteep) continue;
                const Vec bound = hn::MulAdd(r, hn::Set(f, step[e]), start[e]);
                if (normals[e].x > 0)
                    last = hn::Min(last, bound);
                else
                    begin = hn::Max(begin, bound);
            }
            // Bits begin..last; rounding towards zero of a negative `last` only keeps a block too many.
            const auto from = hn::ConvertTo(i, hn::Min(hn::Ceil(begin), hn::Set(f, kCellBlocks)));
            const auto to = hn::ConvertTo(i, hn::Max(last, hn::Set(f, -1.0f)));
            auto bits = hn::Sub(hn::Shl(hn::Set(i, 2), hn::Max(to, hn::Zero(i))), hn::Shl(hn::Set(i, 1), from));
            bits = hn::And(hn::Max(bits, hn::Zero(i)), hn::Set(i, 0xff));
            const auto shifted = hn::Shl(bits, hn::Set(i, 8 * (row % 4)));
            if (row < 4)
                low = hn::Or(low, shifted);
            else
                high = hn::Or(high, shifted);
        }
        hn::Store(low, i, lower);
        hn::Store(high, i, upper);
        const int n = std::min(static_cast<int>(hn::Lanes(f)), state.stratum_count - first);
        for (int k = 0; k < n; ++k)
            masks[first + k] &=
                static_cast<std::uint32_t>(lower[k]) | std::uint64_t{static_cast<std::uint32_t>(upper[k])} << 32;
    }
}

// Step 1, triangle at the camera plane: intervals are invalid there, so each block asks the improved dual-space test.
std::uint64_t blocks_at_camera_plane(const LocalTriangle& T, const CullTest& test, float ratio,
                                     std::uint64_t candidates) {
    CullState scratch;
    std::uint64_t kept = 0;
    for (std::uint64_t m = candidates; m != 0; m &= m - 1) {
        const int block = std::countr_zero(m);
        const float x = block_x(block), y = block_y(block);
        const Footprint footprint{x, x + kBlockSize, y - kBlockSize, y, {-1.0f, 1.0f, -ratio, ratio, 0.0f, 1.0f}};
        if (test.prepare(T, footprint, scratch)) kept |= m & -m;
    }
    return kept;
}

// Step 2: the (block, slot) pairs that may hit and are not hidden. How many bits a mask has is unpredictable, so bits
// are written out eight at a time, wanted or not; what is hidden is dropped in a second pass without branches.
HWY_NOINLINE std::size_t list_jobs(TileState& state, const std::uint64_t* masks, std::uint64_t blocks, float nearest) {
    const Job slots = static_cast<Job>(state.work.samples.slots());
    Job* HWY_RESTRICT jobs = state.jobs.data();
    std::size_t listed = 0;
    for (const SampleTable::Stratum& s : state.strata) {
        std::uint64_t m = masks[s.stratum] & s.blocks & blocks;
        if (m == 0) continue;
        const std::size_t end = listed + static_cast<std::size_t>(std::popcount(m));
        do {
            for (int k = 0; k < 8; ++k, m &= m - 1)
                jobs[listed + k] = static_cast<Job>(std::countr_zero(m)) * slots + s.slot;
            listed += 8;
        } while (m != 0);
        listed = end;
    }
    const float* HWY_RESTRICT farthest = state.farthest.data();
    std::size_t count = 0;
    for (std::size_t j = 0; j < listed; ++j) {
        const Job job = jobs[j];
        jobs[count] = job;
        count += nearest <= farthest[job];
    }
    return count;
}

// Blocks of the cell that the pixel rectangle touches.
std::uint64_t blocks_of(const BinnedTriangle& binned, const Tile& tile) {
    const int left = tile.cell_x() * kCellSize, top = tile.cell_y() * kCellSize;
    const int x0 = std::max<int>(binned.x0, tile.x0) - left, x1 = std::min<int>(binned.x1, tile.x1) - left - 1;
    const int y0 = std::max<int>(binned.y0, tile.y0) - top, y1 = std::min<int>(binned.y1, tile.y1) - top - 1;
    return block_mask(x0 / kBlockSize, x1 / kBlockSize, y0 / kBlockSize, y1 / kBlockSize);
}

void cover_triangle(TileState& state, const BinnedTriangle& binned, float nearest, const CullTest& camera_plane_test) {
    const LocalTriangle T = localize(state.work.frame, binned.triangle, binned.segment, state.centre);
    std::uint64_t blocks = blocks_of(binned, state.work.tile) & state.tile_blocks;
    std::uint64_t masks[64];
    if (T.behind) {
        blocks =
            blocks_at_camera_plane(T, camera_plane_test, static_cast<float>(state.work.frame.view.lens.ratio), blocks);
        std::fill(masks, masks + state.stratum_count, ~0ull);
    } else {
        const Slack slack = rounding_slack(T, static_cast<float>(state.work.frame.view.lens.ratio));
        stratum_blocks(state, T, slack, masks);
        // Many blocks in many strata: worth a closer look.
        if (std::popcount(blocks) >= kWorthRefining && smaller_side(T) > kLargeTriangle) {
            const int row0 = std::countr_zero(blocks) / kCellBlocks,
                      row1 = (63 - std::countl_zero(blocks)) / kCellBlocks;
            refine_by_edges(state, T, slack, row0, row1, masks);
        }
    }
    const std::size_t jobs = list_jobs(state, masks, blocks, nearest);
    state.counts.tested += static_cast<std::int64_t>(jobs) * kLanes;
    bool motion = T.segments > 1.0f, defocus = false;
    for (int k = 0; k < 3; ++k) {
        motion = motion || T.dx[k] != 0 || T.dy[k] != 0 || T.dw[k] != 0 || T.dc[k] != 0 || T.dz[k] != 0;
        defocus = defocus || T.qc[k] != 0 || T.dc[k] != 0;
    }
    using CoverJobs = void (*)(TileState&, const LocalTriangle&, std::size_t);
    constexpr CoverJobs kKinds[2][2][2] = {
        {{cover_jobs<Kind<false, false, false>>, cover_jobs<Kind<false, false, true>>},
         {cover_jobs<Kind<false, true, false>>, cover_jobs<Kind<false, true, true>>}},
        {{cover_jobs<Kind<true, false, false>>, cover_jobs<Kind<true, false, true>>},
         {cover_jobs<Kind<true, true, false>>, cover_jobs<Kind<true, true, true>>}}};
    kKinds[motion][defocus][T.two_sided](state, T, jobs);
}

// Farthest depth that any of the tile's samples still shows.
void update_tile_farthest(TileState& state) {
    float farthest = 0.0f;
    for (std::uint64_t m = state.tile_blocks; m != 0; m &= m - 1) {
        const std::size_t slots = static_cast<std::size_t>(state.work.samples.slots());
        const float* block = &state.farthest[std::countr_zero(m) * slots];
        farthest = std::max(farthest, *std::max_element(block, block + slots));
    }
    state.tile_farthest = farthest;
}

// The tile's triangles by their nearest w, and no sample sees one nearer than `nearest`.
struct Ordered {
    float nearest;
    std::uint32_t entry;
};
std::vector<Ordered> front_to_back(const TileWork& work) {
    // Rounding may put a hit a few ulps in front of the nearest vertex. An orthographic w says nothing about depth.
    const float margin = 1.0f - 16.0f * kUnitRoundoff;
    std::vector<Ordered> order;
    order.reserve(work.list.size());
    for (const std::uint32_t entry : work.list)
        order.push_back({work.frame.view.perspective ? work.triangles[entry].nearest_w * margin : -INFINITY, entry});
    std::sort(order.begin(), order.end(), [](const Ordered& a, const Ordered& b) {
        return a.nearest < b.nearest || (a.nearest == b.nearest && a.entry < b.entry);
    });
    return order;
}

void cover_front_to_back(TileState& state) {
    constexpr int kBetweenUpdates = 16;
    const CullTest& camera_plane_test = *find_cull_test("improved-dual-space");
    int until_update = kBetweenUpdates;
    for (const Ordered& next : front_to_back(state.work)) {
        if (next.nearest > state.tile_farthest) return;  // so are all that follow
        cover_triangle(state, state.work.triangles[next.entry], next.nearest, camera_plane_test);
        if (--until_update == 0) {
            update_tile_farthest(state);
            until_update = kBetweenUpdates;
        }
    }
}

}  // namespace

void cover_tile(const TileWork& work, Hits& hits, CoverCounts& counts) {
    TileState state(work, hits, counts);
    const int slots = work.samples.slots();
    const int left = work.tile.cell_x() * kCellSize, top = work.tile.cell_y() * kCellSize;
    state.strata = work.samples.strata(work.tile.cell_x(), work.tile.cell_y());
    std::vector<Domain> domains_of_cell;
    state.domains = work.samples.domains(work.tile.cell_x(), work.tile.cell_y(), domains_of_cell);
    state.stratum_count = static_cast<int>(state.domains.size());
    for (int s = 0; s < 64; ++s) {
        const Domain d = s < state.stratum_count ? state.domains[s] : Domain{0, 0, 0, 0, 2, -2};
        state.u0[s] = d.u0, state.u1[s] = d.u1, state.v0[s] = d.v0, state.v1[s] = d.v1, state.t0[s] = d.t0,
        state.t1[s] = d.t1;
    }
    state.tile_blocks = block_mask((work.tile.x0 - left) / kBlockSize, (work.tile.x1 - 1 - left) / kBlockSize,
                                   (work.tile.y0 - top) / kBlockSize, (work.tile.y1 - 1 - top) / kBlockSize);
    std::vector<SampleVector> vectors_of_cell;
    state.samples = work.samples.cell(work.tile.cell_x(), work.tile.cell_y(), vectors_of_cell).data();
    state.farthest.assign(static_cast<std::size_t>(kBlocksPerCell) * slots, INFINITY);
    state.jobs.resize(static_cast<std::size_t>(kBlocksPerCell) * slots + 8);  // list_jobs writes up to 7 beyond
    state.survivors.resize(state.jobs.size());

    // Pixels beyond the tile's border take no hits: nothing is nearer than -infinity.
    auto for_each_outside_lane = [&](auto&& visit) {
        for (int b = 0; b < kBlocksPerCell; ++b)
            for (int lane = 0; lane < kLanes; ++lane) {
                const int px = left + b % kCellBlocks * kBlockSize + lane % kBlockSize;
                const int py = top + b / kCellBlocks * kBlockSize + lane / kBlockSize;
                if (px < work.tile.x1 && py < work.tile.y1) continue;
                for (int slot = 0; slot < slots; ++slot)
                    visit((static_cast<std::size_t>(b) * slots + slot) * kLanes + lane);
            }
    };
    const bool cut = work.tile.x1 % kBlockSize != 0 || work.tile.y1 % kBlockSize != 0;
    if (cut) for_each_outside_lane([&](std::size_t s) { hits.depth[s] = -INFINITY; });
    cover_front_to_back(state);
    if (cut) for_each_outside_lane([&](std::size_t s) { hits.depth[s] = INFINITY; });
}

}  // namespace HWY_NAMESPACE
}  // namespace pentaprism
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pentaprism {

void cover_vectors(const TileWork& work, Hits& hits, CoverCounts& counts) {
    switch (cpu_isa()) {
#ifndef PENTAPRISM_SCALAR_ONLY
#if HWY_TARGETS & HWY_AVX3
        case Isa::kAvx512:
            return N_AVX3::cover_tile(work, hits, counts);
#endif
#if HWY_TARGETS & HWY_AVX2
        case Isa::kAvx2:
            return N_AVX2::cover_tile(work, hits, counts);
#endif
#if HWY_TARGETS & HWY_NEON
        case Isa::kNeon:
            return N_NEON::cover_tile(work, hits, counts);
#endif
#endif
        default:
            return cover_with_test(work, *find_cull_test("improved-dual-space"), hits, counts);
    }
}

}  // namespace pentaprism
#endif
