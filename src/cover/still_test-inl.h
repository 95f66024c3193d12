// The exact test of a pixel's samples against a still triangle of a batch, the same decisions as cover/exact.cpp bit
// for bit, with depth, opacity and writes. Sixteen samples of one pixel stand in the lanes.

#if defined(PENTAPRISM_COVER_STILL_TEST_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef PENTAPRISM_COVER_STILL_TEST_INL_H
#undef PENTAPRISM_COVER_STILL_TEST_INL_H
#else
#define PENTAPRISM_COVER_STILL_TEST_INL_H
#endif

#include <cmath>
#include <hwy/cache_control.h>

#include "cover/still_batch-inl.h"
#include "cover/vector_test-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pentaprism {
namespace HWY_NAMESPACE {

// The tile's samples and hits, pixel by pixel as in PixelSamples.
struct StillTile {
    StillTile(const TileWork& w, const PixelSamples& s, Hits& hits)
        : work(w),
          samples(s),
          centre(cell_centre(w.frame.view, w.tile.cell_x(), w.tile.cell_y())),
          spp(static_cast<std::size_t>(w.samples.spp())),
          depth(hits.depth.data()),
          triangle(hits.triangle.data()),
          blocks(w.tile.wanted_blocks()) {
        std::fill_n(farthest, kPixels, INFINITY);
        for (int block = 0; block < kBlocksPerCell; ++block)
            if ((blocks >> block & 1u) != 0) skipped[block] = block * kLanes * spp - hits.first(block);
    }

