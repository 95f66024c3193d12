// Coverage for patterns in which samples share their lens position and time (sample/shared_triples.h): the accumulation
// buffer (Haeberli & Akeley 1990) and InterleaveUVT (Fatahalian et al. 2009). The same decisions as cover/exact.cpp,
// bit for bit, whatever the pattern.
//
// For one triple (u, v, t) a triangle stands still. So, for each triangle of the tile, roughly front to back:
//   1. triples in lanes: place its corners, box them on the screen, in blocks of K x K pixels;
//   2. each triple that has a box: the samples of that triple in the box, one vector of neighbouring blocks at a time,
//      take the rest of the exact test: 6 multiply-adds and the edge functions instead of 24 and these.
// The placed corners are the very numbers that the general test computes for each sample, so sharing them changes no
// bit. This file is compiled once for each CPU target.

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "cover/cover_shared.cpp"
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4)
#include <hwy/foreach_target.h>
// foreach_target.h must come first.
#include <algorithm>
#include <cmath>
#include <hwy/highway.h>

#include "cover/cover.h"
#include "cover/exact.h"
#include "cover/front_to_back.h"
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

// A range of blocks of the cell, both ends included.
struct BlockRange {
    int column0, column1, row0, row1;
};

// The tile's state that lives longer than a triangle.
struct TileState {
    TileState(const TileWork& w, CoverCounts& c)
        : work(w),
          counts(c),
          samples(w.samples.shared(w.tile.cell_x(), w.tile.cell_y())),
          centre(cell_centre(w.frame.view, w.tile.cell_x(), w.tile.cell_y())) {}

    const TileWork& work;
    CoverCounts& counts;
    SharedSamples samples;
    CellCentre centre;
    // Arranged as the samples. depth: -infinity where the sample lies outside the tile, so that nothing is nearer.
    AlignedVector<float> depth;
    AlignedVector<std::uint32_t> triangle;
    AlignedVector<float> u, v, t;  // of the triples, padded to whole vectors; t = 2: never in a segment
    float farthest = INFINITY;     // no smaller than any depth of the tile
};

// One triangle placed for as many triples as there are lanes.
struct Placed {
    HWY_ALIGN float x[3][kLanes], y[3][kLanes], w[3][kLanes], z[3][kLanes];
    HWY_ALIGN std::int32_t column0[kLanes], column1[kLanes], row0[kLanes], row1[kLanes];  // blocks; empty: 0 > -1
};

