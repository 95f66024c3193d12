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

// Blades whose outline, at the angle a from the middle of a blade, is (1 - k) times the polygon's radius and k times
// the disk's: R(a) = (1 - k)*c/cos(a) + k with c = cos(pi / blades). Its sector has the area of half the integral of
// R^2,
//   F(a) = (1 - k)^2*c^2*tan(a) + 2*k*(1 - k)*c*ln((1 + sin(a)) / cos(a)) + k^2*a,
// so a uniform share of the sector is at the angle where F has that share. F is odd and convex for a > 0: Newton's
// steps from the sector's end fall towards the root and never pass it.
double rounded_angle(double share, double k, double half_sector) {
    const double c = std::cos(half_sector), straight = (1.0 - k) * c;
    const auto area = [&](double a) {
        return straight * straight * std::tan(a) + 2.0 * k * straight * std::log((1.0 + std::sin(a)) / std::cos(a)) +
               k * k * a;
    };
    const double wanted = std::abs(2.0 * share - 1.0) * area(half_sector);
    double a = half_sector;
    for (int i = 0; i < 40; ++i) {
        const double radius = straight / std::cos(a) + k, step = (area(a) - wanted) / (radius * radius);
        a -= step;
        if (!(step > 1e-15)) break;
    }
    return std::copysign(std::clamp(a, 0.0, half_sector), 2.0 * share - 1.0);
}

glm::dvec2 polygon_point(Polar polar, int blades, double rotation, double roundness) {
    const double turn = 2.0 * glm::pi<double>();
    double angle = polar.radius < 0.0 ? polar.angle + glm::pi<double>() : polar.angle;
    const double radius = std::abs(polar.radius);
    double sectors = angle / turn * blades;
    sectors -= blades * std::floor(sectors / blades);
    const double sector = std::floor(sectors), along = sectors - sector;
    if (roundness > 0.0) {
        const double half_sector = 0.5 * turn / blades, a = rounded_angle(along, roundness, half_sector);
        const double outline = (1.0 - roundness) * std::cos(half_sector) / std::cos(a) + roundness;
        const double direction = rotation + turn * (sector + 0.5) / blades + a;
        return radius * outline * glm::dvec2(std::cos(direction), std::sin(direction));
    }
    const double a0 = rotation + turn * sector / blades, a1 = rotation + turn * (sector + 1.0) / blades;
    const glm::dvec2 corner0(std::cos(a0), std::sin(a0)), corner1(std::cos(a1), std::sin(a1));
    return radius * ((1.0 - along) * corner0 + along * corner1);
}

glm::dvec2 on_lens(const Lens& lens, const glm::dvec2& uv) {
    return lens.on_tilted_plane({std::clamp(uv.x, -1.0, 1.0), std::clamp(uv.y, -1.0, 1.0) * lens.ratio});
}

}  // namespace

glm::dvec2 aperture_point(const Lens& lens, double p, double q) {
    const double rotation = lens.rotation_deg * glm::pi<double>() / 180.0;
    if (lens.image) {
        const glm::dvec2 uv = lens.image->point(p, q);
        const double c = std::cos(rotation), s = std::sin(rotation);
        return on_lens(lens, {c * uv.x - s * uv.y, s * uv.x + c * uv.y});
    }
    const Polar polar = concentric(p, q);
    return on_lens(lens, lens.blades >= 3 ? polygon_point(polar, lens.blades, rotation, lens.roundness)
                                          : polar.radius * glm::dvec2(std::cos(polar.angle), std::sin(polar.angle)));
}

}  // namespace pentaprism
