#include "cover/cover.h"
#include "cover/scalar_walk.h"
#include "frame/opacity.h"

namespace pentaprism {

void cover_with_test(const TileWork& work, const Culling& culling, Hits& hits, CoverCounts& counts) {
    auto keep_nearest = [&](const LocalTriangle& triangle, const SampleHit& hit, const SamplePlace& at) {
        float& depth = hits.depth[at.index];
        std::uint32_t& nearest = hits.triangle[at.index];
        if (!(hit.depth < depth || (hit.depth == depth && triangle.triangle < nearest))) return false;
        if (triangle.alpha_tested) {
            const int bx = at.px / kBlockSize, by = at.py / kBlockSize;
            const int index = work.samples.indices(bx, by)[at.slot * kLanes + at.lane];
            if (!is_opaque_at(work.frame, triangle.triangle, hit.barycentrics, at.px, at.py, index, work.samples))
                return false;
        }
        depth = hit.depth;
        nearest = triangle.triangle;
        return true;
    };
    ScalarWalk(work, culling, hits, counts, keep_nearest).cover_all();
}

void cover_with_test(const TileWork& work, const CullTest& test, Hits& hits, CoverCounts& counts) {
    cover_with_test(work, {{&test, test.grain}}, hits, counts);
}

}  // namespace pentaprism
