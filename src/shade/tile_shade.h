#pragma once
// What shading makes of a tile: shaded points, and which of them each sample shows.

#include <cstdint>
#include <glm/vec4.hpp>
#include <vector>

namespace pentaprism {

inline constexpr std::uint32_t kBackground = 0xffffffffu;

struct TileShade {
    std::vector<std::uint32_t> point_of_sample;  ///< arranged as Hits; kBackground where nothing is hit. Entries of
                                                 ///< samples outside the tile have no meaning
    std::vector<glm::vec4> colors;  ///< of each point: linear colour, finite; w is 1, or 0 for what is seen
                                    ///< of the surroundings
};

}  // namespace pentaprism
