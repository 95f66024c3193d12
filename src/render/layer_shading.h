#pragma once
// `--transparency a-buffer`: what a sample shows is all that lies in front of the first surface without holes, one
// over the other (Porter, Duff 1984), each shaded as if it were alone: no chance decides about opacity, so what noise a
// picture has is that of lens, shutter and pixel. The reference for stochastic transparency, of which it is the mean.

#include "render/visibility.h"
#include "shade/shade_tile.h"

namespace pentaprism {

/// Keeps its memory between tiles; one for each thread.
class LayerShader {
  public:
    /// `most_in_a_pass`: as Layers takes it. The result does not depend on it.
    explicit LayerShader(int most_in_a_pass = 0) : layers_(most_in_a_pass) {}

    /// Fills `hits` with the surface at which, from the front, half of a sample's light is stopped, and `out` with a
    /// colour for each sample; w: how much of it comes from surfaces. `background`: linear colour of misses. Returns
    /// the number of points shaded.
    std::int64_t shade(const Visibility& visibility, const ShadingScene& scene, const SampleTable& samples,
                       const Tile& tile, const glm::vec3& background, Hits& hits, TileShade& out, CoverCounts& counts);

  private:
    /// Of one sample, from the front.
    struct Seen {
        glm::vec3 color{0.0f};
        float passed = 1.0f;  ///< share of the light from behind that comes through
    };
    void blend_pass(const ShadingScene& scene, const SampleTable& samples, const Tile& tile);
    void blend(std::size_t sample, const glm::vec3& color, const Fragment& fragment);
    void blend_solid(const glm::vec3& background, TileShade& out);

    Layers layers_;
    Hits solid_, layer_, half_;
    TileShader shader_;
    TileShade shaded_;
    std::vector<Seen> seen_;
    std::int64_t count_ = 0;
};

}  // namespace pentaprism
