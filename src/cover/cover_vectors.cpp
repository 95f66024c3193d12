// The fast path of the coverage stage: sixteen samples at a time, the same decisions as cover/exact.cpp bit for bit.
//
// The tile's triangles are walked roughly front to back, so that what is hidden is refused early; equal depths go to
// the lower triangle whatever the order. Sixteen at a time:
//   1. with triangles in the lanes: shear, and half-planes that hold all that they cover (blur_batch-inl.h).
// For each:
//   2. over each stratum of (u, v, t) they give the 4x4-pixel blocks in which its samples can hit; the vectors (block,
//      slot) of these whose farthest depth so far is beyond the triangle form a work list (work_list-inl.h);
//   3. a pass over the list keeps vectors with samples inside the edges' half-planes, without branching on it;
//   4. a pass over those does the exact test, depth, opacity and writes (vector_test-inl.h).
// Where a tile holds more triangles than pixels, sixteen that blur alike take step 2 together (cluster-inl.h). Segments
// of a path that vectors cross are listed and tested together (path_time-inl.h). This file is compiled once for each
// CPU target.

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "cover/cover_vectors.cpp"
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4)
#include <hwy/foreach_target.h>
// foreach_target.h must come first.
#include <algorithm>
#include <bit>
#include <cmath>
#include <hwy/highway.h>

#include "cover/cover.h"
#include "cover/front_to_back.h"
#include "cover/wide_blur.h"

#if HWY_TARGET != HWY_SCALAR  // which takes cover_with_test()
#include "cover/blur_batch-inl.h"
#include "cover/cluster-inl.h"
#include "cover/half_planes-inl.h"
#include "cover/lanes-inl.h"
#include "cover/path_time-inl.h"
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

using CoverJobs = void (*)(TileState&, const Tested&, bool, std::size_t);

template <Moves kMoves, bool kDefocus, bool kFine>
CoverJobs choose(Seen seen) {
    switch (seen) {
        case Seen::kFront:
            return cover_jobs<Kind<kMoves, kDefocus, Seen::kFront, kFine>>;
        case Seen::kBack:
            return cover_jobs<Kind<kMoves, kDefocus, Seen::kBack, kFine>>;
        case Seen::kBoth:
            break;
    }
    return cover_jobs<Kind<kMoves, kDefocus, Seen::kBoth, kFine>>;
}

template <bool kDefocus, bool kFine>
CoverJobs choose(Seen seen, bool motion, bool in_pieces) {
    if (!motion) return choose<Moves::kNot, kDefocus, kFine>(seen);
    return in_pieces ? choose<Moves::kInPieces, kDefocus, kFine>(seen)
                     : choose<Moves::kStraight, kDefocus, kFine>(seen);
}

Seen sides_seen(const BlurBatch& batch, int k) {
    const Facing facing = batch.binned[k]->facing;
    return !batch.part[k]->two_sided || facing == Facing::kFront ? Seen::kFront
           : facing == Facing::kBack                             ? Seen::kBack
                                                                 : Seen::kBoth;
}

CoverJobs choose_kind(const TileState& state, const Tested& tested) {
    const BlurBatch& batch = tested.batch;
    const int k = tested.k;
    const bool fine = !state.arrangement.places.empty();
    Seen seen = sides_seen(batch, k);
    if (tested.count > 1) {  // rare without defocus: not a kernel of its own
        for (int next = k + 1; next < k + tested.count; ++next)
            if (sides_seen(batch, next) != seen) seen = Seen::kBoth;
        return fine ? choose<Moves::kAlongPieces, true, true>(seen) : choose<Moves::kAlongPieces, true, false>(seen);
    }
    const bool motion = batch.moves[k] != 0, in_pieces = batch.segments[k] > 1.0f;
    if (batch.defocus[k] == 0)
        return fine ? choose<false, true>(seen, motion, in_pieces) : choose<false, false>(seen, motion, in_pieces);
    return fine ? choose<true, true>(seen, motion, in_pieces) : choose<true, false>(seen, motion, in_pieces);
}

