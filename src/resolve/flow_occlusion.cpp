#include "resolve/flow_occlusion.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/parallel.h"
#include "bin/bins.h"
#include "cover/cover.h"
#include "resolve/flow.h"

namespace pentaprism {
namespace {

constexpr int kFiner = 2;  // squares of the grid for each pixel and side
constexpr double kNearer = 1.0 - 1e-3;

Frame fine_instant(const Scene& scene, RenderSettings settings, double number) {
    settings.image.width *= kFiner;
    settings.image.height *= kFiner;
    return pose_instant(scene, settings, number);
}

// Covers the tile and keeps the depths of its samples, one for each of its pixels.
void cover_depths(const Frame& frame, const SampleTable& samples, const Bins& bins, const Tile& tile, Hits& hits,
                  std::vector<float>& depth) {
    CoverCounts counts;
    hits.reset(samples.slots(), tile);
    cover_vectors(TileWork{frame, samples, bins.triangles(), bins.tile(tile.x0, tile.y0), tile}, hits, counts);
    for (int y = tile.y0; y < tile.y1; ++y)
        for (int x = tile.x0; x < tile.x1; ++x)
            depth[static_cast<std::size_t>(y) * frame.view.width + x] = hits.depth[hits.entry(x, y, 0)];
}

}  // namespace

DepthPicture::DepthPicture(const Scene& scene, const RenderSettings& settings, double number,
                           const std::shared_ptr<const Textures>& textures)
    : frame_(fine_instant(scene, settings, number)) {
    frame_.textures = textures;
    const View& view = frame_.view;
    const int width = view.width, height = view.height;
    depth_.resize(static_cast<std::size_t>(width) * height);
    const SampleTable samples(1, settings.method.seed, view.lens, Grouping::kStill);
    const Bins bins(frame_, kCellSize, {0, width, 0, height});
    const int columns = (width + kCellSize - 1) / kCellSize, rows = (height + kCellSize - 1) / kCellSize;
    parallel_for(static_cast<std::size_t>(columns) * rows, [&](std::size_t i) {
        const int x = static_cast<int>(i) % columns * kCellSize, y = static_cast<int>(i) / columns * kCellSize;
        Hits hits;
        cover_depths(frame_, samples, bins, {x, y, std::min(x + kCellSize, width), std::min(y + kCellSize, height)},
                     hits, depth_);
    });
}

DepthPicture::Fate DepthPicture::of(const SurfaceSample& sample) const {
    const View& view = frame_.view;
    const Placed placed = place_of(frame_, sample);
    if (!(placed.w >= view.w_near())) return Fate::kOutside;
    const double x = std::floor(placed.x + 0.5 * view.width), y = std::floor(0.5 * view.height - placed.y);
    if (!(x >= 0 && x < view.width && y >= 0 && y < view.height)) return Fate::kOutside;
    const int column = static_cast<int>(x), row = static_cast<int>(y);
    for (int j = std::max(row - 1, 0); j <= std::min(row + 1, view.height - 1); ++j)
        for (int i = std::max(column - 1, 0); i <= std::min(column + 1, view.width - 1); ++i)
            if (!(depth_[static_cast<std::size_t>(j) * view.width + i] < placed.depth * kNearer)) return Fate::kSeen;
    return Fate::kHidden;
}

}  // namespace pentaprism
