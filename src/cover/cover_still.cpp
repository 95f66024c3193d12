// The fast path for pictures in which nothing blurs: the samples of a pixel lie close together, so a vector is sixteen
// samples of one pixel (cover_vectors.cpp: one sample of sixteen pixels). The same decisions as cover/exact.cpp bit for
// bit.
//
// The tile's triangles are walked roughly front to back, sixteen at a time:
//   1. with triangles in the lanes: shear and half-planes (still_batch-inl.h);
//   2. for each, the pixels in which a sample may be covered and that are not hidden, as one flat list;
//   3. a pass over the list does the exact test, depth and writes without branching on what it finds
//   (still_test-inl.h).
// Depths and triangles stand pixel by pixel in the tile's Hits meanwhile; at the end each block is transposed.
// This file is compiled once for each CPU target.

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "cover/cover_still.cpp"
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4)
#include <hwy/foreach_target.h>
// foreach_target.h must come first.
#include <algorithm>
#include <cmath>
#include <hwy/highway.h>

#include "cover/cover.h"
#include "cover/front_to_back.h"

#if HWY_TARGET != HWY_SCALAR  // which takes cover_with_test()
#include "cover/still_batch-inl.h"
#include "cover/still_test-inl.h"
#include "cover/work_list-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pentaprism {
namespace HWY_NAMESPACE {
namespace {

SpecialTriangle special_triangle(const StillTile& tile, const BinnedTriangle& binned) {
    SpecialTriangle special;
    special.T = localize(tile.work.frame, binned.triangle, binned.segment, tile.centre, tile.work.scale);
    special.ask_range = may_leave_depth_range(special.T);
    if (special.T.alpha_tested) special.terms = opacity_terms(tile.work.frame, binned.triangle);
    return special;
}

void cover_special(StillTile& tile, const StillBatch& batch, int k, std::uint32_t* jobs, std::size_t count) {
    const SpecialTriangle special = special_triangle(tile, *batch.binned[k]);
    if (special.T.behind) {
        const float ratio = static_cast<float>(tile.work.frame.view.lens.ratio);
        const std::uint64_t blocks =
            blocks_at_camera_plane(special.T, *find_cull_test("improved-dual-space"), ratio, kBlockSize,
                                   blocks_of(*batch.binned[k], tile.work.tile, kBlockSize));
        const auto refused = [&](std::uint32_t job) { return (blocks >> (job & 0xffff) / kLanes & 1) == 0; };
        count = static_cast<std::size_t>(std::remove_if(jobs, jobs + count, refused) - jobs);
    }
    cover_pixels<true>(tile, batch, jobs, count, &special);
}

void cover_batch(StillTile& tile, StillBatch& batch, std::uint32_t* jobs) {
    prepare(batch, tile.work, tile.centre);
    std::size_t count = 0;
    for (int k = 0; k < batch.count; ++k) {
        const CellRect rect = rect_of(*batch.binned[k], tile.work.tile);
        const std::size_t listed = list_pixels(batch, k, rect, tile.blocks, tile.farthest, jobs + count);
        if (batch.special[k] != 0)
            cover_special(tile, batch, k, jobs + count, listed);
        else
            count += listed;
    }
    cover_pixels<false>(tile, batch, jobs, count, nullptr);
    batch.count = 0;
}

void update_tile_farthest(StillTile& tile) {
    const F f;
    Vec farthest = hn::Set(f, -INFINITY);
    for (int pixel = 0; pixel < StillTile::kPixels; pixel += kWidth)
        farthest = hn::Max(farthest, hn::Load(f, &tile.farthest[pixel]));
    tile.tile_farthest = hn::GetLane(hn::MaxOfLanes(f, farthest));
}

void cover_front_to_back(StillTile& tile) {
    const TileWork& work = tile.work;
    StillBatch batch{};
    std::vector<std::uint32_t> jobs((StillBatch::kSize + 1) * StillTile::kPixels);
    const std::vector<std::uint32_t> order = front_to_back(work);
    for (std::size_t i = 0; i < order.size(); ++i) {
        fetch_ahead(work, order, i);
        const BinnedTriangle& binned = work.triangles[order[i]];
        const float nearest = nearest_depth(work, binned);
        if (nearest > tile.tile_farthest) break;  // so are all that follow
        const bool two_sided = work.frame.parts[work.frame.part_of[binned.triangle]].two_sided;
        if (!two_sided || binned.facing != Facing::kBack) append(batch, work, binned, nearest, 1.0f);
        if (two_sided && binned.facing != Facing::kFront) append(batch, work, binned, nearest, -1.0f);
        if (batch.count < StillBatch::kSize - 1) continue;  // the next may need two
        cover_batch(tile, batch, jobs.data());
        update_tile_farthest(tile);
    }
    if (batch.count != 0) cover_batch(tile, batch, jobs.data());
}

// to[column * kLanes + row] = from[row * stride + column] for sixteen rows and columns.
template <class T>
HWY_INLINE void transpose(const T* HWY_RESTRICT from, std::size_t stride, T* HWY_RESTRICT to) {
    const hn::FixedTag<T, 4> d;
    for (int row = 0; row < kLanes; row += 4)
        for (int column = 0; column < kLanes; column += 4) {
            const T* at = from + row * stride + column;
            const auto a = hn::Load(d, at), b = hn::Load(d, at + stride), c = hn::Load(d, at + 2 * stride),
                       e = hn::Load(d, at + 3 * stride);
            const auto ab = hn::InterleaveLower(d, a, b), ce = hn::InterleaveLower(d, c, e);
            const auto ab_upper = hn::InterleaveUpper(d, a, b), ce_upper = hn::InterleaveUpper(d, c, e);
            T* out = to + column * kLanes + row;
            hn::Store(hn::ConcatLowerLower(d, ce, ab), d, out);
            hn::Store(hn::ConcatUpperUpper(d, ce, ab), d, out + kLanes);
            hn::Store(hn::ConcatLowerLower(d, ce_upper, ab_upper), d, out + 2 * kLanes);
            hn::Store(hn::ConcatUpperUpper(d, ce_upper, ab_upper), d, out + 3 * kLanes);
        }
}

// From the order of PixelSamples to that of Hits, in place.
template <class T>
void arrange_by_slot(AlignedVector<T>& values, std::size_t spp) {
    const std::size_t size = kLanes * spp;  // of a block
    AlignedVector<T> block(size);
    for (std::size_t first = 0; first < values.size(); first += size) {
        std::copy_n(&values[first], size, block.data());
        for (std::size_t slot = 0; slot < spp; slot += kLanes)
            transpose(&block[slot], spp, &values[first + slot * kLanes]);
    }
}

// Sets the depth of the cell's pixels that lie outside the tile or its wanted blocks.
void set_outside(StillTile& tile, float depth) {
    const Tile& t = tile.work.tile;
    const int left = t.cell_x() * kCellSize, top = t.cell_y() * kCellSize;
    if (t.x1 - t.x0 == kCellSize && t.y1 - t.y0 == kCellSize && t.blocks == ~std::uint64_t{0}) return;
    for (int pixel = 0; pixel < StillTile::kPixels; ++pixel) {
        const int block = pixel / kLanes, lane = pixel % kLanes;
        const int px = left + block % kCellBlocks * kBlockSize + lane % kBlockSize;
        const int py = top + block / kCellBlocks * kBlockSize + lane / kBlockSize;
        const bool has_hits = (tile.blocks >> block & 1u) != 0;
        if (has_hits && px < t.x1 && py < t.y1) continue;
        if (has_hits) std::fill_n(&tile.depth[tile.entry(pixel * tile.spp, pixel)], tile.spp, depth);
        tile.farthest[pixel] = depth;
    }
}

}  // namespace

void cover_still_tile(const TileWork& work, Hits& hits, CoverCounts& counts) {
    StillTile tile(work, work.samples.by_pixel(work.tile.cell_x(), work.tile.cell_y()), hits);
    set_outside(tile, -INFINITY);
    cover_front_to_back(tile);
    set_outside(tile, INFINITY);
    arrange_by_slot(hits.depth, tile.spp);
    arrange_by_slot(hits.triangle, tile.spp);
    counts.tested += tile.tested;
    counts.covered += tile.covered;
}

}  // namespace HWY_NAMESPACE
}  // namespace pentaprism
HWY_AFTER_NAMESPACE();
#endif  // HWY_SCALAR

#if HWY_ONCE
#include "base/cpu_dispatch.h"

namespace pentaprism {

void cover_still(const TileWork& work, Hits& hits, CoverCounts& counts) {
    PENTAPRISM_RETURN_FOR_CPU(cover_still_tile(work, hits, counts));
    return cover_with_test(work, *find_cull_test("improved-dual-space"), hits, counts);
}

}  // namespace pentaprism
#endif
