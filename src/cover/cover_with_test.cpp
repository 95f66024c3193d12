#include <algorithm>

#include "cover/cover.h"
#include "cover/exact.h"
#include "frame/opacity.h"

namespace pentaprism {
namespace {

// One pixel: exactly the closed square that holds its samples.
Footprint pixel_footprint(int px, int py, float ratio) {
    constexpr float half = kCellSize / 2;
    const float x = static_cast<float>(px % kCellSize) - half, y = half - static_cast<float>(py % kCellSize);
    return {x, x + 1.0f, y - 1.0f, y, {-1.0f, 1.0f, -ratio, ratio, 0.0f, 1.0f}};
}

std::size_t sample_offset(int px, int py, int slot, int slots) {
    const int block = py % kCellSize / kBlockSize * kCellBlocks + px % kCellSize / kBlockSize;
    const int lane = py % kBlockSize * kBlockSize + px % kBlockSize;
    return (static_cast<std::size_t>(block) * slots + slot) * kLanes + lane;
}

void record(CoverMap& map, int px, int py, bool hit) {
    const std::size_t pixel = static_cast<std::size_t>(py) * map.width + px;
    ++map.tested[pixel];
    map.covered[pixel] += hit;
}

}  // namespace

void cover_with_test(const TileWork& work, const CullTest& test, Hits& hits, CoverCounts& counts) {
    const CellCentre centre = cell_centre(work.frame.view, work.tile.cell_x(), work.tile.cell_y());
    const int spp = work.samples.spp();
    const float ratio = static_cast<float>(work.frame.view.lens.ratio);
    CullState state;
    for (const std::uint32_t entry : work.list) {
        const BinnedTriangle& binned = work.triangles[entry];
        const LocalTriangle triangle = localize(work.frame, binned.triangle, binned.segment, centre);
        const int x1 = std::min<int>(binned.x1, work.tile.x1), y1 = std::min<int>(binned.y1, work.tile.y1);
        for (int py = std::max<int>(binned.y0, work.tile.y0); py < y1; ++py)
            for (int px = std::max<int>(binned.x0, work.tile.x0); px < x1; ++px) {
                ++counts.footprints;
                if (!test.prepare(triangle, pixel_footprint(px, py, ratio), state)) continue;
                ++counts.kept_footprints;
                for (int index = 0; index < spp; ++index) {
                    const LocalSample sample = local_sample(work.samples.sample(px, py, index), px, py);
                    ++counts.asked;
                    if (!test.keeps(state, sample)) continue;
                    ++counts.tested;
                    const SampleHit hit = cover_sample(triangle, sample, centre);
                    if (work.map != nullptr) record(*work.map, px, py, hit.hit);
                    if (!hit.hit) continue;
                    ++counts.covered;
                    const std::size_t s = sample_offset(px, py, work.samples.slot_of(px, py, index), spp);
                    if (!(hit.depth < hits.depth[s])) continue;
                    if (triangle.alpha_tested &&
                        !is_opaque_at(work.frame, triangle.triangle, hit.barycentrics, px, py, index, spp))
                        continue;
                    hits.depth[s] = hit.depth;
                    hits.triangle[s] = triangle.triangle;
                }
            }
    }
}

}  // namespace pentaprism
