#pragma once
// Samples to pixels: pixel p = sum of N_qp / sum of D_qp over the pixels q within the filter's reach, where N_qp and
// D_qp are the sums over q's samples, in index order, of weight times colour and of weight (docs/learn/shading.md).
//
// The sums N_qp and D_qp become 64-bit integers (multiples of 2^-32) before they are added up. Integer addition does
// not depend on its order: tiles may come in any order, from any number of threads and in any size, and the picture
// keeps each bit.

#include <cstdint>
#include <limits>
#include <pentaprism/render.h>
#include <vector>

#include "base/uninitialized.h"
#include "resolve/tile_sums.h"

namespace pentaprism {

struct FilmSettings {
    int x0 = 0, y0 = 0, x1 = 0, y1 = 0;  ///< the pixels that are delivered, half open
    int band_rows = 64;                  ///< tallest run of rows whose tiles are added before the next take_rows()
    int reach = 1;                       ///< of the filter, pixels
    double exposure = 0.0;               ///< EV
};

/// Holds a window of rows that slides down the picture. Use: add() all tiles of a band of tile rows (in any order, from
/// any threads), take_rows(end of the band), next band. A crop that is to equal its part of the whole must render, and
/// add(), the pixels around it, too: reach of them on each side. Pixels that are outside the picture are never added.
class Film {
  public:
    explicit Film(const FilmSettings& settings);

    /// Adds a tile of the same reach. Thread-safe. Rows must lie in the window: at or above `take_rows`' last argument
    /// and less than band_rows below it.
    void add(const TileSums& tile);

    /// Rows that no tile at or below row `rendered_to` can touch any more and that were not taken yet; all that are
    /// left once rendered_to >= y1 + reach, or >= y1 if the picture ends there: say `last`. May be none (count 0), and
    /// no more than `most`: then call it again. The spans stay valid until the next call. Call it between bands, not
    /// while tiles are added.
    PixelRows take_rows(int rendered_to, bool last, int most = std::numeric_limits<int>::max());

  private:
    struct Pixel {
        PixelSums sums;
        float depth;
    };
    static constexpr Pixel kNothing{{}, std::numeric_limits<float>::infinity()};
    Pixel& pixel(int x, int y);

    FilmSettings settings_;
    int width_, rows_;
    int next_row_;                       // the first that was not taken
    UninitializedVector<Pixel> pixels_;  // row y at (y mod rows_)
    UninitializedVector<float> rgba_, z_;
};

}  // namespace pentaprism
