#include "cover/front_to_back.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <hwy/cache_control.h>
#include <hwy/contrib/sort/vqsort.h>

namespace pentaprism {

namespace {

// Rounding may put a hit a few ulps in front of the nearest vertex.
float depth_of(const TileWork& work, float nearest_w) {
    constexpr float kMargin = 1.0f - 16.0f * 0x1p-24f;
    return work.frame.view.perspective ? nearest_w * kMargin : -INFINITY;
}

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

// Of the list: where the segments of one triangle end that follow each other from `first` on, if vectors cross them.
std::size_t end_of_run(const TileWork& work, const std::vector<std::uint32_t>& list, std::size_t first,
                       float vector_span) {
    const auto follows = [&](std::size_t i) {
        const BinnedTriangle &one = work.triangles[list[i - 1]], &next = work.triangles[list[i]];
        return next.triangle == one.triangle && next.segment == one.segment + 1;
    };
    std::size_t end = first + 1;
    if (end == list.size() || !follows(end)) return end;
    const Frame& frame = work.frame;
    if (!crosses_segments(frame.parts[frame.part_of[work.triangles[list[first]].triangle]], vector_span)) return end;
    while (end < list.size() && follows(end)) ++end;
    return end;
}

// Those that may be in clusters come last, by segment; returns the first of them.
std::size_t sort_for_clusters(const TileWork& work, std::vector<std::uint32_t>& list, float vector_span) {
    const Frame& frame = work.frame;
    const auto crosses = [&](std::uint32_t i) {
        return crosses_segments(frame.parts[frame.part_of[work.triangles[i].triangle]], vector_span);
    };
    const auto segment = [&](std::uint32_t i) { return work.triangles[i].segment; };
    if (std::none_of(list.begin(), list.end(), [&](std::uint32_t i) { return segment(i) != 0; })) return 0;
    const auto others = std::stable_partition(list.begin(), list.end(), crosses);
    std::stable_sort(others, list.end(), [&](std::uint32_t a, std::uint32_t b) { return segment(a) < segment(b); });
    return static_cast<std::size_t>(others - list.begin());
}

}  // namespace

float nearest_depth(const TileWork& work, const BinnedTriangle& triangle) {
    return depth_of(work, triangle.nearest_w);
}

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

ClusteredOrder clustered_front_to_back(const TileWork& work, float vector_span) {
    std::vector<std::uint32_t> list(work.list.begin(), work.list.end());
    const std::size_t others = list.size() < kCrowded ? list.size() : sort_for_clusters(work, list, vector_span);
    constexpr std::uint32_t kWhole = 0x80000000u;  // place in the list of the first of a cluster
    std::vector<std::uint64_t> keys;
    keys.reserve(list.size());
    const auto nearest = [&](std::size_t place) { return work.triangles[list[place]].nearest_w; };
    const auto nearest_of = [&](std::size_t begin, std::size_t end) {
        float least = nearest(begin);
        for (std::size_t k = begin + 1; k < end; ++k) least = std::min(least, nearest(k));
        return least;
    };
    for (std::size_t i = 0; i < others;) {
        const std::size_t end = std::min(others, end_of_run(work, list, i, vector_span));
        const float least = nearest_of(i, end);
        for (; i < end; ++i) keys.push_back(depth_key(work, least, static_cast<std::uint32_t>(i)));
    }
    for (std::size_t i = others; i < list.size();) {
        const std::size_t end = std::min(i + kClusterSize, list.size());
        if (is_cluster(work, list, i)) {
            keys.push_back(depth_key(work, nearest_of(i, end), static_cast<std::uint32_t>(i) | kWhole));
            i = end;
        }
        for (; i < end; ++i) keys.push_back(depth_key(work, nearest(i), static_cast<std::uint32_t>(i)));
    }
    sort_keys(keys);
    ClusteredOrder order;
    order.entries.reserve(list.size());
    order.nearest.reserve(list.size());
    for (const std::uint64_t key : keys) {
        const auto place = static_cast<std::uint32_t>(key);
        const std::size_t count = (place & kWhole) == 0 ? 1 : kClusterSize;
        if (count != 1) order.clusters.push_back(static_cast<std::uint32_t>(order.entries.size()));
        const auto first = list.begin() + (place & ~kWhole);
        order.entries.insert(order.entries.end(), first, first + count);
        order.nearest.insert(order.nearest.end(), count,
                             depth_of(work, std::bit_cast<float>(static_cast<std::uint32_t>(key >> 32))));
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
