#pragma once
// The covered samples of a part of a tile, triangle by triangle, and within a triangle pixel by pixel in index order: a
// counting sort, which is stable. That order is the same whatever the tile's size and whoever shades it.

#include <cstdint>
#include <span>
#include <vector>

#include "cover/hits.h"
#include "sample/sample_table.h"
#include "shade/sample_order.h"

namespace pentaprism {

/// Keeps its memory between tiles; one for each thread.
class TileSamples {
  public:
    /// Lists the samples of blocks [first_block, last_block) of the tile's cell.
    void collect(const SampleTable& samples, const Tile& tile, const Hits& hits, int first_block, int last_block);

    /// Triangles in the order in which they were met.
    std::size_t triangle_count() const { return triangles_.size(); }
    std::uint32_t triangle(std::size_t i) const { return triangles_[i]; }
    /// Of the i-th triangle's samples: places in SampleTable::cell() (vector * kLanes + lane), and
    /// pixels, which are 16 * (block of the cell) + lane.
    std::span<const std::uint32_t> places(std::size_t i) const { return run(places_, i); }
    std::span<const std::uint16_t> pixels(std::size_t i) const { return run(pixels_, i); }

    /// Samples that hit nothing, pixel by pixel.
    struct Miss {
        std::uint32_t place;
        std::uint16_t pixel;
    };
    std::span<const Miss> misses() const { return misses_; }

  private:
    struct Entry {
        std::uint32_t place, local;
        std::uint16_t pixel;
    };
    template <class T>
    std::span<const T> run(const std::vector<T>& sorted, std::size_t i) const {
        const std::uint32_t begin = i == 0 ? 0 : counts_[i - 1];
        return std::span(sorted).subspan(begin, counts_[i] - begin);
    }
    void sort();
    std::uint32_t local_triangle(std::uint32_t triangle);
    void grow_table();

    SampleOrder order_;
    std::vector<Entry> entries_;
    std::vector<Miss> misses_;
    std::vector<std::uint32_t> places_;
    std::vector<std::uint16_t> pixels_;
    std::vector<std::uint32_t> triangles_;  // of each local number
    std::vector<std::uint32_t> counts_;     // of each local number; after sorting the end of its run
    std::vector<std::uint32_t> table_;      // open addressing: number + 1, or 0
};

}  // namespace pentaprism
