#pragma once
// Circles of confusion are straight over a triangle (that is what the exact test and every bound assume), but those of
// --focus-range and --max-foreground-blur are not straight in depth: a large triangle through the sharp range would
// miss it. So triangles are cut until half a pixel does not tell the difference (docs/develop/algorithms.md 5.2). An
// edge is cut in its middle, by a rule that knows the edge alone, so neighbours are cut alike and stay without cracks.

#include <array>
#include <cstdint>
#include <glm/vec4.hpp>
#include <span>
#include <vector>

#include "frame/frame.h"

namespace pentaprism {

/// The points of one part at one knot: x, y, w, c; with z for an orthographic camera, else z = w.
struct KnotPoints {
    View view;  ///< at that time
    std::vector<glm::vec4> points;
    std::vector<float> depths;
};

struct CutTriangles {
    std::vector<std::uint32_t> indices;                   ///< as those of the Primitive
    std::vector<Piece> pieces;                            ///< for each triangle
    std::vector<std::array<std::uint32_t, 2>> midpoints;  ///< Part::midpoints
};

/// Cuts what can be seen, and adds the new points to each knot.
CutTriangles cut_triangles(std::span<const std::uint32_t> indices, std::vector<KnotPoints>& knots);

}  // namespace pentaprism
