#pragma once
// From tiles to the rows of the finished picture, wherever the tiles were rendered.

#include <functional>
#include <pentaprism/render.h>

#include "bound/screen_bounds.h"
#include "resolve/aov_film.h"
#include "resolve/film.h"

namespace pentaprism {

/// The pixels of a frame that are delivered, and those that must be rendered for them.
PixelRect delivered_part(const FrameInfo& info);
PixelRect rendered_part(const FrameInfo& info, int reach);

class PictureRows {
  public:
    /// Begins the frame. `exposure`: EV.
    PictureRows(const FrameInfo& info, int reach, double exposure, RowSink& sink);

    /// Calls add_tiles(first, last) for runs of `tiles`, which are tiles_over() the rendered part, and delivers the
    /// rows that are whole after each. add_tiles() calls add() for each tile of the run, from any threads.
    void assemble(std::span<const Tile> tiles, const std::function<void(std::size_t, std::size_t)>& add_tiles);
    void add(const TileSums& tile);

  private:
    void deliver(int rendered_to, bool last);

    PixelRect part_;
    bool has_aovs_;
    int band_rows_;
    Film film_;
    AovFilm aovs_;
    RowSink& sink_;
};

}  // namespace pentaprism