// Step 1. Where all w > 0, condition (N) says that a sample is hit only between the smallest and the largest x / w and
// y / w; the slack covers the rounding of these quotients, 3 u_f * 17, sixty times over. Where w changes sign, `limits`
// are the box; where no w is above 0 there is no depth in front of the camera.
HWY_NOINLINE bool place_triples(const TileState& state, const LocalTriangle& T, int first, const BlockRange& limits,
                                Placed& out) {
    const F f;
    const I i;
    const Vec zero = hn::Zero(f), one = hn::Set(f, 1.0f);
    const Vec u = hn::Load(f, &state.u[first]), v = hn::Load(f, &state.v[first]);
    const Vec tau = hn::MulAdd(hn::Load(f, &state.t[first]), hn::Set(f, T.segments), hn::Set(f, -T.segment));
    Mask seen = hn::And(hn::Ge(tau, zero), hn::Lt(tau, one));
    if (hn::AllFalse(f, seen)) return false;
    Vec x0 = hn::Set(f, INFINITY), x1 = hn::Set(f, -INFINITY), y0 = x0, y1 = x1, least_w = x0, most_w = x1;
    for (int k = 0; k < 3; ++k) {
        const Vec w = hn::MulAdd(tau, hn::Set(f, T.dw[k]), hn::Set(f, T.qw[k]));
        const Vec c = hn::MulAdd(tau, hn::Set(f, T.dc[k]), hn::Set(f, T.qc[k]));
        const Vec x = hn::MulAdd(u, c, hn::MulAdd(tau, hn::Set(f, T.dx[k]), hn::Set(f, T.qx[k])));
        const Vec y = hn::MulAdd(v, c, hn::MulAdd(tau, hn::Set(f, T.dy[k]), hn::Set(f, T.qy[k])));
        const Vec z = T.orthographic ? hn::MulAdd(tau, hn::Set(f, T.dz[k]), hn::Set(f, T.qz[k])) : w;
        hn::Store(x, f, out.x[k]);
        hn::Store(y, f, out.y[k]);
        hn::Store(w, f, out.w[k]);
        hn::Store(z, f, out.z[k]);
        const Vec gx = hn::Div(x, w), gy = hn::Div(y, w);
        x0 = hn::Min(x0, gx), x1 = hn::Max(x1, gx), y0 = hn::Min(y0, gy), y1 = hn::Max(y1, gy);
        least_w = hn::Min(least_w, w), most_w = hn::Max(most_w, w);
    }
    const Mask in_front = hn::Gt(least_w, zero);
    seen = hn::And(seen, hn::Gt(most_w, zero));
    const Vec half = hn::Set(f, kCellSize / 2), slack = hn::Set(f, 2e-4f);
    const Vec per_block = hn::Set(f, 1.0f / static_cast<float>(state.samples.block_side));
    // In blocks from the cell's corner; rounding down as samples' own positions do. Far bounds are cut before they
    // become integers, beyond the limits on either side.
    const auto block_of = [&](Vec position) HWY_ATTR {
        const Vec block = hn::Mul(position, per_block);
        return hn::ConvertTo(i, hn::Floor(hn::Min(hn::Max(block, hn::Set(f, -1.0f)), hn::Set(f, kCellSize + 1.0f))));
    };
    const auto in_front_i = hn::RebindMask(i, in_front), seen_i = hn::RebindMask(i, seen);
    const auto column0 = hn::Set(i, limits.column0), column1 = hn::Set(i, limits.column1);
    const auto row0 = hn::Set(i, limits.row0), row1 = hn::Set(i, limits.row1);
    const auto least = [&](Vec position, auto limit)
                           HWY_ATTR { return hn::IfThenElse(in_front_i, hn::Max(block_of(position), limit), limit); };
    const auto most = [&](Vec position, auto limit)
                          HWY_ATTR { return hn::IfThenElse(in_front_i, hn::Min(block_of(position), limit), limit); };
    hn::Store(least(hn::Add(hn::Sub(x0, slack), half), column0), i, out.column0);
    hn::Store(most(hn::Add(hn::Add(x1, slack), half), column1), i, out.column1);
    hn::Store(least(hn::Sub(half, hn::Add(y1, slack)), row0), i, out.row0);
    const auto last_row = most(hn::Sub(half, hn::Sub(y0, slack)), row1);
    hn::Store(hn::IfThenElse(seen_i, last_row, hn::Set(i, -1)), i, out.row1);
    return true;
}

struct Corners {
    Vec x[3], y[3], w[3], z[3];
};

HWY_INLINE Vec edge(const Vec x[3], const Vec y[3], int i, int j) {
    return hn::Sub(hn::Mul(x[i], y[j]), hn::Mul(x[j], y[i]));
}

HWY_INLINE Mask straddles_zero(F f, const Vec v[3]) {
    const Vec zero = hn::Zero(f);
    return hn::And(hn::Le(hn::Min(hn::Min(v[0], v[1]), v[2]), zero), hn::Ge(hn::Max(hn::Max(v[0], v[1]), v[2]), zero));
}

// What the scalar test says of the lanes in `tied`; returns those it accepts, with their depth.
HWY_NOINLINE Mask decide_ties(F f, const TileState& state, const LocalTriangle& T, int triple, std::size_t first,
                              Mask tied, Vec& depth) {
    HWY_ALIGN std::int32_t ask[kLanes];
    HWY_ALIGN float depths[kLanes];
    const I i;
    hn::Store(hn::VecFromMask(i, hn::RebindMask(i, tied)), i, ask);
    hn::Store(depth, f, depths);
    const SharedSamples::Triple& at = state.samples.triples[triple];
    for (std::size_t k = 0; k < hn::Lanes(f); ++k) {
        if (ask[k] == 0) continue;
        const SampleHit hit =
            cover_sample(T, {state.samples.x[first + k], state.samples.y[first + k], at.u, at.v, at.t}, state.centre);
        ask[k] = hit.hit ? -1 : 0;
        if (hit.hit) depths[k] = hit.depth;
    }
    depth = hn::Load(f, depths);
    return hn::RebindMask(f, hn::Lt(hn::Load(i, ask), hn::Zero(i)));
}

