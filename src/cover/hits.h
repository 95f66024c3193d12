#pragma once
// The visibility buffer of one tile: for each sample the nearest triangle and its depth.

#include <array>
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
    /// Of the cell, as `blocks`: those that lie in the tile and are wanted.
    std::uint64_t wanted_blocks() const {
        std::uint64_t wanted = 0;
        for (int by = y0 / kBlockSize; by * kBlockSize < y1; ++by)
            for (int bx = x0 / kBlockSize; bx * kBlockSize < x1; ++bx)
                wanted |= std::uint64_t{1} << (by % kCellBlocks * kCellBlocks + bx % kCellBlocks);
        return wanted & blocks;
    }
};

/// The samples of the tile's wanted blocks, one block after the other: entry first(block) + slot * kLanes + lane, where
/// block = 8 * (row in the cell) + column. Samples of other blocks have no entry, so that a small tile takes little
/// memory; those of a whole cell are in the order of SampleTable::cell(). depth is +infinity and triangle kNoTriangle
/// where nothing is hit.
struct Hits {
    AlignedVector<float> depth;
    AlignedVector<std::uint32_t> triangle;

    /// Makes entries for the tile, in which nothing is hit.
    void reset(int slots, const Tile& tile) {
        const std::uint64_t wanted = tile.wanted_blocks();
        const std::uint32_t of_block = static_cast<std::uint32_t>(slots) * kLanes;
        std::uint32_t end = 0;
        for (int block = 0; block < kBlocksPerCell; ++block) {
            const bool has = (wanted >> block & 1u) != 0;
            first_[block] = has ? end : kNoEntry;
            end += has ? of_block : 0;
        }
        depth.assign(end, std::numeric_limits<float>::infinity());
        triangle.assign(end, kNoTriangle);
    }
    /// Entry of the first sample of a block.
    std::uint32_t first(int block) const { return first_[block]; }
    /// Of block (bx, by) of the picture.
    std::uint32_t first(int bx, int by) const { return first(by % kCellBlocks * kCellBlocks + bx % kCellBlocks); }
    /// Entry of a sample of pixel (px, py) of the picture.
    std::size_t entry(int px, int py, int slot) const {
        const int lane = py % kBlockSize * kBlockSize + px % kBlockSize;
        return first(px / kBlockSize, py / kBlockSize) + static_cast<std::size_t>(slot) * kLanes + lane;
    }

  private:
    static constexpr std::uint32_t kNoEntry = 0xffffffffu;
    std::array<std::uint32_t, kBlocksPerCell> first_{};  // [block]
};

}  // namespace pentaprism
