#pragma once
// Shades what a tile's samples see: once for each triangle and pixel, at mid-shutter, at the mean of the barycentrics
// of the samples that see it (McGuire, Enderton, Shirley, Luebke 2010; here the mean instead of their last hit).
// Nothing hidden is ever shaded.

#include <cstdint>
#include <vector>

#include "cover/hits.h"
#include "sample/sample_table.h"
#include "shade/shaded_triangle.h"
#include "shade/shading_scene.h"
#include "shade/tile_shade.h"

namespace pentaprism {

/// Keeps its memory between tiles; one for each thread. Results do not depend on the tile's size nor on what was shaded
/// before.
class TileShader {
  public:
    /// Fills `out`. Returns the number of points shaded.
    std::int64_t shade(const ShadingScene& scene, const SampleTable& samples, const Tile& tile, const Hits& hits,
                       TileShade& out);

  private:
    /// A covered sample: pixel = 16 * (block of the cell) + lane.
    struct Entry {
        std::uint16_t pixel, slot;
    };
    void collect(const SampleTable& samples, const Tile& tile, const Hits& hits, int first_block, int last_block,
                 TileShade& out);
    void sort_by_triangle();
    std::uint32_t local_triangle(std::uint32_t triangle);
    void grow_table();

    LitColor lit_;
    std::vector<Entry> entries_, sorted_;
    std::vector<std::uint32_t> locals_;     // of each entry: the triangle's number in this chunk
    std::vector<std::uint32_t> triangles_;  // of each number
    std::vector<std::uint32_t> counts_;     // of each number; after sorting the end of its run
    std::vector<std::uint32_t> table_;      // open addressing: number + 1, or 0
};

}  // namespace pentaprism
