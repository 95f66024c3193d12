#pragma once
// Tiles from regions of the picture that OpenGL renders at once (gl/pipeline.h), in passes of some samples of each
// pixel; all passes together are the table's samples.

#include <map>
#include <memory>
#include <mutex>

#include "gl/pipeline.h"
#include "gl/rasterizer.h"

namespace pentaprism::gl {

class GlRasterizer : public Rasterizer {
  public:
    GlRasterizer(const Frame& frame, const SampleTable& table, const MethodSettings& method, const PixelRect& limits);
    ~GlRasterizer() override;
    void cover(const Tile& tile, Hits& hits, CoverCounts& counts, CoverMap* map) const override;
    const char* pipeline() const override;

  private:
    Region region_of(int cell_x, int cell_y) const;
    std::shared_ptr<const RegionHits> hits_of(const Region& region, const Tile& tile) const;

    const SampleTable& table_;
    PixelRect limits_;
    Device& device_;
    int first_cell_x_, first_cell_y_, columns_, rows_;  // cells of the limits
    int region_columns_, region_rows_;                  // cells of a region
    mutable std::mutex mutex_;
    mutable std::unique_ptr<Pipeline> pipeline_;
    // By the region's first cell. More than one where threads work far apart; gone when all its pixels were asked for.
    mutable std::map<std::pair<int, int>, std::shared_ptr<RegionHits>> rendered_;
};

}  // namespace pentaprism::gl
