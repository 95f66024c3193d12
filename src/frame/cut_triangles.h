#pragma once
// Circles of confusion are straight over a triangle (that is what the exact test and every bound assume), but those of
// --focus-range and --max-foreground-blur are not straight in depth: a large triangle through the sharp range would
// miss it. So triangles are cut at depths between which half a pixel does not tell the difference
// (docs/develop/algorithms.md 1.3). Where an edge is cut depends on the edge alone, so neighbours are cut alike and
// stay without cracks.

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
    std::vector<std::uint32_t> indices;   ///< as those of the Primitive
    std::vector<Piece> pieces;            ///< for each triangle
    std::vector<PointOnEdge> cut_points;  ///< Part::cut_points
};

/// Cuts what crosses one of the depths, and adds the new points to each knot.
CutTriangles cut_triangles(std::span<const std::uint32_t> indices, std::vector<KnotPoints>& knots);

/// Ascending depths, of which two neighbours see Lens::coc() straight within half a pixel of radius, at all knots; also
/// when all of them are moved by up to `motion`. Beyond the first and the last it is straight.
std::vector<double> cut_depths(std::span<const View> views, double motion);

}  // namespace pentaprism
