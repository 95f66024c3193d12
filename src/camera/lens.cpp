#include "camera/lens.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace pentaprism {
namespace {

// A radius on the screen and how it changes with depth.
struct Radius {
    double value, slope;
};

// From 0 to 1 over `width`, without a kink; no width: at once.
Radius smooth_step(double x, double width) {
    if (!(width > 0.0) || x >= width) return {1.0, 0.0};
    const double s = std::max(x, 0.0) / width;
    return {s * s * (3.0 - 2.0 * s), 6.0 * s * (1.0 - s) / width};
}

// Sharp inside the range; beyond, blur begins over a quarter of the range's length.
Radius outside(const std::array<double, 2>& range, double z, Radius r) {
    const auto [from, to] = range;
    if (z >= from && z <= to) return {0.0, 0.0};
    const Radius share = z > to ? smooth_step(z - to, 0.25 * (to - from)) : smooth_step(from - z, 0.25 * (to - from));
    const double direction = z > to ? 1.0 : -1.0;
    return {r.value * share.value, r.slope * share.value + direction * r.value * share.slope};
}

Radius radius_at(const Lens& lens, double z, bool perspective) {
    Radius r = perspective ? Radius{lens.a / z + lens.b, -lens.a / (z * z)} : Radius{lens.a + lens.b * z, lens.b};
    if (lens.sharp_range) r = outside(*lens.sharp_range, z, r);
    if (r.value < -lens.max_foreground_px) r = {-lens.max_foreground_px, 0.0};
    return r;
}

}  // namespace

double Lens::coc(double z, bool perspective, double depth_near) const {
    if (straight()) return a + b * z;
    if (!perspective) return radius_at(*this, z, false).value;
    if (z >= depth_near) return z * radius_at(*this, z, true).value;
    const Radius r = radius_at(*this, depth_near, true);
    return depth_near * r.value + (z - depth_near) * (r.value + depth_near * r.slope);
}

void Lens::focus(double f_px) {
    stretch = 1.0;
    const double lean = radius * std::hypot(tilt.x, ratio * tilt.y);
    if (lean > 0.0) stretch = focus_distance / (focus_distance - lean);
    a = -radius * f_px * stretch;
    b = radius * f_px / focus_distance * stretch;
}

glm::dvec2 Lens::on_tilted_plane(const glm::dvec2& uv) const {
    if (tilt == glm::dvec2(0.0)) return uv;
    return uv * (focus_distance / (focus_distance - radius * glm::dot(tilt, uv)) / stretch);
}

}  // namespace pentaprism
