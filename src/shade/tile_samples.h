#pragma once
// The samples of a part of a tile, triangle by triangle, and within a triangle in the order of Hits, where neighbours
// are near each other in memory and in time: a counting sort, which is stable. Where nothing blurs, block by block and
// pixel by pixel.

#include <cstdint>
#include <span>
#include <vector>

#include "base/float4.h"
#include "cover/hits.h"
#include "sample/sample_table.h"

namespace pentaprism {

/// Samples side by side. Those of the others follow in memory: whole vectors of kLanes may be read anywhere.
struct SampleRun {
    std::span<const std::uint32_t> places;  ///< in SampleTable::cell(): vector * kLanes + lane
    const Float4* xyuv;                     ///< of each, as in SampleVector
    const float* t;
};

/// Keeps its memory between tiles; one for each thread.
class TileSamples {
  public:
    /// Lists the samples of blocks [first_block, last_block) of the tile's cell, whose samples are `vectors`.
    void collect(const SampleTable& samples, const SampleVector* vectors, const Tile& tile, const Hits& hits,
                 int first_block, int last_block);

    /// Triangles in the order in which they were met.
    std::size_t triangle_count() const { return triangles_.size() - 1; }
    std::uint32_t triangle(std::size_t i) const { return triangles_[i + 1]; }
    /// Whether they come pixel by pixel in index order, as where nothing blurs: slots are indices there.
    static bool is_by_pixel(const SampleTable& samples) { return samples.grouping() == Grouping::kStill; }

    /// The i-th triangle's samples.
    SampleRun samples(std::size_t i) const {
        const std::uint32_t begin = ends_[i];
        return {std::span(places_).subspan(begin, ends_[i + 1] - begin), &xyuv_[begin], &t_[begin]};
    }

    /// Places of samples that hit nothing, block by block.
    std::span<const std::uint32_t> misses() const { return std::span(places_).first(ends_[0]); }

  private:
    struct Known {
        std::uint32_t triangle = kNoTriangle, local = 0;
    };
    void find_triangles(const std::uint32_t* triangles, std::uint32_t* locals);
    void sort_vectors(std::uint32_t first, const std::uint32_t* locals, const SampleVector* vectors);
    void sort_pixels(std::uint32_t first, const std::uint32_t* locals, const SampleVector* vectors);
    std::uint32_t local_triangle(std::uint32_t triangle);
    std::uint32_t add(std::uint32_t triangle);
    std::size_t first_try(std::uint32_t triangle) const { return (triangle * 0x9e3779b1u >> 7) & (table_.size() - 1); }

    std::uint32_t per_block_ = 0;        // samples of a block
    std::vector<std::uint32_t> blocks_;  // place of each block's first sample
    std::vector<std::uint32_t> locals_;  // of each sample, block by block
    std::vector<std::uint32_t> places_;  // what follows: triangle by triangle
    std::vector<Float4> xyuv_;
    std::vector<float> t_;
    std::vector<std::uint32_t> triangles_;  // of each local number; what hits nothing is number 0
    std::vector<std::uint32_t> ends_;       // of each local number's run; while they are counted their number
    std::vector<Known> table_;              // open addressing; where there is none yet, kNoTriangle and its number
};

}  // namespace pentaprism
