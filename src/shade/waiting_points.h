#pragma once
// Points of a tile between geometry and colour: they wait until sixteen of a material can be lit at once.

#include <cstdint>
#include <memory>
#include <vector>

#include "shade/light_points.h"
#include "shade/shading_scene.h"
#include "shade/tile_shade.h"

namespace pentaprism {

/// Where a point's colours are in TileShade::colors: one for each quarter of the shutter in which it is seen.
struct QuarterColors {
    static constexpr int kQuarters = ShadowMap::kSamples;
    std::uint32_t color[kQuarters] = {kBackground, kBackground, kBackground, kBackground};

    /// Makes the place when first asked.
    std::uint32_t at(int quarter, TileShade& out) {
        if (color[quarter] == kBackground) {
            color[quarter] = static_cast<std::uint32_t>(out.colors.size());
            out.colors.emplace_back();
        }
        return color[quarter];
    }
};

/// A point whose colours are to come.
struct WaitingPoint {
    std::uint32_t triangle = 0, seed = 0;
    QuarterColors colors;
    ShadowPoint shadow;  ///< `barycentrics`: the rest follows
};

/// Keeps its memory; one for each thread. What a point shows does not depend on those that wait beside it.
class WaitingPoints {
  public:
    /// No point may wait. The scene must outlive the points.
    void start(const ShadingScene& scene);

    /// One more point; the rest of it is to be filled in before the next call. Writes the colours of others when enough
    /// have come together.
    WaitingPoint& add(const BoundMaterial& material, const SurfacePoint& point, TileShade& out);

    /// Writes the colours of all that still wait.
    void finish(TileShade& out);

  private:
    struct Batch {
        PointBatch points;
        WaitingPoint waiting[PointBatch::kLanes];
    };
    void light(Batch& batch, TileShade& out);
    void write_colors(WaitingPoint& point, TileShade& out);

    const ShadingScene* scene_ = nullptr;
    bool by_quarters_ = false;                     // colours change while the shutter is open
    std::vector<std::unique_ptr<Batch>> batches_;  // of each material; made when it is first seen
    LightPoints light_points_;
    LitBatch lit_batch_;
    LitColor lit_;
    ShadowsOnTriangle shadows_;
};

}  // namespace pentaprism
