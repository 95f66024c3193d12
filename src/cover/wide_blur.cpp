#include "cover/wide_blur.h"

#include <algorithm>
#include <cmath>

namespace pentaprism {
namespace {

// The box of a triangle on the screen in pixels, by what spreads it. Of one at the camera plane: nothing.
struct Spread {
    glm::vec2 size{0}, path{0};  // of the triangle; of its way in the segment
    float radius = 0;            // of the circle of confusion
};

Spread spread_of(const Frame& frame, const BinnedTriangle& binned) {
    const MovingTriangle T = moving_triangle(frame, binned.triangle, binned.segment);
    glm::vec2 least[2], most[2];
    Spread spread;
    for (int end = 0; end < 2; ++end)
        for (int i = 0; i < 3; ++i) {
            const float w = T.w[i][end];
            if (!(w > 0)) return {};
            const glm::vec2 at = glm::vec2(T.x[i][end], T.y[i][end]) / w;
            least[end] = i == 0 ? at : glm::min(least[end], at);
            most[end] = i == 0 ? at : glm::max(most[end], at);
            spread.radius = std::max(spread.radius, std::abs(T.c[i][end]) / w);
        }
    spread.size = 0.5f * (most[0] - least[0] + most[1] - least[1]);
    spread.path = 0.5f * glm::abs(least[1] + most[1] - least[0] - most[0]);
    return spread;
}

// Proportional to the vectors that are listed, if strata are `lens` of the lens and `shutter` of the segment wide:
// those that reach into the tile, each with the blocks of its box that lie there. A box of L pixels a side reaches into
// a tile of T in L + T of its places, and covers then L * T / (L + T) on average; a block comes on top.
float listed(const Spread& s, float block, float lens, float shutter) {
    constexpr float kTile = kCellSize;
    const glm::vec2 box = s.size + shutter * s.path + 2.0f * lens * s.radius;
    const glm::vec2 side = box * kTile + block * (box + kTile);
    return side.x * side.y;
}

}  // namespace

bool blurs_widely(const TileWork& work) {
    const FineLens& fine = work.samples.fine_lens();
    const Tile& tile = work.tile;
    if (fine.empty() || tile.x1 - tile.x0 != kCellSize || tile.y1 - tile.y0 != kCellSize) return false;
    if (tile.blocks != ~std::uint64_t{0}) return false;
    const bool quarters = work.samples.grouping() == Grouping::kBoth;  // of the shutter are apart by themselves
    constexpr std::size_t kAsked = 16;  // triangles: what they say of the others is good enough
    const std::size_t step = std::max<std::size_t>(1, work.list.size() / kAsked);
    float coarse = 0, finer = 0;
    for (std::size_t i = 0; i < work.list.size(); i += step) {
        const BinnedTriangle& binned = work.triangles[work.list[i]];
        const Spread spread = spread_of(work.frame, binned);
        const Part& part = work.frame.parts[work.frame.part_of[binned.triangle]];
        const float segments = part.moves && quarters ? static_cast<float>(part.segments) : 1.0f;
        // Vectors of a quarter are listed for the segments that share time with it, others for each segment. (That
        // segments which a vector crosses are listed together makes no difference that could be measured.)
        const float of_segment = quarters ? std::min(1.0f, 0.25f * segments) : 1.0f;
        const float of_vectors = std::max(0.25f, 1.0f / segments);
        coarse += of_vectors * listed(spread, kBlockSize, 0.25f, of_segment);
        finer += listed(spread, static_cast<float>(fine.block_size()), 0.125f, 1.0f);
    }
    return finer < 0.9f * coarse;
}

}  // namespace pentaprism
