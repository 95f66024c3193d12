#include "gl/gl_rasterizer.h"

#include <algorithm>

namespace pentaprism::gl {
namespace {

// Samples that are kept at once: 8 bytes each here, 24 on the device for those of a pass.
constexpr std::int64_t kMostSamples = 1 << 24;
// Cells of a region: a triangle all over it is in 32768 tiles of gl/tiles.glsl, and loops over those must stay short
// (gl/tile_pass.cpp).
constexpr std::int64_t kMostCells = 2048;

int cells_upto(int pixel) {
    return (pixel + kCellSize - 1) / kCellSize;
}

}  // namespace

GlRasterizer::GlRasterizer(const Frame& frame, const SampleTable& table, const MethodSettings& method,
                           const PixelRect& limits)
    : table_(table),
      limits_(limits),
      device_(Device::get()),
      first_cell_x_(limits.x0 / kCellSize),
      first_cell_y_(limits.y0 / kCellSize),
      columns_(cells_upto(limits.x1) - first_cell_x_),
      rows_(cells_upto(limits.y1) - first_cell_y_) {
    const std::int64_t samples = std::min(kMostSamples, device_.most_entries());
    const int cells =
        static_cast<int>(std::clamp<std::int64_t>(samples / (kCellSize * kCellSize * table.slots()), 1, kMostCells));
    const int side = device_.max_size() / kCellSize;
    region_columns_ = std::min({columns_, cells, side});
    region_rows_ = std::clamp(cells / region_columns_, 1, std::min(rows_, side));
    const Device::Current current(device_);
    pipeline_ =
        std::make_unique<Pipeline>(device_, frame, table, method, Region{0, 0, region_columns_, region_rows_, {}});
}

GlRasterizer::~GlRasterizer() {
    try {
        const Device::Current current(device_);
        pipeline_.reset();
    } catch (const std::exception&) {
        pipeline_.release();  // the context is gone, and with it all that it held
    }
}

Region GlRasterizer::region_of(int cell_x, int cell_y) const {
    const int x = (cell_x - first_cell_x_) / region_columns_ * region_columns_,
              y = (cell_y - first_cell_y_) / region_rows_ * region_rows_;
    Region region{first_cell_x_ + x,
                  first_cell_y_ + y,
                  std::min(region_columns_, columns_ - x),
                  std::min(region_rows_, rows_ - y),
                  {}};
    region.pixels = {std::max(limits_.x0, region.cell_x * kCellSize),
                     std::min(limits_.x1, (region.cell_x + region.cell_columns) * kCellSize),
                     std::max(limits_.y0, region.cell_y * kCellSize),
                     std::min(limits_.y1, (region.cell_y + region.cell_rows) * kCellSize)};
    return region;
}

std::shared_ptr<const RegionHits> GlRasterizer::hits_of(const Region& region, const Tile& tile) const {
    const std::pair key(region.cell_x, region.cell_y);
    const std::lock_guard<std::mutex> lock(mutex_);
    std::shared_ptr<RegionHits>& hits = rendered_[key];
    if (!hits) {
        const Device::Current current(device_);
        hits = std::make_shared<RegionHits>(pipeline_->render(region));
        hits->pixels_left = std::int64_t{region.width()} * region.height();
    }
    const std::shared_ptr<const RegionHits> kept = hits;
    hits->pixels_left -=
        std::int64_t{tile.x1 - std::max(tile.x0, limits_.x0)} * (tile.y1 - std::max(tile.y0, limits_.y0));
    if (hits->pixels_left <= 0) rendered_.erase(key);
    return kept;
}

const char* GlRasterizer::pipeline() const {
    return pipeline_->takes_compute() ? "compute" : "geometry";
}

void GlRasterizer::cover(const Tile& tile, Hits& hits, CoverCounts& counts, CoverMap* map) const {
    const Region region = region_of(tile.cell_x(), tile.cell_y());
    const std::shared_ptr<const RegionHits> found = hits_of(region, tile);
    const int slots = table_.slots();
    const std::size_t cell =
        static_cast<std::size_t>(tile.cell_y() - region.cell_y) * region.cell_columns + (tile.cell_x() - region.cell_x);
    for (int py = std::max(tile.y0, limits_.y0); py < tile.y1; ++py)
        for (int px = std::max(tile.x0, limits_.x0); px < tile.x1; ++px) {
            const int block = py % kCellSize / kBlockSize * kCellBlocks + px % kCellSize / kBlockSize;
            const std::size_t lane = py % kBlockSize * kBlockSize + px % kBlockSize;
            const std::size_t to = static_cast<std::size_t>(block) * slots * kLanes + lane,
                              from = cell * kBlocksPerCell * slots * kLanes + to;
            for (std::size_t s = 0; s < static_cast<std::size_t>(slots) * kLanes; s += kLanes) {
                hits.depth[to + s] = found->depth[from + s];
                hits.triangle[to + s] = found->triangle[from + s];
            }
            const std::size_t place =
                static_cast<std::size_t>(py - region.pixels.y0) * region.width() + (px - region.pixels.x0);
            counts.tested += found->tested[place];
            counts.covered += found->covered[place];
            if (map == nullptr) continue;
            const std::size_t pixel = static_cast<std::size_t>(py) * map->width + px;
            map->tested[pixel] += found->tested[place];
            map->covered[pixel] += found->covered[place];
        }
}

}  // namespace pentaprism::gl
