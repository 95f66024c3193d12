#pragma once
// Bounds of casters that are wholly before the light, sixteen at a time: with the lens closed a moving triangle lies
// between its six ends as they are seen. screen_bounds(), which takes all others, costs many times as much.

#include <cstdint>

#include "shade/casters.h"

namespace pentaprism {

/// Motion segments of triangles of one part.
struct CasterBatch {
    static constexpr int kLanes = Casters::kLanes;
    int count = 0;
    std::uint32_t triangle[kLanes];
    std::uint16_t segment[kLanes];
    bool mixed[kLanes];
};

/// Rectangles on the light's picture, and the least depth at which a sample may see the triangle; with the slack for
/// rounding there and here.
struct CasterBounds {
    alignas(64) float x0[CasterBatch::kLanes], x1[CasterBatch::kLanes], y0[CasterBatch::kLanes],
        y1[CasterBatch::kLanes], nearest[CasterBatch::kLanes];
};

/// A bit for each of the batch that was bounded; the others reach behind the light, or their numbers are not usable.
/// The same on every CPU target.
using BoundCasters = std::uint32_t (*)(const WorldMotion& world, const Part& part, const LightView& view,
                                       const CasterBatch& batch, CasterBounds& out);
BoundCasters bound_casters();

}  // namespace pentaprism
