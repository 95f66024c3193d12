#pragma once
// The samples of a part of a tile, triangle by triangle, and within a triangle in the order of Hits, where neighbours
// are near each other in memory and in time: a counting sort, which is stable. Where nothing blurs, block by block and
// pixel by pixel.

#include <cstdint>
#include <span>
#include <vector>

#include "cover/hits.h"
#include "sample/sample_table.h"

namespace pentaprism {

/// Keeps its memory between tiles; one for each thread.
class TileSamples {
  public:
    /// Lists the samples of blocks [first_block, last_block) of the tile's cell.
    void collect(const SampleTable& samples, const Tile& tile, const Hits& hits, int first_block, int last_block);

    /// Triangles in the order in which they were met.
    std::size_t triangle_count() const { return triangles_.size(); }
    std::uint32_t triangle(std::size_t i) const { return triangles_[i]; }
    /// Whether they come pixel by pixel in index order, as where nothing blurs: slots are indices there.
    static bool is_by_pixel(const SampleTable& samples) { return samples.grouping() == Grouping::kStill; }

    /// Places in SampleTable::cell(), vector * kLanes + lane, of the i-th triangle's samples.
    std::span<const std::uint32_t> places(std::size_t i) const {
        const std::uint32_t begin = i == 0 ? 0 : counts_[i - 1];
        return std::span(places_).subspan(begin, counts_[i] - begin);
    }

    /// Places of samples that hit nothing, block by block.
    std::span<const std::uint32_t> misses() const { return misses_; }

  private:
    struct Entry {
        std::uint32_t place, local;
    };
    void sort();
    std::uint32_t local_triangle(std::uint32_t triangle);
    void grow_table();

    std::vector<Entry> entries_;
    std::vector<std::uint32_t> misses_, places_;
    std::vector<std::uint32_t> triangles_;  // of each local number
    std::vector<std::uint32_t> counts_;     // of each local number; after sorting the end of its run
    std::vector<std::uint32_t> table_;      // open addressing: number + 1, or 0
};

}  // namespace pentaprism
