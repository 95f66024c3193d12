#include "gl/gl_rasterizer.h"

#include <algorithm>

namespace pentaprism::gl {
namespace {

// Samples that are kept at once: 8 bytes each here, 24 on the device for those of a pass.
constexpr std::int64_t kMostSamples = 1 << 24;
// The same where they are shaded, too: then a sample may take 70 bytes more.
constexpr std::int64_t kMostShadedSamples = 1 << 22;
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
      rows_(cells_upto(limits.y1) - first_cell_y_),
      frame_(frame),
      method_(method) {
    plan_regions(kMostSamples);
}

void GlRasterizer::plan_regions(std::int64_t samples) {
    samples = std::min(samples, device_.most_entries());
    const int cells =
        static_cast<int>(std::clamp<std::int64_t>(samples / (kCellSize * kCellSize * table_.slots()), 1, kMostCells));
    const int side = device_.max_size() / kCellSize;
    region_columns_ = std::min({columns_, cells, side});
    region_rows_ = std::clamp(cells / region_columns_, 1, std::min(rows_, side));
    const Device::Current current(device_);
    pipeline_.reset();
    pipeline_ =
        std::make_unique<Pipeline>(device_, frame_, table_, method_, Region{0, 0, region_columns_, region_rows_, {}});
}

void GlRasterizer::shade_with(const ShadingScene& scene) {
    if (std::int64_t{region_columns_} * region_rows_ * kCellSize * kCellSize * table_.slots() > kMostShadedSamples)
        plan_regions(kMostShadedSamples);
    const Device::Current current(device_);
    shading_ = std::make_unique<Shading>(device_, scene, table_);
}

GlRasterizer::~GlRasterizer() {
    try {
        const Device::Current current(device_);
        shading_.reset();
        pipeline_.reset();
    } catch (const std::exception&) {
        shading_.release();  // the context is gone, and with it all that they held
        pipeline_.release();
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

void GlRasterizer::count_use(std::pair<int, int> key, const Tile& tile) const {
    std::int64_t& left = rendered_[key]->uses_left;
    left -= std::int64_t{tile.x1 - std::max(tile.x0, limits_.x0)} * (tile.y1 - std::max(tile.y0, limits_.y0));
    if (left <= 0) rendered_.erase(key);
}

std::shared_ptr<const GlRasterizer::Rendered> GlRasterizer::covered(const Region& region, const Tile& tile) const {
    const std::pair key(region.cell_x, region.cell_y);
    const std::lock_guard<std::mutex> lock(mutex_);
    std::shared_ptr<Rendered>& rendered = rendered_[key];
    if (!rendered) {
        const Device::Current current(device_);
        rendered = std::make_shared<Rendered>();
        rendered->hits = pipeline_->render(region);
        rendered->uses_left = std::int64_t{region.width()} * region.height() * (shading_ ? 2 : 1);
    }
    const std::shared_ptr<const Rendered> kept = rendered;
    count_use(key, tile);
    return kept;
}

std::shared_ptr<const GlRasterizer::Rendered> GlRasterizer::shaded(const Region& region, const Tile& tile) const {
    const std::pair key(region.cell_x, region.cell_y);
    const std::lock_guard<std::mutex> lock(mutex_);
    const std::shared_ptr<Rendered> rendered = rendered_.at(key);
    if (!rendered->shade) {
        const Device::Current current(device_);
        rendered->shade = shading_->shade(region, rendered->hits);
    }
    count_use(key, tile);
    return rendered;
}

const char* GlRasterizer::pipeline() const {
    return pipeline_->takes_compute() ? "compute" : "geometry";
}

void GlRasterizer::cover(const Tile& tile, Hits& hits, CoverCounts& counts, CoverMap* map) const {
    const Region region = region_of(tile.cell_x(), tile.cell_y());
    const std::shared_ptr<const Rendered> rendered = covered(region, tile);
    const RegionHits* const found = &rendered->hits;
    const int slots = table_.slots();
    const std::size_t cell =
        static_cast<std::size_t>(tile.cell_y() - region.cell_y) * region.cell_columns + (tile.cell_x() - region.cell_x);
    for (int py = std::max(tile.y0, limits_.y0); py < tile.y1; ++py)
        for (int px = std::max(tile.x0, limits_.x0); px < tile.x1; ++px) {
            const int block = py % kCellSize / kBlockSize * kCellBlocks + px % kCellSize / kBlockSize;
            const std::size_t lane = py % kBlockSize * kBlockSize + px % kBlockSize;
            const std::size_t from = ((cell * kBlocksPerCell + block) * slots) * kLanes + lane,
                              to = hits.first(block) + lane;
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

std::int64_t GlRasterizer::shade(const Tile& tile, const Hits& hits, TileShade& out) const {
    const Region region = region_of(tile.cell_x(), tile.cell_y());
    const std::shared_ptr<const Rendered> rendered = shaded(region, tile);
    const RegionShade& shade = *rendered->shade;
    const std::size_t of_block = static_cast<std::size_t>(table_.slots()) * kLanes;
    const std::size_t first = (static_cast<std::size_t>(tile.cell_y() - region.cell_y) * region.cell_columns +
                               (tile.cell_x() - region.cell_x)) *
                              kBlocksPerCell * of_block;
    out.point_of_sample.assign(hits.triangle.size(), kBackground);
    out.colors.clear();
    std::int64_t points = 0;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> known;  // of a pixel: colours there, and here
    for (int py = std::max(tile.y0, limits_.y0); py < tile.y1; ++py)
        for (int px = std::max(tile.x0, limits_.x0); px < tile.x1; ++px) {
            const int block = py % kCellSize / kBlockSize * kCellBlocks + px % kCellSize / kBlockSize;
            const std::size_t begin = first + block * of_block + py % kBlockSize * kBlockSize + px % kBlockSize;
            const std::size_t entry = hits.entry(px, py, 0);
            known.clear();
            for (std::size_t at = begin; at < begin + of_block; at += kLanes) {
                const std::uint32_t there = shade.color_of_sample[at];
                if (there == kBackground) continue;
                const auto same = [&](const auto& pair) { return pair.first == there; };
                auto found = std::find_if(known.rbegin(), known.rend(), same);
                if (found == known.rend()) {
                    const auto of_point = [&](const auto& pair) { return pair.first / 4 == there / 4; };
                    points += std::none_of(known.begin(), known.end(), of_point);
                    known.emplace_back(there, static_cast<std::uint32_t>(out.colors.size()));
                    out.colors.push_back(shade.colors[there]);
                    found = known.rbegin();
                }
                out.point_of_sample[entry + (at - begin)] = found->second;
            }
        }
    return points;
}

}  // namespace pentaprism::gl
