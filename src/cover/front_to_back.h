#pragma once
// The order in which a tile's triangles are walked, so that what is hidden is met late and refused early.

#include <cstdint>
#include <vector>

#include "cover/cover.h"

namespace pentaprism {

/// No sample sees the triangle at a smaller depth; -infinity in orthographic views, whose w says nothing about depth.
float nearest_depth(const TileWork& work, const BinnedTriangle& triangle);

/// The tile's triangles by their nearest w: indices into TileWork::triangles.
std::vector<std::uint32_t> front_to_back(const TileWork& work);

/// The same, but in crowded tiles sixteen that follow each other in the list, blur over nearly the same pixels of the
/// tile and lie about as deep stay together: neighbours in a fine mesh. `clusters`: where in `entries` these begin,
/// ascending.
struct ClusteredOrder {
    std::vector<std::uint32_t> entries, clusters;
};
ClusteredOrder clustered_front_to_back(const TileWork& work);

/// Before entry i of the order is read: prefetches what later entries need. Sorted by depth, triangles lie anywhere in
/// memory.
void fetch_ahead(const TileWork& work, const std::vector<std::uint32_t>& order, std::size_t i);

}  // namespace pentaprism
