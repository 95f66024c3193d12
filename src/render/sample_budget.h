#pragma once
// How many samples each block of 4 x 4 pixels gets (--target-error): decided by a few samples of it and of the blocks
// around it that are not shown. Those that are shown are a picture's of that many samples per pixel, whatever was seen
// before: so no pixel is off in the mean, as it would be if what stopped the sampling stayed in the average.

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <pentaprism/settings.h>
#include <span>
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
    static constexpr int kPilotSpp = 4;
    /// Seed of those: another one than the picture's.
    static std::uint32_t pilot_seed(std::uint32_t seed);

    /// Samples per pixel that a block may get, ascending: each twice the one before, the last perhaps less.
    const std::vector<int>& levels() const { return levels_; }

    /// Of `all` the tiles, and in them the blocks, that must be known before `tiles` can be shared out: those of their
    /// whole cells and those around them. All tiles are cells, cut by nothing but the picture's border where it counts.
    std::vector<Tile> tiles_to_know(std::span<const Tile> tiles, std::span<const Tile> all) const;

    /// Takes note of what the tile's pilot sees. Thread-safe for different tiles.
    void note(const Tile& tile, const SampleTable& pilot, const Hits& hits, const TileShade& shade);

    /// Of each level the blocks of the tile's cell that get it, as Tile::blocks.
    std::vector<std::uint64_t> share_out(const Tile& tile) const;

    /// Each pass over a tile costs what as many samples cost more, so levels of few blocks may be left out: which of
    /// levels() the blocks of each get, never a lower one. `blocks`: how many want each.
    std::vector<std::size_t> levels_to_take(std::span<const int> blocks, double pass_cost) const;

    /// Which of levels() a block gets in which one sample has this squared error.
    std::size_t level_for(double squared_error) const;

  private:
    double error_of_block(int bx, int by, const Tile& tile, const SampleTable& pilot, const Hits& hits,
                          const TileShade& shade) const;
    double smooth_error(int bx, int by) const;
    std::size_t cell_index(int cx, int cy) const {
        return static_cast<std::size_t>(cy) * ((columns_ + kCellBlocks - 1) / kCellBlocks) + cx;
    }

    double target_, brightness_, slope_;
    glm::dvec3 background_;
    std::vector<int> levels_;
    int columns_, rows_;         // of blocks in the picture
    std::vector<float> errors_;  // of one sample, squared, by block; below 0: not known
    std::vector<int> points_;    // that the pilot shaded, by cell
};

}  // namespace pentaprism
