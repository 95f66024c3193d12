#include "resolve/stored_sample.h"

#include <limits>
#include <span>

#include "resolve/sample_order.h"
#include "resolve/sample_place.h"

namespace pentaprism {

void store_samples(const Tile& tile, const SampleTable& samples, const Hits& hits, const TileShade& shade,
                   const glm::vec3& background, std::vector<StoredSample>& out) {
    const int width = tile.x1 - tile.x0, spp = samples.spp();
    out.assign(static_cast<std::size_t>(width) * (tile.y1 - tile.y0) * spp, StoredSample{});
    SampleOrder order;
    std::vector<SampleVector> room;
    for (int by = tile.y0 / kBlockSize; by * kBlockSize < tile.y1; ++by)
        for (int bx = tile.x0 / kBlockSize; bx * kBlockSize < tile.x1; ++bx) {
            order.read(samples, bx, by);
            const std::span<const SampleVector> vectors = samples.block(bx, by, room);
            for (int lane = 0; lane < kLanes; ++lane) {
                const int px = bx * kBlockSize + lane % kBlockSize, py = by * kBlockSize + lane / kBlockSize;
                if (px < tile.x0 || px >= tile.x1 || py < tile.y0 || py >= tile.y1) continue;
                StoredSample* pixel = &out[(static_cast<std::size_t>(py - tile.y0) * width + (px - tile.x0)) * spp];
                for (int index = 0; index < spp; ++index) {
                    const int slot = order.slots(lane)[index];
                    const std::size_t at = hits.entry(px, py, slot);
                    const SampleVector& vector = vectors[slot];
                    const auto [x, y] = place_in_pixel(vector, lane);
                    const std::uint32_t point = shade.point_of_sample[at];
                    const glm::vec4 color = point == kBackground ? glm::vec4(background, 0.0f) : shade.colors[point];
                    pixel[index] = {{color.x, color.y, color.z},
                                    vector.u[lane],
                                    vector.v[lane],
                                    vector.t[lane],
                                    point == kBackground ? std::numeric_limits<float>::infinity() : hits.depth[at],
                                    static_cast<std::uint8_t>(x),
                                    static_cast<std::uint8_t>(y),
                                    static_cast<std::uint8_t>(color.w > 0.5f ? 1 : 0)};
                }
            }
        }
}

}  // namespace pentaprism
