#include "bound/local_triangle.h"

#include <algorithm>
#include <cmath>

#include "bound/screen_bounds.h"
#include "frame/opacity.h"

namespace pentaprism {

CellCentre cell_centre(const View& view, int cx, int cy) {
    return {static_cast<float>(cx * kCellSize + kCellSize / 2) - 0.5f * static_cast<float>(view.width),
            0.5f * static_cast<float>(view.height) - static_cast<float>(cy * kCellSize + kCellSize / 2)};
}

LocalSample local_sample(const SamplePoint& sample, int px, int py) {
    constexpr float half = kCellSize / 2;
    return {static_cast<float>(px % kCellSize) - half + sample.x,
            half - (static_cast<float>(py % kCellSize) + sample.y), sample.u, sample.v, sample.t};
}

LocalTriangle localize(const Frame& frame, std::uint32_t triangle, int segment, const CellCentre& centre, float scale) {
    const Part& part = frame.parts[frame.part_of[triangle]];
    MovingTriangle m = moving_triangle(frame, triangle, segment);
    for (int i = 0; i < 3; ++i)
        for (int end = 0; end < 2; ++end) m.x[i][end] *= scale, m.y[i][end] *= scale, m.c[i][end] *= scale;
    LocalTriangle local;
    const double centre_x = centre.x, centre_y = centre.y;
    for (int i = 0; i < 3; ++i) {
        const double x = m.x[i][0], y = m.y[i][0], w = m.w[i][0], z = m.z[i][0], c = m.c[i][0];
        const double dx = m.x[i][1] - x, dy = m.y[i][1] - y, dw = m.w[i][1] - w, dz = m.z[i][1] - z, dc = m.c[i][1] - c;
        local.qx[i] = static_cast<float>(x - centre_x * w);
        local.qy[i] = static_cast<float>(y - centre_y * w);
        local.qw[i] = static_cast<float>(w);
        local.qc[i] = static_cast<float>(c);
        local.qz[i] = static_cast<float>(z);
        local.dx[i] = static_cast<float>(dx - centre_x * dw);
        local.dy[i] = static_cast<float>(dy - centre_y * dw);
        local.dw[i] = static_cast<float>(dw);
        local.dc[i] = static_cast<float>(dc);
        local.dz[i] = static_cast<float>(dz);
        // The end of the path as the exact test computes it counts, too: rounding dw may put it behind the camera plane
        // when the vertex comes from very far.
        const float end_w = local.qw[i] + local.dw[i];
        local.behind = local.behind || std::min({m.w[i][0], m.w[i][1], end_w}) < frame.view.w_near();
    }
    local.segments = static_cast<float>(part.moves ? part.segments : 1);
    local.segment = static_cast<float>(part.moves ? segment : 0);
    local.w_near = static_cast<float>(frame.view.w_near());
    local.z_near = static_cast<float>(frame.view.depth_near);
    local.z_far = static_cast<float>(frame.view.depth_far);
    local.triangle = triangle;
    local.two_sided = part.two_sided;
    local.alpha_tested = opacity_class(frame, triangle) != OpacityClass::kSolid;
    local.orthographic = !frame.view.perspective;
    if (local.behind) {
        const ScreenBox box = screen_bounds(m, frame.view.w_near(), frame.view.lens.ratio);
        local.box[0] = static_cast<float>(box.x0);
        local.box[1] = static_cast<float>(box.x1);
        local.box[2] = static_cast<float>(box.y0);
        local.box[3] = static_cast<float>(box.y1);
    }
    return local;
}

SegmentDomain segment_domain(const LocalTriangle& T, const Domain& d) {
    // The sample's own s comes from the same expression, which is monotone.
    return {d.u0,
            d.u1,
            d.v0,
            d.v1,
            std::max(0.0f, std::fma(d.t0, T.segments, -T.segment)),
            std::min(1.0f, std::fma(d.t1, T.segments, -T.segment))};
}

}  // namespace pentaprism
