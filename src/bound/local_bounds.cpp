#include "bound/local_bounds.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace pentaprism {
namespace {

constexpr double kUnitRoundoff = 1.0 / 16777216.0;
constexpr double kInfinity = INFINITY;

// The six points: corners at both ends of the domain's s. In double, so that all rounding is the exact test's.
struct Points {
    double x[6], y[6], w[6], c[6];
    double scale_x = 0, scale_y = 0;  // magnitudes (docs/develop/algorithms.md 4.2); |h| <= 16 in a cell
};

Points six_points(const LocalTriangle& T, const SegmentDomain& d) {
    Points p;
    const double lens_u = std::max(std::abs(d.u0), std::abs(d.u1)), lens_v = std::max(std::abs(d.v0), std::abs(d.v1));
    for (int k = 0; k < 6; ++k) {
        const int i = k / 2;
        const double s = k % 2 == 0 ? d.s0 : d.s1;
        p.x[k] = T.qx[i] + s * T.dx[i];
        p.y[k] = T.qy[i] + s * T.dy[i];
        p.w[k] = T.qw[i] + s * T.dw[i];
        p.c[k] = T.qc[i] + s * T.dc[i];
        p.scale_x = std::max(p.scale_x, std::abs(p.x[k]) + lens_u * std::abs(p.c[k]) + 17.0 * std::abs(p.w[k]));
        p.scale_y = std::max(p.scale_y, std::abs(p.y[k]) + lens_v * std::abs(p.c[k]) + 17.0 * std::abs(p.w[k]));
    }
    return p;
}

// Nearest floats outside.
float down(double v) {
    return std::nextafter(static_cast<float>(v), -INFINITY);
}
float up(double v) {
    return std::nextafter(static_cast<float>(v), INFINITY);
}

double least_w(const Points& p) {
    return *std::min_element(p.w, p.w + 6);
}

// The box the exact test asks of triangles at the camera plane, whose numbers count from the middle of the picture.
LocalBox exact_box(const LocalTriangle& T, const PictureRect& picture) {
    const double middle_x = 0.5 * (double{picture.x0} + picture.x1), middle_y = 0.5 * (double{picture.y0} + picture.y1);
    // There the sample's place is rounded once more: 2^-24 of at most 2^14 pixels.
    constexpr double kOut = 0x1p-9;
    return {down(T.box[0] + middle_x - kOut), up(T.box[1] + middle_x + kOut), down(T.box[2] + middle_y - kOut),
            up(T.box[3] + middle_y + kOut)};
}

struct Vec2 {
    double x, y;
};
bool operator==(const Vec2& a, const Vec2& b) {
    return a.x == b.x && a.y == b.y;
}
double squared_length(const Vec2& v) {
    return v.x * v.x + v.y * v.y;
}
double orient(const Vec2& a, const Vec2& b, const Vec2& c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

// The hull of six points without a branch on how many of them it has: a sorting network by angle about the lowest, then
// a test for each of the three that may be inside. Some of the six that come out may be equal.
// Network and ties are ours (McGuire et al. 2010 give theirs as a figure); docs/develop/algorithms.md 3.5 says why a
// point that is inside makes a right turn.
std::array<Vec2, 6> hull_of_six(std::array<Vec2, 6> p) {
    for (int k = 1; k < 6; ++k)
        if (p[k].y < p[0].y || (p[k].y == p[0].y && p[k].x < p[0].x)) std::swap(p[0], p[k]);
    const auto before = [&](const Vec2& a, const Vec2& b) {
        if (a == p[0] || b == p[0]) return a == p[0] && !(b == p[0]);
        const double turn = orient(p[0], a, b);
        if (turn != 0) return turn > 0;
        return squared_length({a.x - p[0].x, a.y - p[0].y}) < squared_length({b.x - p[0].x, b.y - p[0].y});
    };
    constexpr int kNetwork[9][2] = {{1, 2}, {4, 5}, {3, 5}, {3, 4}, {1, 4}, {1, 3}, {2, 5}, {2, 4}, {2, 3}};
    for (const auto& [a, b] : kNetwork)
        if (before(p[b], p[a])) std::swap(p[a], p[b]);
    const auto turns_right = [&](int a, int b, int c) { return orient(p[a], p[b], p[c]) < 0; };
    const bool keep2 = !turns_right(1, 2, 3) && !turns_right(1, 2, 4) && !turns_right(1, 2, 5);
    const bool keep3 = !turns_right(1, 3, 4) && !turns_right(1, 3, 5) && !turns_right(2, 3, 4) && !turns_right(2, 3, 5);
    const bool keep4 = !turns_right(1, 4, 5) && !turns_right(2, 4, 5) && !turns_right(3, 4, 5);
    std::array<Vec2, 6> out = p;
    if (!keep2) out[2] = out[1];
    if (!keep3) out[3] = out[2];
    if (!keep4) out[4] = out[3];
    return out;
}

void add_side(HullPolygon& polygon, float nx, float ny, double h) {
    // meets() rounds two products and a sum of numbers within a cell; pixels end at 16.
    const double rounding = 4.0 * kUnitRoundoff * (32.0 * (std::abs(double{nx}) + std::abs(double{ny})) + std::abs(h));
    polygon.nx[polygon.count] = nx;
    polygon.ny[polygon.count] = ny;
    polygon.h[polygon.count] = up(h + rounding);
    ++polygon.count;
}

}  // namespace

LocalBox local_bounds(const LocalTriangle& T, const SegmentDomain& d, const PictureRect& picture) {
    if (T.behind) return exact_box(T, picture);
    const Points p = six_points(T, d);
    double x0 = kInfinity, x1 = -kInfinity, y0 = kInfinity, y1 = -kInfinity;
    for (int k = 0; k < 6; ++k) {
        // (x + u*c)/w is a quotient of affine functions of place, u and s with w > 0: extreme at these.
        const double inverse = 1.0 / p.w[k], u0 = d.u0 * p.c[k], u1 = d.u1 * p.c[k], v0 = d.v0 * p.c[k],
                     v1 = d.v1 * p.c[k];
        x0 = std::min(x0, (p.x[k] + std::min(u0, u1)) * inverse);
        x1 = std::max(x1, (p.x[k] + std::max(u0, u1)) * inverse);
        y0 = std::min(y0, (p.y[k] + std::min(v0, v1)) * inverse);
        y1 = std::max(y1, (p.y[k] + std::max(v0, v1)) * inverse);
    }
    const double slack = 16.0 * kUnitRoundoff / least_w(p);
    return {down(x0 - slack * p.scale_x), up(x1 + slack * p.scale_x), down(y0 - slack * p.scale_y),
            up(y1 + slack * p.scale_y)};
}

namespace {

// One axis of gamma_ranges(): where the points in front and those behind say that the axis can be hit.
struct Range {
    double front0 = kInfinity, front1 = -kInfinity, back0 = kInfinity, back1 = -kInfinity;
    void add(double place, double reach, bool in_front) {
        double &low = in_front ? front0 : back0, &high = in_front ? front1 : back1;
        low = std::min(low, place - reach);
        high = std::max(high, place + reach);
    }
    // A point in front at xf and one behind at xb < xf project, in front, from xf to +infinity; xb > xf: to -infinity.
    double first() const { return back1 > front0 ? -kInfinity : front0; }
    double last() const { return front1 > back0 ? kInfinity : front1; }
};

}  // namespace

LocalBox gamma_ranges(const LocalTriangle& T, const SegmentDomain& d) {
    const LocalBox everything{-INFINITY, INFINITY, -INFINITY, INFINITY};
    const Points p = six_points(T, d);
    const double lens_u = std::max(std::abs(d.u0), std::abs(d.u1)), lens_v = std::max(std::abs(d.v0), std::abs(d.v1));
    Range x, y;
    bool any_in_front = false, at_plane = false;
    for (int k = 0; k < 6; ++k) {
        const double w = std::abs(p.w[k]);
        // Not in the print: a point with w = 0 has no place on the screen, and lost 1 to 2.5 % of such triangles' hits.
        if (!(w > 1e-7 * std::max(p.scale_x, p.scale_y))) {
            at_plane = true;
            continue;
        }
        const bool in_front = p.w[k] > 0;
        any_in_front = any_in_front || in_front;
        x.add(p.x[k] / p.w[k], (lens_u * std::abs(p.c[k]) + 16.0 * kUnitRoundoff * p.scale_x) / w, in_front);
        y.add(p.y[k] / p.w[k], (lens_v * std::abs(p.c[k]) + 16.0 * kUnitRoundoff * p.scale_y) / w, in_front);
    }
    if (at_plane) return everything;
    if (!any_in_front) return {};
    return {down(x.first()), up(x.last()), down(y.first()), up(y.last())};
}

HullPolygon hull_polygon(const LocalTriangle& T, const SegmentDomain& d, const PictureRect& picture) {
    HullPolygon polygon;
    const LocalBox box = local_bounds(T, d, picture);
    add_side(polygon, -1, 0, -box.x0);
    add_side(polygon, 1, 0, box.x1);
    add_side(polygon, 0, -1, -box.y0);
    add_side(polygon, 0, 1, box.y1);
    if (T.behind) return polygon;
    const Points p = six_points(T, d);
    std::array<Vec2, 6> on_screen;
    for (int k = 0; k < 6; ++k) on_screen[k] = {p.x[k] / p.w[k], p.y[k] / p.w[k]};
    const std::array<Vec2, 6> hull = hull_of_six(on_screen);
    for (int k = 0; k < 6; ++k) {
        const Vec2 &a = hull[k], &b = hull[(k + 1) % 6];
        const double length = std::sqrt(squared_length({b.x - a.x, b.y - a.y}));
        if (!(length > 0)) continue;
        // Any direction gives a bound, so it may be rounded; then the farthest point in it, over all of the lens.
        const float nx = static_cast<float>((b.y - a.y) / length), ny = static_cast<float>((a.x - b.x) / length);
        const double of_lens = std::sqrt(squared_length({double{d.u1} * nx, double{d.v1} * ny}));
        double h = -kInfinity;
        for (int j = 0; j < 6; ++j) h = std::max(h, (nx * p.x[j] + ny * p.y[j] + of_lens * std::abs(p.c[j])) / p.w[j]);
        const double slack = 16.0 * kUnitRoundoff * (std::abs(nx) * p.scale_x + std::abs(ny) * p.scale_y) / least_w(p);
        add_side(polygon, nx, ny, h + slack);
    }
    return polygon;
}

}  // namespace pentaprism
