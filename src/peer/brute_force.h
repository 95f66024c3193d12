#pragma once
// The reference without a data structure: every triangle of the frame against one sample, in double precision.
//
// The frame's floats are taken as exact (they are the model, frame/frame.h); from there on the coverage test of
// docs/develop/algorithms.md 2.1 is evaluated in double, in global raster clip space: no cells, no vectors, no culling.
// Only alpha masks ask the renderer's own code, at the renderer's barycentrics, so that a mask's edge is the same edge.

#include <cstdint>
#include <limits>
#include <vector>

#include "cover/hits.h"
#include "frame/opacity.h"
#include "sample/sample_table.h"

namespace pentaprism {

/// A sample with its place in the picture. (gx, gy): pixels from the middle of the picture, y up; exact.
struct PlacedSample {
    SamplePoint point;
    int px = 0, py = 0, index = 0;
    OpacityPattern pattern{1, 0};
    double gx = 0, gy = 0, u = 0, v = 0, t = 0;
};
PlacedSample place_sample(const View& view, const SampleTable& table, int px, int py, int index);
PlacedSample place_sample(const View& view, const SamplePoint& point, int px, int py, int index,
                          const OpacityPattern& pattern);

struct ExactHit {
    std::uint32_t triangle = kNoTriangle;
    double depth = std::numeric_limits<double>::infinity();
    double barycentrics[3] = {0, 0, 0};
    bool front = true;
    bool hit() const { return triangle != kNoTriangle; }
};

/// The one triangle, in the segment that holds the sample's time. Facing and depth range are honoured, alpha is not.
ExactHit cover_in_double(const Frame& frame, std::uint32_t triangle, const PlacedSample& sample);

/// False where the surface is cut out or blended away at this sample (frame/opacity.h).
bool is_opaque(const Frame& frame, std::uint32_t triangle, const PlacedSample& sample);

/// The nearest of `candidates`, or of all triangles of the frame. Equal depths: the lower triangle.
ExactHit nearest_in_double(const Frame& frame, const std::vector<std::uint32_t>& candidates,
                           const PlacedSample& sample);
ExactHit nearest_in_double(const Frame& frame, const PlacedSample& sample);

/// Distance in pixels from the sample to the outline of the triangle as the sample's lens position and time show it,
/// cut to the camera's depth range; +infinity when nothing of it lies in that range.
double distance_to_outline(const Frame& frame, std::uint32_t triangle, const PlacedSample& sample);

/// Every sample of a small picture: entry (py * width + px) * spp + index.
std::vector<ExactHit> render_brute_force(const Frame& frame, const SampleTable& table);

}  // namespace pentaprism
