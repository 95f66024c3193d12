#pragma once
// What shading makes of a tile: shaded points, and which of them each sample shows.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <vector>

namespace pentaprism {

inline constexpr std::uint32_t kBackground = 0xffffffffu;

struct TileShade {
    std::vector<std::uint32_t> point_of_sample;  ///< by entry in Hits; kBackground where nothing is hit. Those of
                                                 ///< pixels outside the tile have no meaning
    std::vector<glm::vec4> colors;  ///< of each point: linear colour, finite; w is 1, or 0 for what is seen
                                    ///< of the surroundings
};

/// As TileShade::colors holds it: what is not finite is black, and nothing is brighter than 2^20.
inline glm::vec4 contained(const glm::vec3& color) {
    const auto one = [](float x) { return std::isfinite(x) ? std::clamp(x, 0.0f, 0x1p20f) : 0.0f; };
    return {one(color.x), one(color.y), one(color.z), 1.0f};
}

}  // namespace pentaprism
