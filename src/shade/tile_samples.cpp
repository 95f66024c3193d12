#include "shade/tile_samples.h"

#include <algorithm>

namespace pentaprism {

void TileSamples::collect(const SampleTable& samples, const Tile& tile, const Hits& hits, int first_block,
                          int last_block) {
    entries_.clear();
    misses_.clear();
    counts_.clear();
    triangles_.clear();
    std::fill(table_.begin(), table_.end(), 0u);
    const int slots = samples.slots();
    for (int block = first_block; block < last_block; ++block) {
        const int bx = tile.cell_x() * kCellBlocks + block % kCellBlocks;
        const int by = tile.cell_y() * kCellBlocks + block / kCellBlocks;
        if (bx * kBlockSize < tile.x0 || bx * kBlockSize >= tile.x1) continue;
        if (by * kBlockSize < tile.y0 || by * kBlockSize >= tile.y1 || !tile.wants(bx, by)) continue;
        order_.read(samples, bx, by);
        const std::size_t first = hits.first(block);
        for (int lane = 0; lane < kLanes; ++lane) {
            const std::uint16_t* slot = order_.slots(lane);
            const auto pixel = static_cast<std::uint16_t>(block * kLanes + lane);
            for (int index = 0; index < slots; ++index) {
                const auto place = static_cast<std::uint32_t>((block * slots + slot[index]) * kLanes + lane);
                const std::uint32_t triangle = hits.triangle[first + slot[index] * kLanes + lane];
                if (triangle == kNoTriangle) {
                    misses_.push_back({place, pixel});
                    continue;
                }
                const bool again = !entries_.empty() && triangles_[entries_.back().local] == triangle;
                const std::uint32_t local = again ? entries_.back().local : local_triangle(triangle);
                ++counts_[local];
                entries_.push_back({place, local, pixel});
            }
        }
    }
    sort();
}

void TileSamples::sort() {
    places_.resize(entries_.size());
    pixels_.resize(entries_.size());
    std::uint32_t sum = 0;
    for (std::uint32_t& count : counts_) {
        const std::uint32_t here = count;
        count = sum;
        sum += here;
    }
    for (const Entry& entry : entries_) {
        const std::uint32_t to = counts_[entry.local]++;
        places_[to] = entry.place;
        pixels_[to] = entry.pixel;
    }
}

std::uint32_t TileSamples::local_triangle(std::uint32_t triangle) {
    if (2 * (triangles_.size() + 1) > table_.size()) grow_table();
    const std::size_t mask = table_.size() - 1;
    std::size_t at = (triangle * 0x9e3779b1u >> 7) & mask;
    while (table_[at] != 0) {
        if (triangles_[table_[at] - 1] == triangle) return table_[at] - 1;
        at = (at + 1) & mask;
    }
    triangles_.push_back(triangle);
    counts_.push_back(0);
    table_[at] = static_cast<std::uint32_t>(triangles_.size());
    return table_[at] - 1;
}

// At most half full, so that a search always ends at an empty entry.
void TileSamples::grow_table() {
    table_.assign(std::max<std::size_t>(1024, 2 * table_.size()), 0u);
    const std::size_t mask = table_.size() - 1;
    for (std::size_t number = 0; number < triangles_.size(); ++number) {
        std::size_t at = (triangles_[number] * 0x9e3779b1u >> 7) & mask;
        while (table_[at] != 0) at = (at + 1) & mask;
        table_[at] = static_cast<std::uint32_t>(number + 1);
    }
}

}  // namespace pentaprism
