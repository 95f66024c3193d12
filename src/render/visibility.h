#pragma once
// Visibility of a posed frame behind one door, by whichever method: bound, bin, cull and cover, or trace. What
// render_frame, verify and the timing against peers call alike.

#include <memory>
#include <optional>
#include <string>

#include "bin/bins.h"
#include "cover/cover.h"
#include "cover/layers.h"
#include "frame/frame.h"
#include "gl/rasterizer.h"
#include "sample/sample_table.h"
#include "trace/tracer.h"

namespace pentaprism {

class Visibility {
  public:
    /// Bins the frame, or builds the tracer. `limits`: the pixels that will be asked for, within the picture. `frame`
    /// and `samples`, of make_samples() for the same method, must outlive this. Throws Error(kUsage) for a culling test
    /// that does not exist, Error(kBackend) for a tracer or a backend that is not there.
    Visibility(const Frame& frame, const SampleTable& samples, const MethodSettings& method, const PixelRect& limits);

    /// tiles_over() the limits.
    const std::vector<Tile>& tiles() const { return tiles_; }

    /// Fills the tile's hits. Thread-safe: each caller brings its own Hits and may share a map of the whole picture, in
    /// which tiles write different pixels.
    void cover(const Tile& tile, Hits& hits, CoverCounts& counts, CoverMap* map = nullptr) const {
        cover(tile, samples_, hits, counts, map);
    }
    /// With other samples of make_samples() for the same method, which must be kStochastic on the processor.
    void cover(const Tile& tile, const SampleTable& samples, Hits& hits, CoverCounts& counts, CoverMap* map) const;

    /// What the samples see of all triangles that are not see-through (frame/opacity.h), and one pass over those that
    /// are for what is in front of that. For VisibilityMethod::kStochastic on the processor.
    void cover_solid(const Tile& tile, const SampleTable& samples, Hits& hits, CoverCounts& counts) const;
    void cover_layers(const Tile& tile, const SampleTable& samples, const Hits& solid, Layers& layers,
                      CoverCounts& counts) const;

    /// Of Backend::kGl: shades on the device, too (gl/rasterizer.h).
    void shade_with(const ShadingScene& scene) { rasterizer_->shade_with(scene); }
    std::int64_t shade(const Tile& tile, const Hits& hits, TileShade& out) const {
        return rasterizer_->shade(tile, hits, out);
    }

    /// 0 for a tracer and for a backend that bins on its own.
    std::int64_t binned_triangles() const { return bins_ ? static_cast<std::int64_t>(bins_->triangles().size()) : 0; }

    /// geometry or compute; empty on the processor.
    std::string gl_pipeline() const { return rasterizer_ ? rasterizer_->pipeline() : ""; }

  private:
    void cover_list(const TileWork& work, Hits& hits, CoverCounts& counts) const;
    std::vector<std::uint32_t> see_through(const Tile& tile, bool wanted) const;

    const Frame& frame_;
    const SampleTable& samples_;
    VisibilityMethod method_;
    bool blurs_;
    Culling culling_;  ///< empty: the fast path
    std::optional<Bins> bins_;
    std::unique_ptr<const Tracer> tracer_;
    std::unique_ptr<Rasterizer> rasterizer_;
    std::vector<Tile> tiles_;
};

/// Tiles of `size` that cover the limits, rows from top to bottom, each row from left to right.
std::vector<Tile> tiles_over(const PixelRect& limits, int size);

/// The samples of a picture as the method wants them.
SampleTable make_samples(const Frame& frame, int spp, const MethodSettings& method);

/// What blurs in this frame: how its samples are best grouped.
Grouping grouping_for(const Frame& frame);

}  // namespace pentaprism
