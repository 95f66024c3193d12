#include "bin/bins.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "bound/facing.h"
#include "frame/opacity.h"

namespace pentaprism {
namespace {

constexpr std::size_t kChunk = 4096;  // triangles bounded at a time
constexpr float kLargest = 1e12f;     // edge functions times w grow like the cube: beyond it they would overflow

bool is_usable(const MovingTriangle& m) {
    for (int i = 0; i < 3; ++i)
        for (int end = 0; end < 2; ++end)
            for (const float v : {m.x[i][end], m.y[i][end], m.w[i][end], m.c[i][end], m.z[i][end]})
                if (!(std::abs(v) <= kLargest)) return false;
    return true;
}

void bound_triangle(const Frame& frame, std::uint32_t triangle, const PixelRect& limits,
                    std::vector<BinnedTriangle>& out) {
    const Part& part = frame.parts[frame.part_of[triangle]];
    const View& view = frame.view;
    if (opacity_class(frame, triangle) == OpacityClass::kClear) return;
    for (int segment = 0; segment < (part.moves ? part.segments : 1); ++segment) {
        const MovingTriangle m = moving_triangle(frame, triangle, segment);
        if (!is_usable(m)) continue;
        const ScreenBox box = screen_bounds(m, view.w_near(), view.lens.ratio);
        const PixelRect rect = covered_pixels(box, view.width, view.height, limits);
        if (rect.empty()) continue;
        if (!part.two_sided && facing(m, view.lens.ratio) == Facing::kBack) continue;
        out.push_back({triangle, static_cast<std::uint16_t>(segment), static_cast<std::uint16_t>(rect.x0),
                       static_cast<std::uint16_t>(rect.x1), static_cast<std::uint16_t>(rect.y0),
                       static_cast<std::uint16_t>(rect.y1), static_cast<float>(box.nearest_w)});
    }
}

}  // namespace

Bins::Bins(const Frame& frame, int tile_size, const PixelRect& limits)
    : tile_size_(tile_size),
      first_x_(limits.x0 / tile_size),
      first_y_(limits.y0 / tile_size),
      columns_((limits.x1 + tile_size - 1) / tile_size - first_x_),
      rows_((limits.y1 + tile_size - 1) / tile_size - first_y_) {
    const std::size_t triangle_count = frame.triangle_count(), chunks = (triangle_count + kChunk - 1) / kChunk;
    std::vector<std::vector<BinnedTriangle>> bounded(chunks);
    parallel_for(chunks, [&](std::size_t chunk) {
        const std::size_t last = std::min(triangle_count, (chunk + 1) * kChunk);
        for (std::size_t t = chunk * kChunk; t < last; ++t)
            bound_triangle(frame, static_cast<std::uint32_t>(t), limits, bounded[chunk]);
    });
    std::size_t total = 0;
    for (const auto& chunk : bounded) total += chunk.size();
    triangles_.reserve(total);
    for (auto& chunk : bounded) {
        triangles_.insert(triangles_.end(), chunk.begin(), chunk.end());
        chunk = {};
    }

    // Each worker owns a band of tile rows and walks all triangles in order, once to count and once to fill.
    const std::size_t tiles = static_cast<std::size_t>(columns_) * rows_;
    const int bands = std::min(rows_, thread_count());
    auto for_each_entry = [&](int band, auto&& visit) {
        const int row0 = first_y_ + rows_ * band / bands, row1 = first_y_ + rows_ * (band + 1) / bands;
        for (std::uint32_t i = 0; i < triangles_.size(); ++i) {
            const BinnedTriangle& t = triangles_[i];
            const int y0 = std::max(row0, t.y0 / tile_size_), y1 = std::min(row1, (t.y1 - 1) / tile_size_ + 1);
            const int x0 = t.x0 / tile_size_, x1 = (t.x1 - 1) / tile_size_ + 1;
            for (int y = y0; y < y1; ++y)
                for (int x = x0; x < x1; ++x)
                    visit(static_cast<std::size_t>(y - first_y_) * columns_ + (x - first_x_), i);
        }
    };
    offsets_.assign(tiles + 1, 0);
    parallel_for(bands, [&](std::size_t band) {
        for_each_entry(static_cast<int>(band), [&](std::size_t tile, std::uint32_t) { ++offsets_[tile + 1]; });
    });
    for (std::size_t i = 0; i < tiles; ++i) offsets_[i + 1] += offsets_[i];
    entries_.resize(offsets_[tiles]);
    std::vector<std::size_t> next(offsets_.begin(), offsets_.end() - 1);
    parallel_for(bands, [&](std::size_t band) {
        for_each_entry(static_cast<int>(band), [&](std::size_t tile, std::uint32_t i) { entries_[next[tile]++] = i; });
    });
}

std::span<const std::uint32_t> Bins::tile(int x0, int y0) const {
    const std::size_t tile =
        static_cast<std::size_t>(y0 / tile_size_ - first_y_) * columns_ + (x0 / tile_size_ - first_x_);
    return std::span(entries_).subspan(offsets_[tile], offsets_[tile + 1] - offsets_[tile]);
}

}  // namespace pentaprism
