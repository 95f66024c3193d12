#pragma once
// Which triangles concern which tile: the sort in sort-middle. Order within a tile is that of submission (triangle,
// then motion segment), so nothing depends on who did what.

#include <cstdint>
#include <span>
#include <vector>

#include "base/uninitialized.h"
#include "bound/facing.h"
#include "bound/screen_bounds.h"
#include "frame/frame.h"

namespace pentaprism {

/// One motion segment of one triangle that may be seen.
struct BinnedTriangle {
    std::uint32_t triangle;
    std::uint16_t segment;
    std::uint16_t x0, x1, y0, y1;  ///< pixels it may cover, half open
    Facing facing;                 ///< the side that every sample sees, or kMixed
    float nearest_w;               ///< no sample sees it at a smaller w
};

class Bins {
  public:
    /// `limits`: the pixels that are rendered. Drops triangles with numbers that are not finite or above 1e12, those
    /// that turn a culled back to every sample, wholly transparent ones, and those outside the limits.
    Bins(const Frame& frame, int tile_size, const PixelRect& limits);

    std::span<const BinnedTriangle> triangles() const { return triangles_; }

    /// Indices into triangles() for the tile whose top left pixel is (x0, y0).
    std::span<const std::uint32_t> tile(int x0, int y0) const;

  private:
    void bound(const Frame& frame, const PixelRect& limits);
    void sort();

    int tile_size_, first_x_, first_y_, columns_, rows_;  // tiles
    UninitializedVector<BinnedTriangle> triangles_;
    std::vector<std::size_t> offsets_;
    UninitializedVector<std::uint32_t> entries_;
};

}  // namespace pentaprism
