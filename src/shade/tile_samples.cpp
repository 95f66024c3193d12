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
    const std::uint32_t per_block = static_cast<std::uint32_t>(samples.slots()) * kLanes;
    const std::uint32_t starts = is_by_pixel(samples) ? kLanes : 1;
    std::uint32_t last = kNoTriangle, local = 0;
    for (int block = first_block; block < last_block; ++block) {
        const int bx = tile.cell_x() * kCellBlocks + block % kCellBlocks;
        const int by = tile.cell_y() * kCellBlocks + block / kCellBlocks;
        if (bx * kBlockSize < tile.x0 || bx * kBlockSize >= tile.x1) continue;
        if (by * kBlockSize < tile.y0 || by * kBlockSize >= tile.y1 || !tile.wants(bx, by)) continue;
        const std::uint32_t first = static_cast<std::uint32_t>(block) * per_block;
        const std::uint32_t* triangles = &hits.triangle[hits.first(block)];
        for (std::uint32_t begin = first; begin < first + starts; ++begin)
            for (std::uint32_t place = begin; place < first + per_block; place += starts) {
                const std::uint32_t triangle = triangles[place - first];
                if (triangle == kNoTriangle) {
                    misses_.push_back(place);
                    continue;
                }
                if (triangle != last) local = local_triangle(triangle);
                last = triangle;
                ++counts_[local];
                entries_.push_back({place, local});
            }
    }
    sort();
}

void TileSamples::sort() {
    places_.resize(entries_.size());
    std::uint32_t sum = 0;
    for (std::uint32_t& count : counts_) {
        const std::uint32_t here = count;
        count = sum;
        sum += here;
    }
    for (const Entry& entry : entries_) places_[counts_[entry.local]++] = entry.place;
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
