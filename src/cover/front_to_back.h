#pragma once
// The order in which a tile's triangles are walked, so that what is hidden is met late and refused early.

#include <bit>
#include <cstdint>
#include <vector>

#include "cover/cover.h"

namespace pentaprism {

/// No sample sees the triangle at a smaller depth; -infinity in orthographic views, whose w says nothing about depth.
float nearest_depth(const TileWork& work, const BinnedTriangle& triangle);

/// The tile's triangles by their nearest w: indices into TileWork::triangles.
std::vector<std::uint32_t> front_to_back(const TileWork& work);

/// Whether vectors of samples that span this fraction of the shutter meet several segments of the part's paths, and
/// each sample can tell which is its own from its time times their number, which is exact for powers of two.
inline bool crosses_segments(const Part& part, float vector_span) {
    return part.moves && std::has_single_bit(static_cast<unsigned>(part.segments)) &&
           static_cast<float>(part.segments) * vector_span > 1.5f;
}

/// The same, but some that follow each other in the list stay together: segments of a triangle, where vectors cross
/// them, and in crowded tiles sixteen triangles that blur over nearly the same pixels of the tile and lie about as
/// deep, neighbours in a fine mesh. `clusters`: where in `entries` the latter begin, ascending. `nearest`: of each
/// entry; no sample sees it, nor what it stays together with, nor any later entry, at a smaller depth.
struct ClusteredOrder {
    std::vector<std::uint32_t> entries, clusters;
    std::vector<float> nearest;
};
ClusteredOrder clustered_front_to_back(const TileWork& work, float vector_span);

/// Before entry i of the order is read: prefetches what later entries need. Sorted by depth, triangles lie anywhere in
/// memory.
void fetch_ahead(const TileWork& work, const std::vector<std::uint32_t>& order, std::size_t i);

}  // namespace pentaprism
