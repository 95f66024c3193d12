#pragma once
// Where samples of a cell can see a triangle, over any part of lens and segment: the fifteen-edge box
// (bound/screen_bounds.h) for the local form, the looser box by division alone, and the hull. What culling tests that
// look at the screen are made of.

#include "bound/local_triangle.h"

namespace pentaprism {

/// Closed rectangle in pixels from the cell's middle, y up; sides may be infinite. Empty: x0 > x1.
struct LocalBox {
    float x0 = 1, x1 = -1, y0 = 1, y1 = -1;
    bool empty() const { return !(x0 <= x1 && y0 <= y1); }
    /// Shares a point with the rectangle.
    bool meets(float rx0, float rx1, float ry0, float ry1) const {
        return x0 <= rx1 && x1 >= rx0 && y0 <= ry1 && y1 >= ry0;
    }
};

/// Pixels of the whole picture, in the cell's coordinates.
struct PictureRect {
    float x0, x1, y0, y1;
};

/// Holds every accepted sample of the cell whose lens and time are in the domain, rounding included. If the triangle
/// reaches the camera plane, all of the domain's samples share the box of docs/develop/algorithms.md 3.2, which the
/// exact test asks.
LocalBox local_bounds(const LocalTriangle& triangle, const SegmentDomain& domain, const PictureRect& picture);

/// Laine & Karras 2011, figure 4 (GetGammaRanges), corrected: the same without a near plane, by dividing each of the
/// six points by its w (docs/develop/algorithms.md 3.4). Unbounded to a side where points behind the camera open it,
/// and everything if a point lies at the camera plane. Holds every sample that is accepted and for which the exact test
/// computed a depth in front of the camera without rounding it there.
LocalBox gamma_ranges(const LocalTriangle& triangle, const SegmentDomain& domain);

/// A convex polygon: a sample is outside if x*nx + y*ny > h for some side.
struct HullPolygon {
    static constexpr int kMostSides = 10;
    float nx[kMostSides], ny[kMostSides], h[kMostSides];
    int count = 0;

    /// False: the whole rectangle is outside one side.
    bool meets(float x0, float x1, float y0, float y1) const {
        for (int k = 0; k < count; ++k) {
            const float x = nx[k] > 0 ? x0 : x1, y = ny[k] > 0 ? y0 : y1;  // the corner farthest inside
            if (x * nx[k] + y * ny[k] > h[k]) return false;
        }
        return true;
    }
};

/// The hull of the six points on the screen, each side moved out by the largest circle of confusion in its direction
/// (docs/develop/algorithms.md 3.5); the sides of local_bounds() among them, which are all there is for a triangle that
/// reaches the camera plane. `domain`: of the whole lens, whose samples lie in the ellipse that touches its four sides.
HullPolygon hull_polygon(const LocalTriangle& triangle, const SegmentDomain& domain, const PictureRect& picture);

}  // namespace pentaprism
