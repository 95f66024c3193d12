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

// As one number: the bits of the (positive) float above those of the place in the list. All differ, so the order is the
// same on every processor.
std::vector<std::uint32_t> front_to_back(const TileWork& work) {
    std::vector<std::uint64_t> keys;
    keys.reserve(work.list.size());
    for (const std::uint32_t entry : work.list) {
        const float nearest = work.frame.view.perspective ? work.triangles[entry].nearest_w : 0.0f;
        keys.push_back(std::uint64_t{std::bit_cast<std::uint32_t>(nearest)} << 32 | entry);
    }
    thread_local const hwy::Sorter sort;  // owns memory
    sort(keys.data(), keys.size(), hwy::SortAscending());
    std::vector<std::uint32_t> order;
    order.reserve(keys.size());
    for (const std::uint64_t key : keys) order.push_back(static_cast<std::uint32_t>(key));
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
