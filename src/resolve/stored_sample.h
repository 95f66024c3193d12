#pragma once
// A sample as it is kept: its ray and what it sees.

#include <cstdint>
#include <vector>

#include "resolve/tile_sums.h"

namespace pentaprism {

struct StoredSample {
    float color[3];       ///< linear, without exposure
    float u, v;           ///< on the unit disk of the lens
    float t;              ///< 0 the shutter opens, 1 it has closed
    float depth;          ///< metres along the optical axis; infinity where nothing is hit
    std::uint8_t x, y;    ///< place in the pixel from its top left corner, 1/256 pixel
    std::uint8_t opaque;  ///< 1, or 0 for the background
    std::uint8_t unused = 0;
};
static_assert(sizeof(StoredSample) == 32);

/// The samples of the tile's pixels, pixel by pixel, in index order.
void store_samples(const Tile& tile, const SampleTable& samples, const Hits& hits, const TileShade& shade,
                   const glm::vec3& background, std::vector<StoredSample>& out);

}  // namespace pentaprism
