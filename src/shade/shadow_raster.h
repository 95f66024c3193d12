#pragma once
// Depths of a cell of a shadow map: the exact test of cover/exact.h with the lens closed, at all samples of the texels
// that a triangle's box holds, sixteen at a time; in large boxes only along the triangle (shadow_setup-inl.h).
//
// The camera's coverage stage (cover/cover_vectors.cpp) pays for bounds over lens and shutter, for work lists and depth
// hierarchies. Here most triangles are about a texel, and testing the few samples around them costs less than knowing
// which to leave out.

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "sample/sample_table.h"
#include "shade/casters.h"

namespace pentaprism {

/// Where and when a map's samples lie: four in each texel, one in each quarter of the shutter: those of SampleTable in
/// another order, moved to the middle of one of 4096 x 4096 parts of the texel and of 256 of the quarter. Index in a
/// cell: (row * kCellSize + column) * kSamples + quarter.
class ShadowSamples {
  public:
    static constexpr int kSamples = 4, kPerCell = kCellSize * kCellSize * kSamples;
    struct alignas(64) Cell {
        float x[kPerCell], y[kPerCell], t[kPerCell];  ///< texels from the cell's middle, y up; t in [0, 1)
    };
    /// The same in one word: from the lowest bit, the part of the texel rightwards and upwards, and of the quarter.
    static constexpr int kPlaceBits = 12, kTimeBits = 8;
    static constexpr int kPeriod = 4;  ///< cells, both ways, of the table of all cells
    explicit ShadowSamples(std::uint32_t seed);
    const Cell& cell(int cx, int cy) const { return cells_[index_of(cx, cy)]; }
    const SampleTable& table() const { return table_; }
    std::uint32_t seed() const { return seed_; }
    /// The cells that there are; which of them serves a place: index_of().
    std::span<const Cell> cells() const { return {cells_.get(), kPeriod * kPeriod}; }
    std::size_t index_of(int cx, int cy) const;
    const std::int32_t* words(int cx, int cy) const { return &words_[index_of(cx, cy) * kPerCell]; }
    /// The part of the quarter alone, of which many are asked for each that is used: [index_of()][index in the cell].
    /// Three more may be read.
    const std::uint8_t* times() const { return times_.data(); }

  private:
    std::uint32_t seed_;
    SampleTable table_;
    std::unique_ptr<Cell[]> cells_;
    std::vector<std::int32_t> words_;
    std::vector<std::uint8_t> times_;
};

/// A cell of a level and what may be seen in it.
struct ShadowCellWork {
    const Casters& casters;
    std::span<const std::uint32_t> list;  ///< numbers of boxes, in any order
    const ShadowSamples& samples;
    int cx, cy, width;  ///< the cell, and how many texels the level spans
    float scale;        ///< texels a unit of the casters' x and y; a power of two
};

/// Writes the depth of what is nearest at each of the cell's samples, and the depth beyond which points that ask the
/// sample lie in its shadow: where the triangle's own plane may be at such a point, beside the sample, but no deeper
/// than the triangle. Infinity where nothing is. kPerCell of each, on a cache line. The same bits on every CPU target.
using DrawShadowCell = void (*)(const ShadowCellWork& work, float* depths, float* bounds);
DrawShadowCell draw_shadow_cell();

}  // namespace pentaprism