// The lanes whose surface is really there: alpha masks and stochastic transparency.
HWY_NOINLINE Mask decide_opacity(F f, const TileState& state, const LocalTriangle& T, const Vec e[3], Vec sum,
                                 std::size_t first, Mask hit) {
    HWY_ALIGN std::int32_t ask[kLanes];
    HWY_ALIGN float b[3][kLanes];
    const I i;
    hn::Store(hn::VecFromMask(i, hn::RebindMask(i, hit)), i, ask);
    for (int k = 0; k < 3; ++k) hn::Store(hn::Div(e[k], sum), f, b[k]);
    const Tile& tile = state.work.tile;
    const int spp = state.work.samples.spp();
    for (std::size_t k = 0; k < hn::Lanes(f); ++k) {
        if (ask[k] == 0) continue;
        const int place = static_cast<int>(state.samples.place[first + k]), lane = place % kLanes;
        const int index = place / kLanes % spp, block = place / kLanes / spp;
        const int px = tile.cell_x() * kCellSize + block % kCellBlocks * kBlockSize + lane % kBlockSize;
        const int py = tile.cell_y() * kCellSize + block / kCellBlocks * kBlockSize + lane / kBlockSize;
        const float barycentrics[3] = {b[0][k], b[1][k], b[2][k]};
        if (!is_opaque_at(state.work.frame, T.triangle, barycentrics, px, py, index, state.work.samples)) ask[k] = 0;
    }
    return hn::RebindMask(f, hn::Lt(hn::Load(i, ask), hn::Zero(i)));
}

// Step 2 for one vector of samples of a triple. Returns the number that the exact test accepts.
template <bool kTwoSided>
HWY_INLINE std::int64_t cover_vector(F f, TileState& state, const LocalTriangle& T, const Corners& C, int triple,
                                     std::size_t first) {
    const U u;
    const Vec zero = hn::Zero(f);
    const Vec hx = hn::Load(f, &state.samples.x[first]), hy = hn::Load(f, &state.samples.y[first]);
    Vec x[3], y[3];
    for (int k = 0; k < 3; ++k) {
        x[k] = hn::NegMulAdd(hx, C.w[k], C.x[k]);
        y[k] = hn::NegMulAdd(hy, C.w[k], C.y[k]);
    }
    const Vec e[3] = {edge(x, y, 1, 2), edge(x, y, 2, 0), edge(x, y, 0, 1)};
    const Vec least = hn::Min(hn::Min(e[0], e[1]), e[2]), most = hn::Max(hn::Max(e[0], e[1]), e[2]);
    Mask candidates = hn::Ge(least, zero), inside = hn::Gt(least, zero);
    if constexpr (kTwoSided) {
        candidates = hn::Or(candidates, hn::Le(most, zero));
        inside = hn::Or(inside, hn::Lt(most, zero));
    }
    // Samples outside the tile are other tiles' business.
    const Vec stored = hn::Load(f, &state.depth[first]);
    candidates = hn::And(candidates, hn::Gt(stored, hn::Set(f, -INFINITY)));
    if (hn::AllFalse(f, candidates)) return 0;

    Mask hit = hn::And(hn::And(candidates, inside), hn::And(straddles_zero(f, x), straddles_zero(f, y)));
    if (T.behind) {
        const Vec gx = hn::Add(hn::Set(f, state.centre.x), hx), gy = hn::Add(hn::Set(f, state.centre.y), hy);
        hit = hn::And(hit, hn::And(hn::And(hn::Ge(gx, hn::Set(f, T.box[0])), hn::Le(gx, hn::Set(f, T.box[1]))),
                                   hn::And(hn::Ge(gy, hn::Set(f, T.box[2])), hn::Le(gy, hn::Set(f, T.box[3])))));
    }
    const Vec sum = hn::Add(hn::Add(e[0], e[1]), e[2]);
    Vec depth = hn::Div(hn::Add(hn::Add(hn::Mul(e[0], C.z[0]), hn::Mul(e[1], C.z[1])), hn::Mul(e[2], C.z[2])), sum);
    depth = hn::Min(hn::Max(depth, hn::Min(hn::Min(C.z[0], C.z[1]), C.z[2])), hn::Max(hn::Max(C.z[0], C.z[1]), C.z[2]));
    hit = hn::And(hit, hn::And(hn::Ne(sum, zero),
                               hn::And(hn::Ge(depth, hn::Set(f, T.z_near)), hn::Le(depth, hn::Set(f, T.z_far)))));
    const Mask tied = hn::AndNot(inside, candidates);
    if (HWY_UNLIKELY(!hn::AllFalse(f, tied))) hit = hn::Or(hit, decide_ties(f, state, T, triple, first, tied, depth));
    const auto covered = static_cast<std::int64_t>(hn::CountTrue(f, hit));
    const auto stored_triangle = hn::Load(u, &state.triangle[first]), triangle = hn::Set(u, T.triangle);
    const Mask lower = hn::RebindMask(f, hn::Lt(hn::BitCast(I(), triangle), hn::BitCast(I(), stored_triangle)));
    hit = hn::And(hit, hn::Or(hn::Lt(depth, stored), hn::And(hn::Eq(depth, stored), lower)));
    if (T.alpha_tested && !hn::AllFalse(f, hit)) hit = decide_opacity(f, state, T, e, sum, first, hit);
    hn::Store(hn::IfThenElse(hit, depth, stored), f, &state.depth[first]);
    hn::Store(hn::IfThenElse(hn::RebindMask(u, hit), triangle, stored_triangle), u, &state.triangle[first]);
    return covered;
}

