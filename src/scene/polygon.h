#pragma once
// Polygons cut into triangles.

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace pentaprism {

/// Triangles as positions in `corners` (0 to n - 1), wound as the polygon; n - 2 of them. Concave polygons are cut by
/// clipping ears; one that is neither convex nor simple still gives n - 2 triangles.
std::vector<std::array<std::uint32_t, 3>> triangulate_polygon(std::span<const glm::vec3> corners);

}  // namespace pentaprism