    static constexpr int kPixels = kBlocksPerCell * kLanes;
    const TileWork& work;
    PixelSamples samples;
    CellCentre centre;
    std::size_t spp;
    float* depth;  // of the tile's Hits; -infinity outside the tile: nothing is nearer
    std::uint32_t* triangle;
    std::uint64_t blocks;                      // of the cell, those in Hits
    std::size_t skipped[kBlocksPerCell] = {};  // samples before the block's that are not in Hits
    std::size_t entry(std::size_t at, std::size_t pixel) const { return at - skipped[pixel / kLanes]; }
    HWY_ALIGN float farthest[kPixels];  // by pixel: largest depth stored so far
    float tile_farthest = INFINITY;     // no smaller than any of `farthest`
    std::int64_t tested = 0, covered = 0;
};

// What a special triangle is asked beyond the edges.
struct SpecialTriangle {
    LocalTriangle T;
    OpacityTerms terms;
    bool ask_range;
};

// What the scalar test says of the lanes in `tied`.
HWY_NOINLINE inline Mask settle_ties(F f, const StillTile& tile, const BinnedTriangle& binned, std::size_t at,
                                     Mask tied, Vec& depth) {
    const LocalTriangle T = localize(tile.work.frame, binned.triangle, binned.segment, tile.centre, tile.work.scale);
    SampleVector s{};  // u, v, t: nothing blurs
    std::copy_n(&tile.samples.x[at], kWidth, s.x);
    std::copy_n(&tile.samples.y[at], kWidth, s.y);
    return decide_ties(f, tile.centre, T, s, 0, tied, depth);
}

// The samples of a pixel in the lanes.
struct LanesOfPixel {
    int px, py, first;
    SampleOfPixel operator()(int k) const { return {px, py, first + k}; }
};

// Lanes of `hit` within the distances and the bounds of a triangle that reaches the camera plane.
HWY_NOINLINE inline Mask decide_bounds(F f, const StillTile& tile, const SpecialTriangle& special, Vec depth,
                                       std::size_t at, Mask hit) {
    const LocalTriangle& T = special.T;
    if (T.behind)
        hit =
            hn::And(hit, in_box(f, tile.centre, T, hn::Load(f, &tile.samples.x[at]), hn::Load(f, &tile.samples.y[at])));
    if (special.ask_range)
        hit = hn::And(hit, hn::And(hn::Ge(depth, hn::Set(f, T.z_near)), hn::Le(depth, hn::Set(f, T.z_far))));
    return hit;
}

HWY_NOINLINE inline Mask decide_alpha(F f, const StillTile& tile, const SpecialTriangle& special, const Vec e[3],
                                      Vec sum, std::size_t at, Mask hit) {
    const int pixel = static_cast<int>(at / tile.spp), block = pixel / kLanes, lane = pixel % kLanes;
    const Tile& place = tile.work.tile;
    const LanesOfPixel lanes{place.cell_x() * kCellSize + block % kCellBlocks * kBlockSize + lane % kBlockSize,
                             place.cell_y() * kCellSize + block / kCellBlocks * kBlockSize + lane / kBlockSize,
                             static_cast<int>(at % tile.spp)};
    return decide_opacity(f, tile.work, special.T.triangle, special.terms, e, sum, hit, lanes);
}

// Samples [at, at + kWidth) of a pixel, from `entry` on in Hits. `special`: of a triangle that is not, unused.
template <bool kSpecial>
HWY_INLINE void cover_lanes(F f, StillTile& tile, const StillBatch& batch, int k, std::size_t at, std::size_t entry,
                            const SpecialTriangle* special) {
    const U u;
    const Vec hx = hn::Load(f, &tile.samples.x[at]), hy = hn::Load(f, &tile.samples.y[at]), zero = hn::Zero(f);
    Deltas D;
    for (int i = 0; i < 3; ++i) {
        D.x[i] = hn::NegMulAdd(hx, hn::Set(f, batch.w[i][k]), hn::Set(f, batch.x[i][k]));
        D.y[i] = hn::NegMulAdd(hy, hn::Set(f, batch.signed_w[i][k]), hn::Set(f, batch.y[i][k]));
        D.z[i] = hn::Set(f, batch.z[i][k]);
    }
    const Edges E = edges(D);
    const Vec least = hn::Min(hn::Min(E.e[0], E.e[1]), E.e[2]);
    Mask hit = hn::Gt(least, zero);
    const Mask tied = hn::Eq(least, zero);
    const Vec sum = hn::Add(hn::Add(E.e[0], E.e[1]), E.e[2]);
    Vec depth = hn::Add(hn::Add(hn::Mul(E.e[0], D.z[0]), hn::Mul(E.e[1], D.z[1])), hn::Mul(E.e[2], D.z[2]));
    depth = hn::Min(hn::Max(hn::Div(depth, sum), hn::Set(f, batch.least_z[k])), hn::Set(f, batch.most_z[k]));
    if constexpr (kSpecial) hit = decide_bounds(f, tile, *special, depth, at, hit);
    if (HWY_UNLIKELY(!hn::AllFalse(f, tied)))
        hit = hn::Or(hit, settle_ties(f, tile, *batch.binned[k], at, tied, depth));
    tile.covered += static_cast<std::int64_t>(hn::CountTrue(f, hit));

    const Vec stored = hn::Load(f, &tile.depth[entry]);
    const auto triangle = hn::Set(u, batch.triangle[k]), stored_triangle = hn::Load(u, &tile.triangle[entry]);
    const Mask equal = hn::And(hit, hn::Eq(depth, stored));
    hit = hn::And(hit, hn::Lt(depth, stored));
    if (HWY_UNLIKELY(!hn::AllFalse(f, equal))) {
        const auto lower = hn::Lt(hn::BitCast(I(), triangle), hn::BitCast(I(), stored_triangle));
        hit = hn::Or(hit, hn::And(equal, hn::RebindMask(f, lower)));
    }
    if constexpr (kSpecial)
        if (special->T.alpha_tested && !hn::AllFalse(f, hit)) hit = decide_alpha(f, tile, *special, E.e, sum, at, hit);
    hn::Store(hn::IfThenElse(hit, depth, stored), f, &tile.depth[entry]);
    hn::Store(hn::IfThenElse(hn::RebindMask(u, hit), triangle, stored_triangle), u, &tile.triangle[entry]);
}

// The exact test of all jobs, then what is farthest in their pixels: apart from the test, whose chain of operations is
// longer than the processor looks ahead, the reductions overlap.
template <bool kSpecial>
void cover_pixels(StillTile& tile, const StillBatch& batch, const std::uint32_t* jobs, std::size_t count,
                  const SpecialTriangle* special) {
    const F f;
    constexpr std::size_t kAhead = 6;  // jobs whose samples and hits are fetched from the second-level cache meanwhile
    for (std::size_t j = 0; j < count; ++j) {
        const std::size_t later = jobs[std::min(j + kAhead, count - 1)] & 0xffff, ahead = later * tile.spp;
        hwy::Prefetch(&tile.samples.x[ahead]);
        hwy::Prefetch(&tile.samples.y[ahead]);
        hwy::Prefetch(&tile.depth[tile.entry(ahead, later)]);
        hwy::Prefetch(&tile.triangle[tile.entry(ahead, later)]);
        const int k = static_cast<int>(jobs[j] >> 16);
        const std::size_t pixel = jobs[j] & 0xffff, first = pixel * tile.spp, entry = tile.entry(first, pixel);
        for (std::size_t i = 0; i < tile.spp; i += kWidth)
            cover_lanes<kSpecial>(f, tile, batch, k, first + i, entry + i, special);
    }
    for (std::size_t j = 0; j < count; ++j) {
        const std::size_t pixel = jobs[j] & 0xffff;
        const float* depths = &tile.depth[tile.entry(pixel * tile.spp, pixel)];
        Vec farthest = hn::Load(f, depths);
        for (std::size_t i = kWidth; i < tile.spp; i += kWidth) farthest = hn::Max(farthest, hn::Load(f, depths + i));
        tile.farthest[pixel] = hn::GetLane(hn::MaxOfLanes(f, farthest));
    }
    tile.tested += static_cast<std::int64_t>(count * tile.spp);
}

}  // namespace HWY_NAMESPACE
}  // namespace pentaprism
HWY_AFTER_NAMESPACE();

#endif
