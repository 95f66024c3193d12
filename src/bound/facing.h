#pragma once
// Which side of a moving, defocused triangle can be seen, over the whole shutter and lens.
//
// After Munkberg & Akenine-Moller 2011 (Backface Culling for Motion Blur and Depth of Field): the determinant as a
// Bernstein polynomial in t. Looking at the two shutter ends alone is not enough (docs/develop/algorithms.md 3.6 has
// the counterexample).

#include "bound/local_triangle.h"

namespace pentaprism {

enum class Facing : std::int8_t { kBack = -1, kMixed = 0, kFront = 1 };

/// kFront, kBack: every accepted sample sees that side, rounding included. kMixed promises nothing.
Facing facing(const MovingTriangle& triangle, double ratio);

/// The same of the samples of one cell within a part of lens and segment; here (u, v) may be anywhere in its rectangle.
Facing facing(const LocalTriangle& triangle, const SegmentDomain& domain);

}  // namespace pentaprism