// The triangle in `count` segments from the batch's k on, against the vectors of the work list.
void cover_listed(TileState& state, const BlurBatch& batch, int k, int count, std::size_t jobs) {
    if (jobs == 0) return;
    const LocalTriangle T = local_triangle(batch, k, state.work.frame);
    const Tested tested{batch, k, count, T};
    choose_kind(state, tested)(state, tested, true, jobs);
}

std::uint64_t blocks_in_tile(const TileState& state, const BinnedTriangle& binned) {
    return blocks_of(binned, state.work.tile, state.arrangement.block_size) & state.tile_blocks;
}

// The work list of a triangle in `count` segments from the batch's k on. find_blocks(segment, blocks, masks) gets the
// blocks that one's bounds reach, returns those in which it may be hit and writes which of them by stratum.
template <class FindBlocks>
std::size_t list_segments(TileState& state, const BlurBatch& batch, int k, int count, const FindBlocks& find_blocks) {
    HWY_ALIGN std::uint64_t masks[kMaxStrata];
    std::uint64_t blocks_of_all = 0;
    float nearest = batch.nearest[k];
    std::fill(state.masks, state.masks + state.stratum_count, 0);
    for (int segment = k; segment < k + count; ++segment) {
        const std::uint64_t blocks = find_blocks(segment, blocks_in_tile(state, *batch.binned[segment]), masks);
        for (int s = 0; s < state.stratum_count; ++s) state.masks[s] |= masks[s] & blocks;
        blocks_of_all |= blocks;
        nearest = std::min(nearest, batch.nearest[segment]);
    }
    return list_jobs(state, state.masks, blocks_of_all, nearest);
}

// The triangle in `count` segments from the batch's k on, all of which reach the camera plane.
void cover_at_camera_plane(TileState& state, BlurBatch& batch, int k, int count, const CullTest& camera_plane_test) {
    LocalTriangle first;
    const std::size_t jobs =
        list_segments(state, batch, k, count, [&](int segment, std::uint64_t blocks, std::uint64_t* masks) HWY_ATTR {
            const LocalTriangle T = at_camera_plane(state, batch, segment);
            if (segment == k) first = T;
            for (int side = 0; side < 4; ++side) batch.box[side][segment] = T.box[side];
            blocks = blocks_at_camera_plane(T, camera_plane_test, static_cast<float>(state.work.frame.view.lens.ratio),
                                            state.block_size, blocks);
            StratumLimits(state, batch.segment[segment], batch.segments[segment]).all_blocks_in_time(masks);
            return blocks;
        });
    const Tested tested{batch, k, count, first};
    choose_kind(state, tested)(state, tested, false, jobs);
}

// Blocks of each stratum in which the triangle may be hit.
void blocks_of_strata(TileState& state, const BlurBatch& batch, int k, std::uint64_t blocks, std::uint64_t* masks) {
    const HalfPlanes& H = batch.planes;
    const StratumLimits limits(state, batch.segment[k], batch.segments[k]);
    boxes_of_strata(state, H, k, limits, masks);
    // Many blocks in many strata: worth a closer look.
    const int block_count = std::popcount(blocks);
    if ((block_count >= kWorthRefining && H.smaller_side[k] > kLargeTriangle) ||
        (block_count > 1 && state.stratum_count == 1))
        refuse_blocks_by_edges(state, H, k, limits, BlockGroups(blocks), masks);
}

void cover_triangle(TileState& state, const BlurBatch& batch, int k) {
    const std::uint64_t blocks = blocks_in_tile(state, *batch.binned[k]);
    blocks_of_strata(state, batch, k, blocks, state.masks);
    cover_listed(state, batch, k, 1, list_jobs(state, state.masks, blocks, batch.nearest[k]));
}

// The same in `count` segments at once.
void cover_segments(TileState& state, const BlurBatch& batch, int k, int count) {
    const std::size_t jobs =
        list_segments(state, batch, k, count, [&](int segment, std::uint64_t blocks, std::uint64_t* masks) HWY_ATTR {
            blocks_of_strata(state, batch, segment, blocks, masks);
            return blocks;
        });
    cover_listed(state, batch, k, count, jobs);
}

