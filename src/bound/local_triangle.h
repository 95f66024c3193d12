#pragma once
// A moving triangle sheared to the middle of one cell of a fixed grid of 32x32 pixels: the form in which the exact test
// and every culling test see it.
//
// In raster clip space X = x + u*c - gx*w cancels when the triangle is far from the middle of the picture: in float
// that puts hits up to 5.5e-5 pixel outside their edge. With g = centre + h, x' = x - centre*w is formed in double and
// rounded once, and X = x' + u*c - h*w has |h| <= 16. The grid is part of the exact test's definition, whatever the
// tile size.

#include <cstdint>

#include "frame/frame.h"
#include "sample/sample_table.h"

namespace pentaprism {

/// Position of a value at shutter fraction s of the segment: q + s * d. Index [corner].
struct LocalTriangle {
    float qx[3], qy[3], qw[3], qc[3], qz[3];
    float dx[3], dy[3], dw[3], dc[3], dz[3];
    float segments = 1, segment = 0;  ///< s = t * segments - segment; only samples with 0 <= s < 1 belong here
    float w_near = 0, z_near = 0, z_far = 0;
    std::uint32_t triangle = 0;  ///< of the frame, without its segment
    bool two_sided = true, behind = false, alpha_tested = false, orthographic = false;
    float box[4] = {0, 0, 0, 0};  ///< x0, x1, y0, y1 of screen bounds in pixels from the middle of the picture, y
                                  ///< up; asked only if `behind` (some w < w_near)
};

/// Middle of the cell in pixels from the middle of the picture, y up.
struct CellCentre {
    float x, y;
};
CellCentre cell_centre(const View& view, int cx, int cy);

/// A sample of the exact test: (hx, hy) is the offset from the cell's middle in pixels, y up; exact in float.
struct LocalSample {
    float hx, hy, u, v, t;
};
LocalSample local_sample(const SamplePoint& sample, int px, int py);

/// `scale`, a power of two: pixels a unit of the frame's x, y and c, for pictures of one frame in several sizes.
LocalTriangle localize(const Frame& frame, std::uint32_t triangle, int segment, const CellCentre& centre,
                       float scale = 1.0f);

/// Closed ranges of the lens and of s, the part of the shutter as fractions of the triangle's segment.
struct SegmentDomain {
    float u0, u1, v0, v1, s0, s1;
    bool empty() const { return !(u0 <= u1 && v0 <= v1 && s0 <= s1); }
};

/// What of the domain belongs to the triangle's segment; rounding does not move a sample out of it.
SegmentDomain segment_domain(const LocalTriangle& triangle, const Domain& domain);

}  // namespace pentaprism
