#pragma once
// The barycentrics that a sample sees, by the formulas of the exact test (cover/exact.h) with a corner of the triangle
// in each lane. Whether the sample is covered is decided already; here speed counts, and the last bit does not: sums of
// products are not fused, which would be a call on processors that the build does not assume.

#include "base/float4.h"
#include "bound/local_triangle.h"

namespace pentaprism {

/// One segment of a moving triangle, a corner in each of three lanes; the fourth is 0.
struct CornerLanes {
    Float4 qx, qy, qw, qc, dx, dy, dw, dc;
    float segments = 1.0f, segment = 0.0f;

    CornerLanes() = default;
    explicit CornerLanes(const LocalTriangle& t)
        : qx(lanes(t.qx)),
          qy(lanes(t.qy)),
          qw(lanes(t.qw)),
          qc(lanes(t.qc)),
          dx(lanes(t.dx)),
          dy(lanes(t.dy)),
          dw(lanes(t.dw)),
          dc(lanes(t.dc)),
          segments(t.segments),
          segment(t.segment) {}

  private:
    static Float4 lanes(const float v[3]) { return Float4{v[0], v[1], v[2], 0.0f}; }
};

struct Seen {
    Float4 barycentrics;  ///< lanes 0 to 2; sum 1; not finite for a triangle seen edge-on
    bool front;
};

inline Seen project(const CornerLanes& t, const LocalSample& s) {
    const Float4 tau = splat(s.t * t.segments - t.segment);
    const Float4 w = t.qw + tau * t.dw, c = t.qc + tau * t.dc;
    const Float4 x = t.qx + tau * t.dx + splat(s.u) * c - splat(s.hx) * w;
    const Float4 y = t.qy + tau * t.dy + splat(s.v) * c - splat(s.hy) * w;
    const Float4 x1 = __builtin_shufflevector(x, x, 1, 2, 0, 3), x2 = __builtin_shufflevector(x, x, 2, 0, 1, 3);
    const Float4 y1 = __builtin_shufflevector(y, y, 1, 2, 0, 3), y2 = __builtin_shufflevector(y, y, 2, 0, 1, 3);
    const Float4 edges = x1 * y2 - x2 * y1;
    const float sum = (edges[0] + edges[1]) + edges[2];
    return {edges / splat(sum), sum > 0.0f};
}

}  // namespace pentaprism