void cover_one_by_one(TileState& state, BlurBatch& batch, const CullTest& camera_plane_test) {
    for (int k = 0; k < batch.count;) {
        const int count = count_segments(state, batch, k);
        if (batch.behind[k] != 0)
            cover_at_camera_plane(state, batch, k, count, camera_plane_test);
        else if (count == 1)
            cover_triangle(state, batch, k);
        else
            cover_segments(state, batch, k, count);
        k += count;
    }
}

void cover_batch(TileState& state, BlurBatch& batch, const CullTest& camera_plane_test) {
    prepare(batch, state.work, state.centre);
    cover_one_by_one(state, batch, camera_plane_test);
    batch.count = 0;
}

void cover_cluster(TileState& state, ClusterList& list, BlurBatch& batch, const CullTest& camera_plane_test) {
    prepare(batch, state.work, state.centre);
    std::uint64_t blocks = 0;
    bool alike = true;
    for (int k = 0; k < batch.count; ++k) {
        blocks |= blocks_in_tile(state, *batch.binned[k]);
        alike = alike && batch.behind[k] == 0 && batch.segments[k] == batch.segments[0] &&
                batch.segment[k] == batch.segment[0];
    }
    if (alike) {
        list_cluster(state, batch, blocks, list);
        for (int k = 0; k < batch.count; ++k) {
            if (batch.nearest[k] > state.tile_farthest) continue;
            cover_listed(state, batch, k, 1, jobs_of_triangle(state, list, k, batch.nearest[k]));
        }
    } else {
        cover_one_by_one(state, batch, camera_plane_test);
    }
    batch.count = 0;
}

// Farthest depth that any of the tile's samples still shows.
void update_tile_farthest(TileState& state) {
    const F f;
    Vec farthest = hn::Zero(f);
    for (std::size_t job = 0; job < state.farthest.size(); job += kWidth)
        farthest = hn::Max(farthest, hn::Load(f, &state.farthest[job]));
    state.tile_farthest = hn::GetLane(hn::MaxOfLanes(f, farthest));
}

void cover_front_to_back(TileState& state) {
    const CullTest& camera_plane_test = *find_cull_test("improved-dual-space");
    BlurBatch batch{}, cluster{};
    ClusterList list;
    const ClusteredOrder order = clustered_front_to_back(state.work, state.vector_span);
    const std::vector<std::uint32_t>& entries = order.entries;
    if (!order.clusters.empty()) {
        list.jobs.resize(state.jobs.size());
        list.triangles.resize(state.jobs.size());
        list.farthest.resize(state.jobs.size());
    }
    const bool some_blocks = state.work.tile.blocks != ~std::uint64_t{0};
    auto next_cluster = order.clusters.begin();
    for (std::size_t i = 0; i < entries.size(); ++i) {
        fetch_ahead(state.work, entries, i);
        const BinnedTriangle& binned = state.work.triangles[entries[i]];
        const bool in_cluster = next_cluster != order.clusters.end() && i >= *next_cluster;
        if (order.nearest[i] > state.tile_farthest) break;  // so are all that follow
        if (in_cluster) {
            append(cluster, state.work.frame, binned, nearest_depth(state.work, binned));
            if (cluster.count < BlurBatch::kSize) continue;
            ++next_cluster;
            cover_cluster(state, list, cluster, camera_plane_test);
        } else {
            if (some_blocks && blocks_in_tile(state, binned) == 0) continue;
            append(batch, state.work.frame, binned, nearest_depth(state.work, binned));
            if (batch.count < BlurBatch::kSize) continue;
            cover_batch(state, batch, camera_plane_test);
        }
        update_tile_farthest(state);
    }
    if (batch.count != 0) cover_batch(state, batch, camera_plane_test);
}

