// hierarchical: the tile is halved until it is a block of 4x4 pixels, and what of lens and shutter can hit shrinks on
// the way.
//
// After Munkberg, Clarberg, Hasselgren, Toth, Sugihara, Akenine-Moller 2011, Hierarchical Stochastic Motion Blur
// Rasterization: a tile that the moving triangle touches only during a part of the shutter hands that part on to its
// children. The original moves boxes and edges against the tile's planes; we use the corner values of
// docs/develop/algorithms.md 4.1 and the intervals of 4.4, which also know the lens, and take the bounds again on the
// narrowed domain at each level (4.10). Each level only drops what cannot hit, so the whole is conservative. As in the
// original, a square is also refused if the triangle is behind all that it shows in the part of the shutter that is
// left: its depth is then the least of the triangle's in that part (cull/occluders.h).
//
// begin() walks the hierarchy once for the cell and leaves each block's domain; a footprint takes the hull of its
// blocks' domains and the bilinear bounds of 4.5 on it.

#include <cstdint>

#include "cull/cull_intervals.h"

namespace pentaprism {
namespace {

struct Setup {
    SegmentDomain blocks[kBlocksPerCell];  // empty: the block is refused
};
struct State {
    Intervals intervals;
    Slices slices;
};

constexpr SegmentDomain kNothing{1, -1, 1, -1, 1, -1};

// All that samples see of the triangle in that part of its segment is farther away than what the square shows. A hit's
// depth is a mean of the corners' w; rounding may put it a few ulps in front of the nearest.
bool is_hidden(const LocalTriangle& T, int bx, int by, int size, const SegmentDomain& domain, const Occluders& shown) {
    if (T.orthographic) return false;  // w says nothing about depth
    constexpr double kMargin = 1.0 - 16.0 * kUnitRoundoff;
    constexpr float kOut = 1e-6f;  // rounding of a sample's s
    double nearest = INFINITY;
    for (int i = 0; i < 3; ++i)
        for (const float s : {domain.s0, domain.s1})
            nearest = std::min(nearest, double{T.qw[i]} + double{s} * double{T.dw[i]});
    const float t0 = (domain.s0 + T.segment) / T.segments, t1 = (domain.s1 + T.segment) / T.segments;
    return nearest * kMargin > double{shown.farthest(bx, by, size, t0 - kOut, t1 + kOut)};
}

// The square of blocks [bx, bx + size) x [by, by + size), y up as the coordinates.
bool visit(const LocalTriangle& T, int bx, int by, int size, SegmentDomain domain, const Domain& whole,
           CullSetup& setup) {
    constexpr float kHalf = kCellSize / 2;
    const auto place = [](int block) { return static_cast<float>(block * kBlockSize) - kHalf; };
    const Footprint square{place(bx), place(bx + size), place(by), place(by + size), whole};
    if (!narrow_domain(T, square, domain)) return false;
    if (setup.occluders != nullptr && is_hidden(T, bx, by, size, domain, *setup.occluders)) return false;
    if (size == 1) {
        setup.as<Setup>().blocks[by * kCellBlocks + bx] = domain;
        return true;
    }
    const int half = size / 2;
    bool any = false;
    for (int child = 0; child < 4; ++child)
        any |= visit(T, bx + child % 2 * half, by + child / 2 * half, half, domain, whole, setup);
    return any;
}

bool begin(const LocalTriangle& T, const Footprint& picture, CullSetup& setup) {
    std::fill_n(setup.as<Setup>().blocks, kBlocksPerCell, kNothing);
    return visit(T, 0, 0, kCellBlocks, segment_domain(T, picture.domain), picture.domain, setup);
}

// The blocks that [low, high] touches: at least one.
void block_range(float low, float high, int& first, int& last) {
    constexpr float kHalf = kCellSize / 2, kPer = 1.0f / kBlockSize;
    first = std::clamp(static_cast<int>(std::floor((low + kHalf) * kPer)), 0, kCellBlocks - 1);
    last = std::clamp(static_cast<int>(std::ceil((high + kHalf) * kPer)) - 1, first, kCellBlocks - 1);
}

bool prepare(const LocalTriangle& T, const Footprint& footprint, CullState& memory) {
    const Setup& setup = memory.setup->as<Setup>();
    int x0, x1, y0, y1;
    block_range(footprint.x0, footprint.x1, x0, x1);
    block_range(footprint.y0, footprint.y1, y0, y1);
    SegmentDomain domain = kNothing;
    for (int by = y0; by <= y1; ++by)
        for (int bx = x0; bx <= x1; ++bx) {
            const SegmentDomain& d = setup.blocks[by * kCellBlocks + bx];
            if (d.empty()) continue;
            domain = {std::min(domain.u0, d.u0), std::max(domain.u1, d.u1), std::min(domain.v0, d.v0),
                      std::max(domain.v1, d.v1), std::min(domain.s0, d.s0), std::max(domain.s1, d.s1)};
        }
    const SegmentDomain own = segment_domain(T, footprint.domain);
    domain = {std::max(domain.u0, own.u0), std::min(domain.u1, own.u1), std::max(domain.v0, own.v0),
              std::min(domain.v1, own.v1), std::max(domain.s0, own.s0), std::min(domain.s1, own.s1)};
    if (domain.empty()) return false;
    Axis x, y;
    axes_at_ends(T, domain.s0, domain.s1, x, y);
    const CornerBounds cx = corner_bounds(x, x_range(footprint, domain)),
                       cy = corner_bounds(y, y_range(footprint, domain));
    if (cx.refused() || cy.refused()) return false;
    State& state = memory.as<State>();
    state.intervals = {domain, segment_time(T)};
    state.slices = Slices(T, domain, cx, cy);
    return true;
}

bool keeps(const CullState& memory, const LocalSample& sample) {
    const State& state = memory.as<State>();
    return state.intervals.keep(sample) && state.slices.keep(sample);
}

}  // namespace

extern const CullTest hierarchical_test;
const CullTest hierarchical_test{"hierarchical", "after Munkberg et al. 2011, Hierarchical Stochastic Motion Blur",
                                 prepare,        keeps,
                                 Grain::kPixel,  begin,
                                 true,           true};

}  // namespace pentaprism