// The samples of one triple within its box.
template <bool kTwoSided>
void cover_triple(TileState& state, const LocalTriangle& T, const Placed& placed, int lane, int triple) {
    const F f;
    Corners C;
    for (int k = 0; k < 3; ++k) {
        C.x[k] = hn::Set(f, placed.x[k][lane]);
        C.y[k] = hn::Set(f, placed.y[k][lane]);
        C.w[k] = hn::Set(f, placed.w[k][lane]);
        C.z[k] = hn::Set(f, placed.z[k][lane]);
    }
    const int column0 = placed.column0[lane], column1 = placed.column1[lane];
    const int row0 = placed.row0[lane], row1 = placed.row1[lane], side = state.samples.side;
    state.counts.tested += std::int64_t{column1 - column0 + 1} * (row1 - row0 + 1);
    const std::size_t plane = static_cast<std::size_t>(triple) * side * side;
    std::int64_t covered = 0;
    const int lanes = static_cast<int>(hn::Lanes(f));
    if (side >= lanes) {
        for (int row = row0; row <= row1; ++row)
            for (int column = column0 / lanes * lanes; column <= column1; column += lanes)
                covered += cover_vector<kTwoSided>(f, state, T, C, triple, plane + row * side + column);
    } else {  // a vector holds several rows
        const int rows = lanes / side;
        for (int row = row0 / rows * rows; row <= row1; row += rows)
            covered += cover_vector<kTwoSided>(f, state, T, C, triple, plane + row * side);
    }
    state.counts.covered += covered;
}

// Blocks that the triangle's pixels touch, within the tile.
BlockRange blocks_of(const BinnedTriangle& binned, const Tile& tile, int side) {
    const int left = tile.cell_x() * kCellSize, top = tile.cell_y() * kCellSize;
    return {(std::max<int>(binned.x0, tile.x0) - left) / side, (std::min<int>(binned.x1, tile.x1) - 1 - left) / side,
            (std::max<int>(binned.y0, tile.y0) - top) / side, (std::min<int>(binned.y1, tile.y1) - 1 - top) / side};
}

void cover_triangle(TileState& state, const BinnedTriangle& binned) {
    const LocalTriangle T = localize(state.work.frame, binned.triangle, binned.segment, state.centre);
    const BlockRange limits = blocks_of(binned, state.work.tile, state.samples.block_side);
    const int triples = static_cast<int>(state.samples.triples.size()), lanes = static_cast<int>(hn::Lanes(F()));
    Placed placed;
    // Triples are numbered by time: those of a segment are neighbours.
    const auto count_before = [&](float segment) {
        const auto earlier = [&](const SharedSamples::Triple& at) { return at.t * T.segments < segment; };
        return static_cast<int>(
            std::partition_point(state.samples.triples.begin(), state.samples.triples.end(), earlier) -
            state.samples.triples.begin());
    };
    const int begin = T.segments > 1.0f ? count_before(T.segment) : 0;
    const int end = T.segments > 1.0f ? count_before(T.segment + 1.0f) : triples;
    for (int first = begin / lanes * lanes; first < end; first += lanes) {
        if (!place_triples(state, T, first, limits, placed)) continue;
        for (int lane = 0; lane < lanes; ++lane) {
            if (placed.row0[lane] > placed.row1[lane] || placed.column0[lane] > placed.column1[lane]) continue;
            if (T.two_sided)
                cover_triple<true>(state, T, placed, lane, first + lane);
            else
                cover_triple<false>(state, T, placed, lane, first + lane);
        }
    }
}

