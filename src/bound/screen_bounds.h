#pragma once
// Where on the screen a moving, defocused triangle can be seen: conservative for every (u, v, t), at and behind the
// camera plane too.
//
// The fifteen-edge box: McGuire, Enderton, Shirley, Luebke 2010 conjectured it, docs/develop/algorithms.md 3.2 proves
// it.

#include <glm/vec2.hpp>

#include "frame/frame.h"

namespace pentaprism {

/// Closed rectangle in pixels from the middle of the picture, y up. Empty: x0 > x1.
struct ScreenBox {
    double x0 = 1e300, x1 = -1e300, y0 = 1e300, y1 = -1e300;
    double nearest_w = 1e300;  ///< smallest w of the part in front of w_near; >= w_near
    bool empty() const { return !(x0 <= x1); }
};

/// Holds every (gx, gy) at which some (u, v, t) of lens and segment can be hit. `ratio`: Lens::ratio. Includes the
/// slack for the exact test's rounding.
ScreenBox screen_bounds(const MovingTriangle& triangle, double w_near, double ratio);

/// Half-open rectangle of pixels, y down.
struct PixelRect {
    int x0 = 0, x1 = 0, y0 = 0, y1 = 0;
    bool empty() const { return x0 >= x1 || y0 >= y1; }
};

/// The pixels that have samples in the box, cut to `limits`; rejects before it clamps.
PixelRect covered_pixels(const ScreenBox& box, int width, int height, const PixelRect& limits);

}  // namespace pentaprism
