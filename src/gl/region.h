#pragma once
// Part of a picture that the device renders at once: whole cells, of which only the pixels asked for are drawn.

#include "bound/screen_bounds.h"
#include "sample/sample_table.h"

namespace pentaprism::gl {

struct Region {
    int cell_x = 0, cell_y = 0, cell_columns = 0, cell_rows = 0;
    PixelRect pixels;  ///< within those cells; the framebuffer's corner is its own
    int cells() const { return cell_columns * cell_rows; }
    int width() const { return pixels.x1 - pixels.x0; }
    int height() const { return pixels.y1 - pixels.y0; }
};

}  // namespace pentaprism::gl
