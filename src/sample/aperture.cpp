#include "sample/aperture.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>

namespace pentaprism {
namespace {

struct Polar {
    double radius, angle;
};

Polar concentric(double p, double q) {
    const double a = 2.0 * p - 1.0, b = 2.0 * q - 1.0;
    if (a == 0.0 && b == 0.0) return {0.0, 0.0};
    constexpr double quarter = glm::pi<double>() / 4.0;
    if (std::abs(a) > std::abs(b)) return {a, quarter * (b / a)};
    return {b, 2.0 * quarter - quarter * (a / b)};
}

glm::dvec2 polygon_point(Polar polar, int blades, double rotation) {
    const double turn = 2.0 * glm::pi<double>();
    double angle = polar.radius < 0.0 ? polar.angle + glm::pi<double>() : polar.angle;
    const double radius = std::abs(polar.radius);
    double sectors = angle / turn * blades;
    sectors -= blades * std::floor(sectors / blades);
    const double sector = std::floor(sectors), along = sectors - sector;
    const double a0 = rotation + turn * sector / blades, a1 = rotation + turn * (sector + 1.0) / blades;
    const glm::dvec2 corner0(std::cos(a0), std::sin(a0)), corner1(std::cos(a1), std::sin(a1));
    return radius * ((1.0 - along) * corner0 + along * corner1);
}

}  // namespace

glm::dvec2 aperture_point(const Lens& lens, double p, double q) {
    const Polar polar = concentric(p, q);
    const double rotation = lens.rotation_deg * glm::pi<double>() / 180.0;
    glm::dvec2 uv = lens.blades >= 3 ? polygon_point(polar, lens.blades, rotation)
                                     : polar.radius * glm::dvec2(std::cos(polar.angle), std::sin(polar.angle));
    uv = glm::dvec2(std::clamp(uv.x, -1.0, 1.0), std::clamp(uv.y, -1.0, 1.0));
    return {uv.x, uv.y * lens.ratio};
}

}  // namespace pentaprism
