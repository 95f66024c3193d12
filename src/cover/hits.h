#pragma once
// The visibility buffer of one tile: for each sample the nearest triangle and its depth.

#include <cstdint>
#include <limits>

#include "base/aligned.h"
#include "sample/sample_table.h"

namespace pentaprism {

inline constexpr std::uint32_t kNoTriangle = 0xffffffffu;

/// Pixels [x0, x1) x [y0, y1) of the picture; x0, y0 are multiples of the tile size, so of kBlockSize, and a tile lies
/// in one cell. x1, y1 may cut through a block at the picture's border: lanes outside hold no hits.
struct Tile {
    int x0, y0, x1, y1;
    int cell_x() const { return x0 / kCellSize; }
    int cell_y() const { return y0 / kCellSize; }
};

/// A whole cell's worth of samples, whatever the tile size: entry (block * slots + slot) * kLanes + lane, where block =
/// 8 * (row in the cell) + column. depth is +infinity and triangle kNoTriangle where nothing is hit.
struct Hits {
    AlignedVector<float> depth;
    AlignedVector<std::uint32_t> triangle;
    void reset(int slots) {
        const std::size_t n = static_cast<std::size_t>(kBlocksPerCell) * slots * kLanes;
        depth.assign(n, std::numeric_limits<float>::infinity());
        triangle.assign(n, kNoTriangle);
    }
};

}  // namespace pentaprism