void update_farthest(TileState& state) {
    const F f;
    Vec farthest = hn::Zero(f);
    for (std::size_t i = 0; i < state.depth.size(); i += hn::Lanes(f))
        farthest = hn::Max(farthest, hn::Load(f, &state.depth[i]));
    state.farthest = hn::GetLane(hn::MaxOfLanes(f, farthest));
}

void cover_front_to_back(TileState& state) {
    const TileWork& work = state.work;
    constexpr int kBetweenUpdates = 32;
    int until_update = kBetweenUpdates;
    for (const std::uint32_t entry : front_to_back(work)) {
        const BinnedTriangle& binned = work.triangles[entry];
        if (nearest_depth(work, binned) > state.farthest) return;  // so are all that follow
        cover_triangle(state, binned);
        if (--until_update == 0) {
            update_farthest(state);
            until_update = kBetweenUpdates;
        }
    }
}

// Calls visit(entry) for each sample of the cell that lies outside the tile.
template <class Visit>
void for_each_outside(const TileState& state, const Visit& visit) {
    const Tile& tile = state.work.tile;
    const int left = tile.cell_x() * kCellSize, top = tile.cell_y() * kCellSize;
    if (tile.x0 == left && tile.y0 == top && tile.x1 == left + kCellSize && tile.y1 == top + kCellSize) return;
    const std::size_t spp = static_cast<std::size_t>(state.work.samples.spp());
    for (std::size_t i = 0; i < state.samples.place.size(); ++i) {
        const std::size_t place = state.samples.place[i], block = place / kLanes / spp, lane = place % kLanes;
        const int px = left + static_cast<int>(block % kCellBlocks * kBlockSize + lane % kBlockSize);
        const int py = top + static_cast<int>(block / kCellBlocks * kBlockSize + lane / kBlockSize);
        if (px < tile.x0 || px >= tile.x1 || py < tile.y0 || py >= tile.y1) visit(i);
    }
}

}  // namespace

void cover_shared_tile(const TileWork& work, Hits& hits, CoverCounts& counts) {
    TileState state(work, counts);
    state.depth.assign(state.samples.x.size(), INFINITY);
    state.triangle.assign(state.samples.x.size(), kNoTriangle);
    for_each_outside(state, [&](std::size_t i) { state.depth[i] = -INFINITY; });
    const std::size_t triples = state.samples.triples.size(), padded = (triples + kLanes - 1) / kLanes * kLanes;
    state.u.assign(padded, 0.0f);
    state.v.assign(padded, 0.0f);
    state.t.assign(padded, 2.0f);
    for (std::size_t i = 0; i < triples; ++i) {
        const SharedSamples::Triple& triple = state.samples.triples[i];
        state.u[i] = triple.u, state.v[i] = triple.v, state.t[i] = triple.t;
    }
    cover_front_to_back(state);
    const std::uint32_t of_block = static_cast<std::uint32_t>(work.samples.spp()) * kLanes;
    const bool whole_cell = hits.triangle.size() == state.triangle.size();
    for (std::size_t i = 0; i < state.triangle.size(); ++i) {
        if (state.triangle[i] == kNoTriangle) continue;
        const std::uint32_t place = state.samples.place[i];
        const std::uint32_t entry =
            whole_cell ? place : hits.first(static_cast<int>(place / of_block)) + place % of_block;
        hits.depth[entry] = state.depth[i];
        hits.triangle[entry] = state.triangle[i];
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace pentaprism
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include "base/cpu_dispatch.h"

namespace pentaprism {

void cover_shared(const TileWork& work, Hits& hits, CoverCounts& counts) {
    PENTAPRISM_RETURN_FOR_CPU(cover_shared_tile(work, hits, counts));
    return cover_with_test(work, *find_cull_test("improved-dual-space"), hits, counts);
}

}  // namespace pentaprism
#endif
