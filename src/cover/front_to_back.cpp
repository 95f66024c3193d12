#include "cover/front_to_back.h"

#include <bit>
#include <cmath>
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

}  // namespace pentaprism
