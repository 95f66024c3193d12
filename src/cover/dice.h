#pragma once
// Splitting and dicing: a moving triangle becomes micropolygons whose edges are about one pixel long (Cook, Carpenter,
// Catmull 1987, The Reyes Image Rendering Architecture).
//
// A triangle is flat, so there is nothing to displace: pieces are halved until they are small, each by its own size,
// and all corners lie on one lattice of barycentric coordinates. Where two pieces of different size meet, corners of
// one lie on an edge of the other, up to the rounding of positions: at most some 1e-6 pixel of gap or overlap.

#include <functional>

#include "bound/local_bounds.h"
#include "bound/local_triangle.h"

namespace pentaprism {

/// A piece of a triangle. Its corners move on straight lines as the triangle's do; facing, depth range and number are
/// those of the triangle.
struct Micropolygon {
    LocalTriangle piece;
    LocalBox box;            ///< holds every sample that hits the piece
    float nearest_w = 0.0f;  ///< no sample sees the piece at a smaller w
};

class Dicer {
  public:
    /// Longest edge of a micropolygon in pixels, at either end of its motion through the middle of the lens. Halving
    /// leaves edges between half of it and this: about one pixel.
    static constexpr float kLongestEdge = 1.4f;

    /// `ratio`: Lens::ratio.
    Dicer(const CellCentre& centre, double ratio) : centre_(centre), ratio_(ratio) {}

    /// About sixteen micropolygons that touch (more where perspective makes one end small), as the larger piece that
    /// they are cut from. The triangle is flat, so what bounds that piece's three corners bounds all corners within.
    static constexpr float kLongestEdgeOfGroup = 4 * kLongestEdge;

    struct Visitor {
        /// A group whose box meets the window. False: its micropolygons are not wanted.
        std::function<bool(const Micropolygon& group)> enter_group = [](const Micropolygon&) { return true; };
        /// A micropolygon whose box meets the window: of the last group, or of none, a small triangle by itself.
        std::function<void(const Micropolygon& micro, bool in_group)> visit;
    };

    /// What reaches in front of the near distance is cut into 256 at most, without groups: there a size in pixels means
    /// little.
    void dice(const LocalTriangle& triangle, const LocalBox& window, const Visitor& visitor) const;

  private:
    CellCentre centre_;
    double ratio_;
};

}  // namespace pentaprism
