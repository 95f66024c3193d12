#pragma once
// Tiles from regions of the picture that OpenGL renders at once (gl/pipeline.h), in passes of some samples of each
// pixel; all passes together are the table's samples.

#include <map>
#include <memory>
#include <mutex>
#include <optional>

#include "gl/pipeline.h"
#include "gl/rasterizer.h"
#include "gl/shading.h"

namespace pentaprism::gl {

class GlRasterizer : public Rasterizer {
  public:
    GlRasterizer(const Frame& frame, const SampleTable& table, const MethodSettings& method, const PixelRect& limits);
    ~GlRasterizer() override;
    void cover(const Tile& tile, Hits& hits, CoverCounts& counts, CoverMap* map) const override;
    void shade_with(const ShadingScene& scene) override;
    std::int64_t shade(const Tile& tile, const Hits& hits, TileShade& out) const override;
    const char* pipeline() const override;

  private:
    Region region_of(int cell_x, int cell_y) const;
    struct Rendered {
        RegionHits hits;
        std::optional<RegionShade> shade;
        std::int64_t uses_left = 0;  ///< of each of its pixels, how often it will be asked for
    };
    std::shared_ptr<const Rendered> covered(const Region& region, const Tile& tile) const;
    std::shared_ptr<const Rendered> shaded(const Region& region, const Tile& tile) const;
    void count_use(std::pair<int, int> key, const Tile& tile) const;
    void plan_regions(std::int64_t samples);

    const SampleTable& table_;
    PixelRect limits_;
    Device& device_;
    int first_cell_x_, first_cell_y_, columns_, rows_;  // cells of the limits
    int region_columns_, region_rows_;                  // cells of a region
    mutable std::mutex mutex_;
    const Frame& frame_;
    MethodSettings method_;
    mutable std::unique_ptr<Pipeline> pipeline_;
    mutable std::unique_ptr<Shading> shading_;
    // By the region's first cell. More than one where threads work far apart; gone when all its pixels were asked for.
    mutable std::map<std::pair<int, int>, std::shared_ptr<Rendered>> rendered_;
};

}  // namespace pentaprism::gl
