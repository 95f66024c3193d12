#include "bin/bins.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "base/parallel.h"
#include "bin/bound_batch.h"

namespace pentaprism {
namespace {

constexpr std::size_t kChunk = 1024;         // triangles bounded at a time
constexpr std::size_t kSharesPerThread = 4;  // of the sort, so that a thread that comes late gets fewer

}  // namespace

Bins::Bins(const Frame& frame, int tile_size, const PixelRect& limits)
    : tile_size_(tile_size),
      first_x_(limits.x0 / tile_size),
      first_y_(limits.y0 / tile_size),
      columns_((limits.x1 + tile_size - 1) / tile_size - first_x_),
      rows_((limits.y1 + tile_size - 1) / tile_size - first_y_) {
    bound(frame, limits);
    sort();
}

void Bins::bound(const Frame& frame, const PixelRect& limits) {
    const std::size_t triangle_count = frame.triangle_count(), chunks = (triangle_count + kChunk - 1) / kChunk;
    std::vector<std::vector<BinnedTriangle>> bounded(chunks);
    parallel_for(chunks, [&](std::size_t chunk) {
        const std::size_t last = std::min(triangle_count, (chunk + 1) * kChunk);
        bound_triangles(frame, static_cast<std::uint32_t>(chunk * kChunk), static_cast<std::uint32_t>(last), limits,
                        bounded[chunk]);
    });
    std::vector<std::size_t> first(chunks);
    std::size_t total = 0;
    for (std::size_t chunk = 0; chunk < chunks; ++chunk) {
        first[chunk] = total;
        total += bounded[chunk].size();
    }
    triangles_.resize(total);
    parallel_for(chunks, [&](std::size_t chunk) {
        std::copy(bounded[chunk].begin(), bounded[chunk].end(), triangles_.begin() + first[chunk]);
        bounded[chunk] = {};
    });
}

// A counting sort. Equal shares of the triangles, in order, are counted by tile, each share into a row of its own; the
// counts become places, tile after tile and in each tile share after share; then each share writes to its places.
void Bins::sort() {
    const std::size_t shares = kSharesPerThread * thread_count();
    const int shift = std::countr_zero(static_cast<unsigned>(tile_size_));
    auto for_each_entry = [&](std::size_t share, auto&& visit) {
        const std::size_t end = triangles_.size() * (share + 1) / shares;
        for (std::size_t i = triangles_.size() * share / shares; i < end; ++i) {
            const BinnedTriangle& t = triangles_[i];
            const int x0 = t.x0 >> shift, x1 = ((t.x1 - 1) >> shift) + 1;
            const int y0 = t.y0 >> shift, y1 = ((t.y1 - 1) >> shift) + 1;
            for (int y = y0; y < y1; ++y)
                for (int x = x0; x < x1; ++x)
                    visit(static_cast<std::size_t>(y - first_y_) * columns_ + (x - first_x_), i);
        }
    };
    const std::size_t tiles = static_cast<std::size_t>(columns_) * rows_;
    std::vector<std::vector<std::size_t>> next(shares);  // [share][tile]
    parallel_for(shares, [&](std::size_t share) {
        next[share].assign(tiles, 0);
        for_each_entry(share, [&](std::size_t tile, std::size_t) { ++next[share][tile]; });
    });
    offsets_.assign(tiles + 1, 0);
    std::size_t place = 0;
    for (std::size_t tile = 0; tile < tiles; ++tile) {
        for (std::vector<std::size_t>& row : next) place += std::exchange(row[tile], place);
        offsets_[tile + 1] = place;
    }
    entries_.resize(place);
    parallel_for(shares, [&](std::size_t share) {
        for_each_entry(share, [&](std::size_t tile, std::size_t i) {
            entries_[next[share][tile]++] = static_cast<std::uint32_t>(i);
        });
    });
}

std::span<const std::uint32_t> Bins::tile(int x0, int y0) const {
    const std::size_t tile =
        static_cast<std::size_t>(y0 / tile_size_ - first_y_) * columns_ + (x0 / tile_size_ - first_x_);
    return std::span(entries_).subspan(offsets_[tile], offsets_[tile + 1] - offsets_[tile]);
}

}  // namespace pentaprism
