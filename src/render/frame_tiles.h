#pragma once
// A frame made ready, and its tiles from their bins to sums of samples: the only code that knows the order of the
// stages.
//
//   scene -> view, frame -> bins -> [ tile: cover -> shade -> sums ]

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <pentaprism/render.h>
#include <span>

#include "render/layer_shading.h"
#include "render/sample_budget.h"
#include "render/visibility.h"
#include "resolve/aov_film.h"
#include "resolve/flow.h"
#include "resolve/named_ids.h"
#include "resolve/stored_sample.h"
#include "resolve/tile_sums.h"
#include "shade/shade_tile.h"

namespace pentaprism {

/// What a renderer keeps between frames.
struct KeptParts {
    std::shared_ptr<const Textures> textures;
    std::shared_ptr<const Environment> environment;
};

class FrameTiles {
  public:
    /// Poses, bins and prepares frame `number`. The scene must outlive this.
    FrameTiles(const Scene& scene, const KeptParts& kept, const RenderSettings& settings, double number);

    const FrameInfo& info() const { return info_; }
    const View& view() const { return frame_.view; }
    int reach() const { return filter_.reach(); }
    const std::vector<Tile>& tiles() const { return tiles_; }

    /// Tiles that must go through decide() before any of `tiles` is rendered.
    std::vector<Tile> tiles_to_decide(std::span<const Tile> tiles) const;

    /// What a thread needs to take a tile from its bin to sums, kept between tiles.
    struct Worker {
        Hits hits;
        TileShader shader;
        LayerShader layers;
        TileShade shade;
        TileAovs::Worker aovs;
        TileSums sums;
        std::vector<StoredSample> samples;
    };
    /// Thread-safe for different workers, as those that follow.
    void decide(const Tile& tile, Worker& worker);
    /// Leaves the tile in worker.sums.
    void render(const Tile& tile, Worker& worker);
    /// The same, but leaves its samples in worker.samples.
    void store(const Tile& tile, Worker& worker);

    /// All but the total time. `samples` are those of the delivered pixels in the tiles that were rendered.
    void fill(RenderStats& stats) const;

  private:
    struct Costs {
        std::atomic<std::int64_t> cover_ns{0}, shade_ns{0}, resolve_ns{0}, tested{0}, covered{0}, shaded{0}, samples{0},
            pilot_samples{0}, pixels{0}, tables_ns{0};
    };
    /// Leaves hits and colours in the worker. `to_decide`: samples that are not shown; their tests are not mapped and
    /// their colours are rough.
    void cover_and_shade(const Tile& tile, const SampleTable& samples, Worker& worker, bool to_decide);
    void cover_and_shade_layers(const Tile& tile, const SampleTable& samples, Worker& worker);
    void add_samples(const Tile& tile, const SampleTable& samples, Worker& worker);
    /// Makes it when it is asked for first.
    const SampleTable& samples_of_level(std::size_t level);
    /// Of hits that are in the worker; returns the number of points.
    std::int64_t shade(const Tile& tile, const SampleTable& samples, Worker& worker, bool roughly) const;
    int delivered_pixels(const Tile& tile) const;
    FrameInfo describe(std::span<const Index> animations, double number) const;
    void make_aovs(double number);

    RenderSettings settings_;
    TileFilter filter_;
    Frame frame_;
    std::optional<SampleBudget> budget_;                  // none: all pixels get the same number of samples
    std::optional<SampleTable> samples_;                  // of the budget: those that decide
    std::vector<std::optional<SampleTable>> for_levels_;  // of the budget's levels: those that a block got so far
    std::mutex making_;                                   // of for_levels_
    std::optional<Visibility> visibility_;
    std::vector<Tile> tiles_;
    std::optional<ShadingScene> shading_;
    bool device_shades_ = false;
    FrameInfo info_;
    std::optional<FrameIds> ids_;  // made only for output variables that need them
    std::optional<Flow> flow_;
    std::optional<FlowOcclusion> occlusion_;
    std::optional<CoverMap> tests_;
    std::optional<TileAovs> aovs_;
    Costs costs_;
    double pose_ms_ = 0, samples_ms_ = 0, bin_ms_ = 0, prepare_ms_ = 0;
};

}  // namespace pentaprism
