#pragma once
// Visibility of a posed frame: bound, bin, cull and cover behind one door. What render_frame, verify and the timing
// against peers call alike.

#include "bin/bins.h"
#include "cover/cover.h"
#include "frame/frame.h"
#include "sample/sample_table.h"

namespace pentaprism {

class Visibility {
  public:
    /// Bins the frame. `limits`: the pixels that will be asked for, within the picture. `frame` and `samples` must
    /// outlive this. Throws Error(kUsage) for a culling test that does not exist.
    Visibility(const Frame& frame, const SampleTable& samples, const MethodSettings& method, const PixelRect& limits);

    /// Tiles that cover the limits, rows from top to bottom, each row from left to right.
    const std::vector<Tile>& tiles() const { return tiles_; }

    /// Fills the tile's hits. Thread-safe: each caller brings its own Hits and may share a map of the whole picture, in
    /// which tiles write different pixels.
    void cover(const Tile& tile, Hits& hits, CoverCounts& counts, CoverMap* map = nullptr) const;

    std::int64_t binned_triangles() const { return static_cast<std::int64_t>(bins_.triangles().size()); }

  private:
    const Frame& frame_;
    const SampleTable& samples_;
    Culling culling_;  ///< empty: the fast path
    Bins bins_;
    std::vector<Tile> tiles_;
};

/// What blurs in this frame: how its samples are best grouped.
Grouping grouping_for(const Frame& frame);

}  // namespace pentaprism
