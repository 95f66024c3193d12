#include "bound/screen_bounds.h"

#include <algorithm>
#include <cmath>

namespace pentaprism {
namespace {

constexpr double kUnitRoundoff = 1.0 / 16777216.0;

struct Point {
    double x, y, w, c;
};

void add(ScreenBox& box, const Point& p, double ratio) {
    const double cx = std::abs(p.c), cy = ratio * cx, inverse = 1.0 / p.w;
    box.x0 = std::min(box.x0, (p.x - cx) * inverse);
    box.x1 = std::max(box.x1, (p.x + cx) * inverse);
    box.y0 = std::min(box.y0, (p.y - cy) * inverse);
    box.y1 = std::max(box.y1, (p.y + cy) * inverse);
    box.nearest_w = std::min(box.nearest_w, p.w);
}

}  // namespace

ScreenBox screen_bounds(const MovingTriangle& triangle, double w_near, double ratio) {
    Point points[6];
    for (int i = 0; i < 6; ++i)
        points[i] = {triangle.x[i / 2][i % 2], triangle.y[i / 2][i % 2], triangle.w[i / 2][i % 2], triangle.c[i / 2][i % 2]};
    ScreenBox box;
    bool all_in_front = true;
    for (const Point& p : points) {
        if (p.w >= w_near)
            add(box, p, ratio);
        else
            all_in_front = false;
    }
    if (!all_in_front) {
        for (int i = 0; i < 6; ++i)
            for (int j = i + 1; j < 6; ++j) {
                const Point &p = points[i], &q = points[j];
                if ((p.w >= w_near) == (q.w >= w_near)) continue;
                const double s = (w_near - p.w) / (q.w - p.w);
                add(box, {p.x + s * (q.x - p.x), p.y + s * (q.y - p.y), w_near, p.c + s * (q.c - p.c)}, ratio);
            }
    }
    if (box.empty()) return box;
    // The sheared test's terms are no larger than the unsheared ones plus the distance to the cell times w, and the cell is
    // within the picture wherever a sample is: the scale below bounds both.
    double scale_x = 0.0, scale_y = 0.0, farthest_w = 0.0;
    const double reach_x = std::max(std::abs(box.x0), std::abs(box.x1)), reach_y = std::max(std::abs(box.y0), std::abs(box.y1));
    for (const Point& p : points) {
        const double w = std::abs(p.w);
        farthest_w = std::max(farthest_w, w);
        scale_x = std::max(scale_x, std::abs(p.x) + std::abs(p.c) + w * (32.0 + std::min(reach_x, 32768.0)));
        scale_y = std::max(scale_y, std::abs(p.y) + ratio * std::abs(p.c) + w * (32.0 + std::min(reach_y, 32768.0)));
    }
    const double slack = 16.0 * kUnitRoundoff / box.nearest_w;
    box.x0 -= slack * scale_x;
    box.x1 += slack * scale_x;
    box.y0 -= slack * scale_y;
    box.y1 += slack * scale_y;
    // The exact test moves q by a rounded r - q, which may miss r by the roundoff of the larger of them.
    box.nearest_w = std::max(w_near, box.nearest_w - 2.0 * kUnitRoundoff * farthest_w);
    return box;
}

PixelRect covered_pixels(const ScreenBox& box, int width, int height, const PixelRect& limits) {
    if (box.empty()) return {};
    const double x0 = std::floor(box.x0 + 0.5 * width), x1 = std::floor(box.x1 + 0.5 * width) + 1.0;
    const double y0 = std::floor(0.5 * height - box.y1), y1 = std::floor(0.5 * height - box.y0) + 1.0;
    if (!(x0 < limits.x1 && x1 > limits.x0 && y0 < limits.y1 && y1 > limits.y0)) return {};
    return {static_cast<int>(std::max<double>(x0, limits.x0)), static_cast<int>(std::min<double>(x1, limits.x1)),
            static_cast<int>(std::max<double>(y0, limits.y0)), static_cast<int>(std::min<double>(y1, limits.y1))};
}

}  // namespace pentaprism
