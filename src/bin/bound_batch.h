#pragma once
// Bounds of sixteen triangles at a time: what every triangle of the frame costs, seen or not.

#include <vector>

#include "bin/bins.h"

namespace pentaprism {

/// Appends what may be seen of the triangles [first, last), in the order of the frame.
void bound_triangles(const Frame& frame, std::uint32_t first, std::uint32_t last, const PixelRect& limits,
                     std::vector<BinnedTriangle>& out);

}  // namespace pentaprism
