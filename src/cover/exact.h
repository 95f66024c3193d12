#pragma once
// The exact 5D coverage test, one sample at a time: the truth that every vector kernel equals bit for bit.
//
// Homogeneous edge functions (Olano & Greer 1997) on the vertices as the sample's lens position and time place them;
// the watertight tie rule and condition (N) are this project's (docs/develop/algorithms.md, 2).

#include "bound/local_triangle.h"

namespace pentaprism {

struct SampleHit {
    bool hit = false;
    float depth = 0;             ///< metres along the axis
    float barycentrics[3] = {};  ///< perspective-correct, of the triangle at the sample's time; sum 1
    bool front = true;
};

SampleHit cover_sample(const LocalTriangle& triangle, const LocalSample& sample, const CellCentre& centre);

/// The triangle as one lens position and time place it: where it stands still for all samples that share these.
/// Corner i is seen at (x, y) / w, relative to the cell's middle. z: what depth is made of.
struct PlacedTriangle {
    float x[3], y[3], w[3], z[3];
    bool in_segment = true;  ///< false: the time belongs to another segment, so nothing is hit
};
PlacedTriangle place_triangle(const LocalTriangle& triangle, float u, float v, float t);

/// cover_sample() of a sample with that lens position and time, from there on: the same bits.
SampleHit cover_placed(const LocalTriangle& triangle, const PlacedTriangle& placed, float hx, float hy,
                       const CellCentre& centre);

/// The barycentrics alone, whether or not the sample is covered: for shading and for references that found the hit
/// themselves. Values outside the triangle are possible; not finite for a degenerate one.
SampleHit project_sample(const LocalTriangle& triangle, const LocalSample& sample);

}  // namespace pentaprism
