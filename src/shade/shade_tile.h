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

/// Where a point's colours are in TileShade::colors: one for each quarter of the shutter in which it is seen.
struct QuarterColors {
    static constexpr int kQuarters = ShadowMap::kSamples;
    std::uint32_t color[kQuarters] = {kBackground, kBackground, kBackground, kBackground};

    /// Makes the place when first asked.
    std::uint32_t at(int quarter, TileShade& out) {
        if (color[quarter] == kBackground) {
            color[quarter] = static_cast<std::uint32_t>(out.colors.size());
            out.colors.emplace_back();
        }
        return color[quarter];
    }
};

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
    class LocalRun;
    class CellSamples;
    /// A cell of the triangle in hand, and the side from which it is seen.
    struct SharedCell {
        ShadingCell cell;
        bool alone, front;
        glm::vec3 barycentrics;  ///< of the sample, if it is alone
        QuarterColors colors;
    };
    template <class Points>
    void light_quarters(const ShadingScene& scene, const QuarterColors& colors, std::uint32_t triangle,
                        std::uint32_t seed, const Points& write_points, TileShade& out);
    void shade_cells(const ShadingScene& scene, const CellSamples& samples, const ShadedTriangle& shaded, LocalRun& run,
                     std::uint32_t begin, std::uint32_t end, int slots, TileShade& out);
    void collect(const ShadingScene& scene, const SampleTable& samples, const Tile& tile, const Hits& hits,
                 int first_block, int last_block, TileShade& out);
    void shade_background(const ShadingScene& scene, const SampleTable& samples, const Tile& tile, TileShade& out);
    void sort_by_triangle();
    std::uint32_t local_triangle(std::uint32_t triangle);
    void grow_table();

    LitColor lit_;
    std::int64_t shaded_ = 0;
    std::size_t locals_of_run_ = 0;
    std::vector<SharedCell> cells_;
    std::vector<std::uint32_t> cell_table_;  // open addressing: index into cells_ + 1, or 0
    std::vector<Entry> entries_, sorted_, misses_;
    std::vector<std::uint32_t> locals_;     // of each entry: the triangle's number in this chunk
    std::vector<std::uint32_t> triangles_;  // of each number
    std::vector<std::uint32_t> counts_;     // of each number; after sorting the end of its run
    std::vector<std::uint32_t> table_;      // open addressing: number + 1, or 0
};

}  // namespace pentaprism
