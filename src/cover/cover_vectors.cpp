// The fast path of the coverage stage: sixteen samples at a time, the same decisions as cover/exact.cpp bit for bit.
//
// The tile's triangles are walked roughly front to back, so that what is hidden is refused early; equal depths go to
// the lower triangle whatever the order. For each triangle:
//   1. half-planes that hold all that it covers (half_planes-inl.h);
//   2. over each stratum of (u, v, t) they give the 4x4-pixel blocks in which its samples can hit; the vectors (block,
//      slot) of these whose farthest depth so far is beyond the triangle form a work list (work_list-inl.h);
//   3. a pass over the list keeps vectors with samples inside the edges' half-planes, without branching on it;
//   4. a pass over those does the exact test, depth, opacity and writes (vector_test-inl.h).
// This file is compiled once for each CPU target.

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
#include "cover/front_to_back.h"
#include "cover/half_planes-inl.h"
#include "cover/lanes-inl.h"
#include "cover/vector_test-inl.h"
#include "cover/work_list-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pentaprism {
namespace HWY_NAMESPACE {
namespace {

// Edges are asked for blocks of triangles of this many pixels and bins of this many blocks: measured
// (docs/develop/performance.md).
constexpr float kLargeTriangle = 6.0f;
constexpr int kWorthRefining = 6;

using CoverJobs = void (*)(TileState&, const LocalTriangle&, const HalfPlanes*, std::size_t);

template <Moves kMoves, bool kDefocus>
CoverJobs choose(Seen seen) {
    switch (seen) {
        case Seen::kFront:
            return cover_jobs<Kind<kMoves, kDefocus, Seen::kFront>>;
        case Seen::kBack:
            return cover_jobs<Kind<kMoves, kDefocus, Seen::kBack>>;
        case Seen::kBoth:
            break;
    }
    return cover_jobs<Kind<kMoves, kDefocus, Seen::kBoth>>;
}

CoverJobs choose_kind(const LocalTriangle& T, Facing facing) {
    bool motion = T.segments > 1.0f, defocus = false;
    for (int k = 0; k < 3; ++k) {
        motion = motion || T.dx[k] != 0 || T.dy[k] != 0 || T.dw[k] != 0 || T.dc[k] != 0 || T.dz[k] != 0;
        defocus = defocus || T.qc[k] != 0 || T.dc[k] != 0;
    }
    const Seen seen = !T.two_sided || facing == Facing::kFront ? Seen::kFront
                      : facing == Facing::kBack                ? Seen::kBack
                                                               : Seen::kBoth;
    if (!motion) return defocus ? choose<Moves::kNot, true>(seen) : choose<Moves::kNot, false>(seen);
    if (T.segments > 1.0f)
        return defocus ? choose<Moves::kInPieces, true>(seen) : choose<Moves::kInPieces, false>(seen);
    return defocus ? choose<Moves::kStraight, true>(seen) : choose<Moves::kStraight, false>(seen);
}

void cover_triangle(TileState& state, const BinnedTriangle& binned, float nearest, const CullTest& camera_plane_test) {
    std::uint64_t blocks = blocks_of(binned, state.work.tile) & state.tile_blocks;
    if (blocks == 0) return;
    const LocalTriangle T = localize(state.work.frame, binned.triangle, binned.segment, state.centre, state.work.scale);
    const float ratio = static_cast<float>(state.work.frame.view.lens.ratio);
    std::uint64_t masks[kMaxStrata];
    if (T.behind) {
        blocks = blocks_at_camera_plane(T, camera_plane_test, ratio, blocks);
        std::fill(masks, masks + state.stratum_count, ~0ull);
        const std::size_t jobs = list_jobs(state, masks, blocks, nearest);
        choose_kind(T, binned.facing)(state, T, nullptr, jobs);
        return;
    }
    const HalfPlanes H = half_planes(T, ratio);
    StratumLimits limits;
    // Many blocks in many strata: worth a closer look.
    const int block_count = std::popcount(blocks);
    const bool refine = (block_count >= kWorthRefining && H.smaller_side > kLargeTriangle) ||
                        (block_count > 1 && state.stratum_count == 1);
    bound_strata(state, T, H, refine ? HalfPlanes::kCount : HalfPlanes::kEdges, limits);
    boxes_of_strata(state, limits, masks);
    if (refine) refuse_blocks_by_edges(state, H, limits, masks);
    const std::size_t jobs = list_jobs(state, masks, blocks, nearest);
    if (jobs != 0) choose_kind(T, binned.facing)(state, T, &H, jobs);
}

// Farthest depth that any of the tile's samples still shows.
void update_tile_farthest(TileState& state) {
    const F f;
    Vec farthest = hn::Zero(f);
    for (int slot = 0; slot < state.slots; ++slot)
        for (int block = 0; block < kBlocksPerCell; block += kWidth)
            farthest = hn::Max(farthest, hn::Load(f, &state.farthest[slot * kBlocksPerCell + block]));
    state.tile_farthest = hn::GetLane(hn::MaxOfLanes(f, farthest));
}

void cover_front_to_back(TileState& state) {
    constexpr int kBetweenUpdates = 16;
    const CullTest& camera_plane_test = *find_cull_test("improved-dual-space");
    int until_update = kBetweenUpdates;
    for (const std::uint32_t entry : front_to_back(state.work)) {
        const BinnedTriangle& binned = state.work.triangles[entry];
        const float nearest = nearest_depth(state.work, binned);
        if (nearest > state.tile_farthest) return;  // so are all that follow
        cover_triangle(state, binned, nearest, camera_plane_test);
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
    state.slots = slots;
    state.strata = work.samples.strata(work.tile.cell_x(), work.tile.cell_y());
    std::vector<Domain> domains_of_cell;
    const std::span<const Domain> domains =
        work.samples.domains(work.tile.cell_x(), work.tile.cell_y(), domains_of_cell);
    state.stratum_count = static_cast<int>(domains.size());
    for (int s = 0; s < kMaxStrata; ++s) {
        const Domain d = s < state.stratum_count ? domains[s] : Domain{0, 0, 0, 0, 2, -2};
        state.u[0][s] = d.u0, state.v[0][s] = d.v0, state.t[0][s] = d.t0;
        state.u[1][s] = d.u1, state.v[1][s] = d.v1, state.t[1][s] = d.t1;
    }
    state.tile_blocks = column_mask((work.tile.x0 - left) / kBlockSize, (work.tile.x1 - 1 - left) / kBlockSize) &
                        row_mask((work.tile.y0 - top) / kBlockSize, (work.tile.y1 - 1 - top) / kBlockSize) &
                        work.tile.blocks;
    std::vector<SampleVector> vectors_of_cell;
    state.samples = work.samples.cell(work.tile.cell_x(), work.tile.cell_y(), vectors_of_cell).data();
    const std::size_t vectors = static_cast<std::size_t>(kBlocksPerCell) * slots;
    state.farthest.resize(vectors);
    for (std::size_t job = 0; job < vectors; ++job)  // nothing is hidden in the tile, everything beyond it
        state.farthest[job] = state.tile_blocks >> (job % kBlocksPerCell) & 1 ? INFINITY : -INFINITY;
    state.jobs.resize(vectors + 8);  // list_jobs writes up to 7 beyond
    for (int b = 0; b < kBlocksPerCell; ++b) {
        state.column_of_block[b] = static_cast<float>(b % kCellBlocks);
        state.row_of_block[b] = static_cast<float>(b / kCellBlocks);
    }

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
