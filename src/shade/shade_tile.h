#pragma once
// Shades what a tile's samples see, at mid-shutter: once for each cell of a triangle that holds samples, for each
// triangle and pixel at the mean of the barycentrics of the samples that see it (McGuire, Enderton, Shirley, Luebke
// 2010; here the mean instead of their last hit), or for each sample. Nothing hidden is ever shaded.

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "cover/hits.h"
#include "sample/sample_table.h"
#include "shade/seen_samples.h"
#include "shade/shaded_triangle.h"
#include "shade/shading_scene.h"
#include "shade/tile_samples.h"
#include "shade/tile_shade.h"
#include "shade/waiting_points.h"

namespace pentaprism {

/// Keeps its memory between tiles; one for each thread. Results do not depend on the tile's size nor on what was shaded
/// before.
class TileShader {
  public:
    /// Fills `out`. Returns the number of points shaded. `roughly`: for little more than a guess of what pixels see,
    /// the least cells are blocks and not pixels (where the rate asks for cells).
    std::int64_t shade(const ShadingScene& scene, const SampleTable& samples, const Tile& tile, const Hits& hits,
                       TileShade& out, bool roughly = false);

    /// Adds the colours of misses alone, for tiles whose surfaces were shaded elsewhere. Nothing if there are no
    /// surroundings.
    void shade_misses(const ShadingScene& scene, const SampleTable& samples, const Tile& tile, const Hits& hits,
                      TileShade& out);

  private:
    /// The samples of one triangle.
    struct Run {
        const ShadedTriangle& triangle;
        std::uint32_t number;
        SampleRun samples;
    };
    /// Samples in another order than that of TileSamples.
    struct Reordered {
        std::vector<std::uint32_t> order, places;
        std::vector<Float4> xyuv;
        std::vector<float> t;
    };
    /// A cell of the triangle in hand, and the side from which it is seen.
    struct SharedCell {
        CellKey key;
        std::size_t first;  ///< the sample that was first to see it
        QuarterColors colors;
    };
    void start(const SampleTable& samples, const Hits& hits);
    /// Of a sample its block, by its place (TileSamples), without a division.
    std::uint32_t block_of(std::uint32_t place) const {
        return static_cast<std::uint32_t>(place * reciprocal_ >> kReciprocalBits);
    }
    /// The same: its entry in Hits.
    std::uint32_t entry(std::uint32_t place) const { return place - skipped_[block_of(place)]; }
    SampleRun by_pixel(const SampleRun& samples, std::span<const std::uint16_t> indices);
    void shade_pixels(const Run& run, const Tile& tile, TileShade& out);
    void find_cells(const Run& run, TileShade& out);
    void shade_cells(const Run& run, TileShade& out);
    WaitingPoint& add_point(const Run& run, const glm::vec3& barycentrics, bool front, const ShadingCell& cell,
                            TileShade& out);
    void shade_background(const SampleVector* samples, const Tile& tile, TileShade& out);
    int quarter_of(float t) const {
        const int quarter = static_cast<int>(t * QuarterColors::kQuarters);
        return by_quarters_ ? std::min(quarter, QuarterColors::kQuarters - 1) : 0;
    }

    const ShadingScene* scene_ = nullptr;
    bool by_quarters_ = false;     // colours change while the shutter is open
    std::uint32_t per_block_ = 0;  // samples of a block
    // Places are below 2^22, and blocks of 2^4 to 2^16 samples: the quotient is exact.
    static constexpr int kReciprocalBits = 42;
    std::uint64_t reciprocal_ = 0;                         // 2^42 / per_block_, rounded up
    std::array<std::uint32_t, kBlocksPerCell> skipped_{};  // samples of the cell before each block without an entry
    WaitingPoints waiting_;
    TileSamples samples_;
    SeenSamples seen_;
    std::int64_t shaded_ = 0;
    std::vector<SampleVector> room_;
    Reordered by_pixel_;
    std::vector<SharedCell> cells_;
    std::vector<std::uint32_t> cell_table_;  // open addressing: index into cells_ + 1, or 0
};

}  // namespace pentaprism