// Puts in order what stands in another: of each entry its place is given.
template <class T>
void put_in_place(AlignedVector<T>& values, std::span<const std::uint32_t> places) {
    thread_local AlignedVector<T> as_found;
    as_found.assign(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(places.size()));
    for (std::size_t i = 0; i < places.size(); ++i) values[places[i]] = as_found[i];
}

void cover_arranged(const TileWork& work, const Arrangement& arrangement, Hits& hits, CoverCounts& counts) {
    TileState state(work, arrangement, hits, counts);
    const bool rearranged = !arrangement.places.empty();  // then the tile is a whole cell
    const int slots = arrangement.slots, size = arrangement.block_size;
    const int left = work.tile.cell_x() * kCellSize, top = work.tile.cell_y() * kCellSize;
    state.tile_blocks = column_mask((work.tile.x0 - left) / size, (work.tile.x1 - 1 - left) / size) &
                        row_mask((work.tile.y0 - top) / size, (work.tile.y1 - 1 - top) / size) & work.tile.blocks;
    const std::size_t vectors = std::size_t{kCellSize} * kCellSize * work.samples.spp() / kLanes;
    state.farthest.resize(vectors);
    for (std::size_t job = 0; job < vectors; ++job) {  // nothing is hidden in the tile, everything beyond it
        const bool within = rearranged || (state.tile_blocks >> (job % kBlocksPerCell) & 1u) != 0;
        state.farthest[job] = within ? INFINITY : -INFINITY;
    }
    state.jobs.resize(vectors + kLanes);  // list_jobs writes up to sixteen beyond

    // Pixels beyond the tile's border take no hits: nothing is nearer than -infinity.
    auto for_each_outside_lane = [&](auto&& visit) {
        for (std::uint64_t m = state.tile_blocks; m != 0; m &= m - 1)
            for (int lane = 0; lane < kLanes; ++lane) {
                const int b = std::countr_zero(m);
                const int px = left + b % kCellBlocks * kBlockSize + lane % kBlockSize;
                const int py = top + b / kCellBlocks * kBlockSize + lane / kBlockSize;
                if (px < work.tile.x1 && py < work.tile.y1) continue;
                for (int slot = 0; slot < slots; ++slot)
                    visit(hits.first(b) + static_cast<std::size_t>(slot) * kLanes + lane);
            }
    };
    const bool cut = work.tile.x1 % kBlockSize != 0 || work.tile.y1 % kBlockSize != 0;
    if (cut) for_each_outside_lane([&](std::size_t s) { hits.depth[s] = -INFINITY; });
    cover_front_to_back(state);
    if (cut) for_each_outside_lane([&](std::size_t s) { hits.depth[s] = INFINITY; });
}

}  // namespace

void cover_tile(const TileWork& work, Hits& hits, CoverCounts& counts) {
    const int cx = work.tile.cell_x(), cy = work.tile.cell_y();
    if (blurs_widely(work)) {
        const FineLens& fine = work.samples.fine_lens();
        const std::size_t cell = work.samples.cell_index(cx, cy);
        const std::span<const std::uint32_t> places = fine.places(cell);
        cover_arranged(work,
                       {fine.block_size(), fine.slots(), fine.cell(cell).data(), fine.domains(), fine.strata(), places},
                       hits, counts);
        put_in_place(hits.depth, places);
        put_in_place(hits.triangle, places);
        return;
    }
    const ArrangementOfTable of_table(work);
    cover_arranged(work, of_table.arrangement, hits, counts);
}

}  // namespace HWY_NAMESPACE
}  // namespace pentaprism
HWY_AFTER_NAMESPACE();
#endif  // HWY_SCALAR

#if HWY_ONCE
#include "base/cpu_dispatch.h"

namespace pentaprism {

void cover_vectors(const TileWork& work, Hits& hits, CoverCounts& counts) {
    PENTAPRISM_RETURN_FOR_CPU(cover_tile(work, hits, counts));
    return cover_with_test(work, *find_cull_test("improved-dual-space"), hits, counts);
}

}  // namespace pentaprism
#endif
