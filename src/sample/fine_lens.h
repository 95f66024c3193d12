#pragma once
// The samples of a table once more, for circles of confusion of tens of pixels. There a vector that shares a quarter by
// a quarter of the lens among 4x4 pixels is spread wide by the lens; one that shares an eighth by an eighth is not, for
// which its sixteen samples come from 8x8 pixels (from 64 samples per pixel on, from 4x4).

#include <cstdint>
#include <span>
#include <vector>

#include "sample/sample_vector.h"

namespace pentaprism {

class FineLens {
  public:
    /// Cells of the lens a side.
    static constexpr int kSide = 8;

    FineLens() = default;

    /// `vectors`: of some cells, [(cell * kBlocksPerCell + block) * spp + slot]; `lens_cells`: kSide * row + column of
    /// each of their samples' cell of the lens, in the same order with lanes within vectors. Stays empty where samples
    /// do not fill vectors evenly (patterns other than ours, and counts that are no multiple of 16) and where there are
    /// more than 256 for each pixel. Costs 24 bytes a sample.
    FineLens(int spp, std::span<const SampleVector> vectors, std::span<const std::uint8_t> lens_cells);

    bool empty() const { return vectors_.empty(); }
    int block_size() const { return block_size_; }  ///< pixels a side, 4 or 8
    int slots() const { return slots_; }            ///< vectors of a block

    /// Vectors of the cell: [slot * blocks + block], blocks row by row. Their lanes are of any pixels of the block.
    std::span<const SampleVector> cell(std::size_t cell) const;

    /// Of each lane of these its place in SampleTable::cell(): vector * kLanes + lane.
    std::span<const std::uint32_t> places(std::size_t cell) const;

    /// As SampleTable has them; bit 8 * row + column of Stratum::blocks for blocks of either size. The same in all
    /// cells.
    std::span<const Domain> domains() const { return domains_; }
    std::span<const Stratum> strata() const { return strata_; }

  private:
    int block_size_ = kBlockSize, slots_ = 0;
    std::size_t vectors_per_cell_ = 0;
    std::vector<SampleVector> vectors_;
    std::vector<std::uint32_t> places_;
    std::vector<Domain> domains_;
    std::vector<Stratum> strata_;
};

}  // namespace pentaprism
