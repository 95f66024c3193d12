#pragma once
// What every sample of a frame sees by one of the methods of visibility.

#include <algorithm>
#include <vector>

#include "base/parallel.h"
#include "render/visibility.h"

namespace pentaprism::support {

/// Entry (py * width + px) * spp + index.
struct Found {
    std::vector<std::uint32_t> triangles;
    std::vector<float> depths;

    bool operator==(const Found&) const = default;
    std::int64_t hits() const {
        return static_cast<std::int64_t>(triangles.size()) -
               std::count(triangles.begin(), triangles.end(), kNoTriangle);
    }
    int count_other_triangles(const Found& other) const {
        int n = 0;
        for (std::size_t i = 0; i < triangles.size(); ++i) n += triangles[i] != other.triangles[i];
        return n;
    }
};

inline Found find_visible(const Frame& frame, const SampleTable& table, VisibilityMethod visibility,
                          int tile_size = 32) {
    MethodSettings method;
    method.visibility = visibility;
    method.tile_size = tile_size;
    const Visibility door(frame, table, method, {0, frame.view.width, 0, frame.view.height});
    Found found;
    const std::size_t n = static_cast<std::size_t>(frame.view.width) * frame.view.height * table.spp();
    found.triangles.resize(n);
    found.depths.resize(n);
    parallel_for(door.tiles().size(), [&](std::size_t i) {
        const Tile& tile = door.tiles()[i];
        Hits hits;
        CoverCounts counts;
        door.cover(tile, hits, counts);
        for (int py = tile.y0; py < tile.y1; ++py)
            for (int px = tile.x0; px < tile.x1; ++px)
                for (int index = 0; index < table.spp(); ++index) {
                    const std::size_t from = hits.entry(px, py, table.slot_of(px, py, index));
                    const std::size_t to = (static_cast<std::size_t>(py) * frame.view.width + px) * table.spp() + index;
                    found.triangles[to] = hits.triangle[from];
                    found.depths[to] = hits.depth[from];
                }
    });
    return found;
}

}  // namespace pentaprism::support
