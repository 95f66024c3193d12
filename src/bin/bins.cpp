#include "bin/bins.h"

#include <algorithm>
#include <bit>

#include "base/parallel.h"
#include "bin/bound_batch.h"

namespace pentaprism {
namespace {

constexpr std::size_t kChunk = 4096;  // triangles bounded at a time
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
        bound_triangles(frame, static_cast<std::uint32_t>(chunk * kChunk), static_cast<std::uint32_t>(last), limits,
                        bounded[chunk]);
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
    const int shift = std::countr_zero(static_cast<unsigned>(tile_size_));
    auto for_each_entry = [&](int band, auto&& visit) {
        const int row0 = first_y_ + rows_ * band / bands, row1 = first_y_ + rows_ * (band + 1) / bands;
        for (std::uint32_t i = 0; i < triangles_.size(); ++i) {
            const BinnedTriangle& t = triangles_[i];
            const int y0 = std::max(row0, t.y0 >> shift), y1 = std::min(row1, ((t.y1 - 1) >> shift) + 1);
            const int x0 = t.x0 >> shift, x1 = ((t.x1 - 1) >> shift) + 1;
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
