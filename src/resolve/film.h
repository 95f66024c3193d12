#pragma once
// Samples to pixels: pixel p = sum of N_qp / sum of D_qp over the pixels q within the filter's reach, where N_qp and
// D_qp are the sums over q's samples, in index order, of weight times colour and of weight (docs/learn/shading.md).
//
// The sums N_qp and D_qp become 64-bit integers (multiples of 2^-32) before they are added up. Integer addition does
// not depend on its order: tiles may come in any order, from any number of threads and in any size, and the picture
// keeps each bit.

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <pentaprism/render.h>
#include <pentaprism/settings.h>
#include <vector>

#include "base/float4.h"
#include "cover/hits.h"
#include "sample/sample_table.h"
#include "shade/tile_shade.h"

namespace pentaprism {

struct FilmSettings {
    int x0 = 0, y0 = 0, x1 = 0, y1 = 0;  ///< the pixels that are delivered, half open
    int band_rows = 64;                  ///< tallest run of rows whose tiles are added before the next take_rows()
    int spp = 1;
    Filter filter = Filter::kBlackmanHarris;
    glm::vec3 background{0.0f};  ///< linear colour of samples that hit nothing; their alpha is 0
    double exposure = 0.0;       ///< EV
};

/// Holds a window of rows that slides down the picture. Use: add() all tiles of a band of tile rows (in any order, from
/// any threads), take_rows(end of the band), next band. A crop that is to equal its part of the whole must render, and
/// add(), the pixels around it, too: reach() of them on each side. Pixels that are outside the picture are never added.
class Film {
  public:
    explicit Film(const FilmSettings& settings);

    int reach() const { return reach_; }

    /// Adds the samples of the tile's pixels. Thread-safe. Rows must lie in the window: at or above `take_rows`' last
    /// argument and less than band_rows below it. A colour that is not finite counts as black.
    void add(const Tile& tile, const SampleTable& samples, const Hits& hits, const TileShade& shade);

    /// Rows that no tile at or below row `rendered_to` can touch any more and that were not taken yet; all that are
    /// left once rendered_to >= y1 + reach(), or >= y1 if the picture ends there: say `last`. May be none (count 0).
    /// The spans stay valid until the next call. Call it between bands, not while tiles are added.
    PixelRows take_rows(int rendered_to, bool last);

  private:
    struct Pixel {
        std::int64_t sums[5] = {};  // red, green, blue, alpha, weight
        float depth;
    };
    struct Patch;
    Pixel& pixel(int x, int y);
    bool delivers(int x, int y) const {
        return x >= settings_.x0 && x < settings_.x1 && y >= settings_.y0 && y < settings_.y1;
    }
    void merge(const Tile& tile, const Patch& patch);

    FilmSettings settings_;
    int reach_, width_, rows_;
    int next_row_;                     // the first that was not taken
    std::array<Float4, 256> weights_;  // of a sample at offset / 256 of a pixel; lane i: for its neighbour i - 1
    std::vector<Pixel> pixels_;        // row y at (y mod rows_)
    std::vector<float> rgba_, z_;
};

}  // namespace pentaprism
