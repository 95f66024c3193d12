#pragma once
// The visibility buffer of one tile: for each sample the nearest triangle and its depth.

#include <algorithm>
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
    std::uint64_t blocks = ~std::uint64_t{0};  ///< of the cell, bit 8 * row + column: of those in the tile, the wanted
    int cell_x() const { return x0 / kCellSize; }
    int cell_y() const { return y0 / kCellSize; }
    /// Block (bx, by) of the picture, which lies in the tile.
    bool wants(int bx, int by) const { return blocks >> (by % kCellBlocks * kCellBlocks + bx % kCellBlocks) & 1u; }
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
    /// The same for some blocks; entries of others, and beyond the last, have no meaning.
    void reset(int slots, std::uint64_t blocks) {
        if (blocks == ~std::uint64_t{0}) return reset(slots);
        const std::size_t per_block = static_cast<std::size_t>(slots) * kLanes, n = kBlocksPerCell * per_block;
        if (triangle.size() < n) return reset(slots);
        for (std::size_t block = 0; block < kBlocksPerCell; ++block) {
            if (!(blocks >> block & 1u)) continue;
            std::fill_n(depth.begin() + block * per_block, per_block, std::numeric_limits<float>::infinity());
            std::fill_n(triangle.begin() + block * per_block, per_block, kNoTriangle);
        }
    }
};

}  // namespace pentaprism
