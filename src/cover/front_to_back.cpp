#include "cover/front_to_back.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <hwy/cache_control.h>
#include <hwy/contrib/sort/vqsort.h>

namespace pentaprism {

// Rounding may put a hit a few ulps in front of the nearest vertex.
float nearest_depth(const TileWork& work, const BinnedTriangle& triangle) {
    constexpr float kMargin = 1.0f - 16.0f * 0x1p-24f;
    return work.frame.view.perspective ? triangle.nearest_w * kMargin : -INFINITY;
}

namespace {

// As one number: the bits of the (positive) float above those of the place in the list. All differ, so the order is the
// same on every processor.
std::uint64_t depth_key(const TileWork& work, float nearest_w, std::uint32_t place) {
    const float nearest = work.frame.view.perspective ? nearest_w : 0.0f;
    return std::uint64_t{std::bit_cast<std::uint32_t>(nearest)} << 32 | place;
}

void sort_keys(std::vector<std::uint64_t>& keys) {
    thread_local const hwy::Sorter sort;  // owns memory
    sort(keys.data(), keys.size(), hwy::SortAscending());
}

// The pixels of the tile that triangles may cover.
struct Extent {
    int x0, x1, y0, y1;
    Extent(const BinnedTriangle& t, const Tile& tile)
        : x0(std::max<int>(t.x0, tile.x0)),
          x1(std::min<int>(t.x1, tile.x1)),
          y0(std::max<int>(t.y0, tile.y0)),
          y1(std::min<int>(t.y1, tile.y1)) {}
    void extend(const Extent& other) {
        x0 = std::min(x0, other.x0), x1 = std::max(x1, other.x1);
        y0 = std::min(y0, other.y0), y1 = std::max(y1, other.y1);
    }
    int blocks() const {
        return ((x1 - 1) / kBlockSize - x0 / kBlockSize + 1) * ((y1 - 1) / kBlockSize - y0 / kBlockSize + 1);
    }
};

constexpr std::size_t kClusterSize = kLanes;
// What pays, measured (docs/develop/performance.md): tiles with more than two triangles for each pixel; of a cluster
// its blocks over those of one of its triangles, and the farthest over the nearest of their nearest depths.
constexpr std::size_t kCrowded = 2048;
constexpr int kMostSpread = 4;
constexpr float kDeepest = 1.05f;

// Whether the triangles of the list from `first` on are worth a cluster.
bool is_cluster(const TileWork& work, const std::vector<std::uint32_t>& list, std::size_t first) {
    if (first + kClusterSize > list.size()) return false;
    const BinnedTriangle& one = work.triangles[list[first]];
    Extent all(one, work.tile);
    int sum = 0;
    float least = one.nearest_w, most = least;
    for (std::size_t i = first; i < first + kClusterSize; ++i) {
        const BinnedTriangle& t = work.triangles[list[i]];
        if (t.segment != one.segment) return false;
        const Extent extent(t, work.tile);
        sum += extent.blocks();
        least = std::min(least, t.nearest_w), most = std::max(most, t.nearest_w);
        all.extend(extent);
    }
    return all.blocks() * static_cast<int>(kClusterSize) <= kMostSpread * sum && most <= kDeepest * least;
}

}  // namespace

std::vector<std::uint32_t> front_to_back(const TileWork& work) {
    std::vector<std::uint64_t> keys;
    keys.reserve(work.list.size());
    for (const std::uint32_t entry : work.list) keys.push_back(depth_key(work, work.triangles[entry].nearest_w, entry));
    sort_keys(keys);
    std::vector<std::uint32_t> order;
    order.reserve(keys.size());
    for (const std::uint64_t key : keys) order.push_back(static_cast<std::uint32_t>(key));
    return order;
}

ClusteredOrder clustered_front_to_back(const TileWork& work) {
    if (work.list.size() < kCrowded) return {front_to_back(work), {}};
    std::vector<std::uint32_t> list(work.list.begin(), work.list.end());
    const auto segment = [&](std::uint32_t i) { return work.triangles[i].segment; };
    if (std::any_of(list.begin(), list.end(), [&](std::uint32_t i) { return segment(i) != 0; }))
        std::stable_sort(list.begin(), list.end(),
                         [&](std::uint32_t a, std::uint32_t b) { return segment(a) < segment(b); });
    constexpr std::uint32_t kWhole = 0x80000000u;  // place in the list of the first of a cluster
    std::vector<std::uint64_t> keys;
    keys.reserve(list.size());
    const auto nearest = [&](std::size_t place) { return work.triangles[list[place]].nearest_w; };
    for (std::size_t i = 0; i < list.size();) {
        const bool whole = is_cluster(work, list, i);
        const std::size_t end = std::min(i + kClusterSize, list.size());
        if (whole) {
            float least = nearest(i);
            for (std::size_t k = i; k < end; ++k) least = std::min(least, nearest(k));
            keys.push_back(depth_key(work, least, static_cast<std::uint32_t>(i) | kWhole));
        } else {
            for (std::size_t k = i; k < end; ++k)
                keys.push_back(depth_key(work, nearest(k), static_cast<std::uint32_t>(k)));
        }
        i = end;
    }
    sort_keys(keys);
    ClusteredOrder order;
    order.entries.reserve(list.size());
    for (const std::uint64_t key : keys) {
        const auto place = static_cast<std::uint32_t>(key);
        if ((place & kWhole) == 0) {
            order.entries.push_back(list[place]);
            continue;
        }
        order.clusters.push_back(static_cast<std::uint32_t>(order.entries.size()));
        const auto first = list.begin() + (place & ~kWhole);
        order.entries.insert(order.entries.end(), first, first + kClusterSize);
    }
    return order;
}

void fetch_ahead(const TileWork& work, const std::vector<std::uint32_t>& order, std::size_t i) {
    constexpr std::size_t kAhead = 8;
    const auto binned = [&](std::size_t steps) -> const BinnedTriangle& {
        return work.triangles[order[std::min(i + steps * kAhead, order.size() - 1)]];
    };
    const Frame& frame = work.frame;
    hwy::Prefetch(&binned(3));
    hwy::Prefetch(&frame.corners[3 * std::size_t{binned(2).triangle}]);
    hwy::Prefetch(&frame.part_of[binned(2).triangle]);
    const std::uint32_t triangle = binned(1).triangle, *corners = &frame.corners[3 * std::size_t{triangle}];
    const Part& part = frame.parts[frame.part_of[triangle]];
    if (!part.moves) {
        for (int corner = 0; corner < 3; ++corner) hwy::Prefetch(&frame.points[corners[corner]]);
        return;
    }
    for (int corner = 0; corner < 3; ++corner)
        for (int end = 0; end < 2; ++end)
            hwy::Prefetch(&frame.points[corners[corner] + (binned(1).segment + end) * std::size_t{part.vertex_count}]);
}

}  // namespace pentaprism
