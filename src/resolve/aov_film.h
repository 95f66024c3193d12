#pragma once
// Samples to pixels of arbitrary output variables (pentaprism/aov.h): the pixel's own samples, in index order, so that
// nothing depends on tiles or threads.

#include <memory>
#include <pentaprism/aov.h>
#include <span>
#include <vector>

#include "bound/screen_bounds.h"
#include "cover/cover.h"
#include "cover/hits.h"
#include "resolve/flow.h"
#include "resolve/flow_occlusion.h"
#include "resolve/named_ids.h"
#include "resolve/sample_order.h"
#include "resolve/surface_samples.h"
#include "resolve/tile_sums.h"
#include "shade/tile_shade.h"

namespace pentaprism {

/// What resolving looks up; outlives the film.
struct AovSources {
    const ShadingScene* scene = nullptr;
    const FrameIds* ids = nullptr;             ///< for ids and Cryptomatte, else may be null
    const Flow* flow = nullptr;                ///< for motion, else may be null
    const FlowOcclusion* occlusion = nullptr;  ///< for occlusion, else may be null
    const CoverMap* tests = nullptr;           ///< of the whole picture, for ste, else may be null
    glm::vec3 background{0.0f};
    float brightness = 1.0f;  ///< of colours in the picture: 2^exposure
};

/// One output variable of one pixel after the other: begin(), then hit() or miss() for each sample, then end().
class AovResolver {
  public:
    virtual ~AovResolver() = default;
    virtual void begin(int px, int py) = 0;
    virtual void hit(const SurfaceSample& sample, const glm::vec3& color) = 0;
    virtual void miss(const glm::vec3& background) = 0;
    /// `out` has a place for each channel of the AovInfo.
    virtual void end(float* out) = 0;
};
std::unique_ptr<AovResolver> make_resolver(Aov aov, const AovSources& sources);

/// Channels of all of them together.
int channel_count(std::span<const Aov> aovs);

/// Resolves the tiles of a frame.
class TileAovs {
  public:
    /// `delivered`: pixels outside it are left 0.
    TileAovs(std::span<const Aov> aovs, const AovSources& sources, const PixelRect& delivered);

    /// What a thread needs, kept between tiles.
    struct Worker {
        SurfaceSamples surfaces;
        SampleOrder order;
        std::vector<std::unique_ptr<AovResolver>> resolvers;
    };

    /// Fills `sums.aovs` in the wanted blocks of the tile that `sums` were started for. Thread-safe for different sums
    /// and workers.
    void resolve(const SampleTable& samples, const Hits& hits, const TileShade& shade, Worker& worker,
                 TileSums& sums) const;

  private:
    void resolve_pixel(const SampleTable& samples, const Hits& hits, const TileShade& shade, int px, int py,
                       Worker& worker, std::span<const SampleVector> vectors, float* out) const;

    std::vector<Aov> aovs_;
    AovSources sources_;
    PixelRect delivered_;
};

/// Holds a window of rows that slides down the picture, as Film does.
class AovFilm {
  public:
    /// Pixels [x0, x1) are delivered; `rows`: height of the window.
    AovFilm(int channels, int x0, int x1, int rows);

    /// The tile's pixels between the columns x0 and x1 and the rows y0 and y1. Thread-safe for different tiles.
    void add(const TileSums& tile, int y0, int y1);

    /// The channels one after the other, each width * count pixels. The span stays valid until the next call.
    std::span<const float> rows(int first, int count);

  private:
    float* pixel(int x, int y) {
        return &pixels_[(static_cast<std::size_t>(y % rows_) * width_ + (x - x0_)) * channels_];
    }

    int channels_, x0_, width_, rows_;
    std::vector<float> pixels_;  // row y at (y mod rows_); the channels of a pixel together
    std::vector<float> delivered_;
};

}  // namespace pentaprism
