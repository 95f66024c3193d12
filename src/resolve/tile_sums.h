#pragma once
// What the samples of one tile add to a picture: sums that are whole numbers, so that tiles may come in any order, from
// any number of threads or machines and in any size, and the picture keeps each bit (docs/develop/shards.md).

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <pentaprism/settings.h>
#include <vector>

#include "base/float4.h"
#include "cover/hits.h"
#include "sample/sample_table.h"
#include "shade/tile_shade.h"

namespace pentaprism {

/// Red, green, blue, alpha, weight; multiples of 2^-32.
using PixelSums = std::array<std::int64_t, 5>;

struct TileSums {
    Tile tile{};
    int reach = 0;
    std::vector<PixelSums> sums;  ///< of the tile's pixels and a ring of `reach` around them, row by row
    std::vector<float> depth;     ///< of the tile's pixels: the closest sample
    std::vector<float> aovs;      ///< of the tile's pixels: the channels of each together

    /// Makes room for a tile, with nothing in it. `channels`: of output variables.
    void start(const Tile& of, int reach, int channels);
    int width() const { return tile.x1 - tile.x0; }
    int height() const { return tile.y1 - tile.y0; }
    PixelSums& at(int x, int y) {
        return sums[static_cast<std::size_t>(y - tile.y0 + reach) * (width() + 2 * reach) + (x - tile.x0 + reach)];
    }
    const PixelSums& at(int x, int y) const { return const_cast<TileSums*>(this)->at(x, y); }
    /// Place of one of the tile's own pixels.
    std::size_t own(int x, int y) const { return static_cast<std::size_t>(y - tile.y0) * width() + (x - tile.x0); }
};

/// Filters samples. A colour that is not finite counts as black.
class TileFilter {
  public:
    /// `background`: linear colour of samples that hit nothing; their alpha is 0.
    TileFilter(Filter filter, const glm::vec3& background);

    int reach() const { return reach_; }

    /// Adds the samples of the tile's wanted blocks to `sums`, which were started for it. Thread-safe for different
    /// sums.
    void add(const SampleTable& samples, const Hits& hits, const TileShade& shade, TileSums& sums) const;

    /// Adds one sample wherever it lies, as far as sums.reach - reach() from the tile. Unlike add() it rounds each by
    /// itself, to 2^-32.
    struct SubPixel {
        int x, y;  ///< 1/256 pixel from the picture's top left corner
    };
    void add_sample(const SubPixel& at, const glm::vec4& color, double weight, TileSums& sums) const;

  private:
    int reach_;
    glm::vec3 background_;
    std::array<Float4, 256> weights_;  // of a sample at offset / 256 of a pixel; lane i: for its neighbour i - 1
};

}  // namespace pentaprism
