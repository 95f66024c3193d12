#pragma once
// How many samples each block of 4 x 4 pixels gets (--target-error): decided by a few samples of its own that are not
// shown. Those that are shown are a picture's of that many samples per pixel, whatever was seen before: so no pixel is
// off in the mean, as it would be if what stopped the sampling stayed in the average.

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <pentaprism/settings.h>
#include <vector>

#include "cover/hits.h"
#include "sample/sample_table.h"
#include "shade/tile_shade.h"

namespace pentaprism {

class SampleBudget {
  public:
    /// `background`: linear colour of samples that hit nothing.
    SampleBudget(const ImageSettings& image, Sampler sampler, const glm::vec3& background);

    /// Samples per pixel that decide.
    int pilot_spp() const { return pilot_; }
    /// Seed of those: another one than the picture's.
    static std::uint32_t pilot_seed(std::uint32_t seed);

    /// Samples per pixel that a block may get, ascending: each twice the one before, the last perhaps less.
    const std::vector<int>& levels() const { return levels_; }

    /// Of each level the tile's blocks that get it, as Tile::blocks.
    std::vector<std::uint64_t> share_out(const Tile& tile, const SampleTable& pilot, const TileShade& shade) const;

    /// Which of levels() brings one sample's squared error down to the target's.
    std::size_t level_for(double squared_error) const;

  private:
    double error_of_block(int bx, int by, const Tile& tile, const SampleTable& pilot, const TileShade& shade) const;

    int pilot_;
    double target_, brightness_, slope_;
    glm::dvec3 background_;
    std::vector<int> levels_;
};

}  // namespace pentaprism
