#include "scene/polygon.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

namespace pentaprism {

namespace {

using Triangle = std::array<std::uint32_t, 3>;

/// Clipping an ear looks at all corners: beyond this many a concave polygon becomes a fan rather than a wait.
constexpr std::size_t kMostCornersToClip = 1024;

/// The polygon's plane by Newell's sums, and the corners in it, counter-clockwise.
std::vector<glm::dvec2> flatten(std::span<const glm::vec3> corners) {
    glm::dvec3 normal(0.0);
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const glm::dvec3 a(corners[i]), b(corners[(i + 1) % corners.size()]);
        normal += glm::cross(a - glm::dvec3(corners[0]), b - glm::dvec3(corners[0]));
    }
    // Dropping the normal's largest coordinate keeps the shape; the order of the other two keeps the winding.
    int drop = 0;
    for (int k = 1; k < 3; ++k) {
        if (std::abs(normal[k]) > std::abs(normal[drop])) drop = k;
    }
    int u = (drop + 1) % 3, v = (drop + 2) % 3;
    if (normal[drop] < 0.0) std::swap(u, v);
    std::vector<glm::dvec2> flat;
    for (const glm::vec3& corner : corners) flat.emplace_back(corner[u], corner[v]);
    return flat;
}

double turn(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

bool is_convex(const std::vector<glm::dvec2>& p) {
    for (std::size_t i = 0; i < p.size(); ++i) {
        if (turn(p[i], p[(i + 1) % p.size()], p[(i + 2) % p.size()]) < 0.0) return false;
    }
    return true;
}

std::vector<Triangle> fan(std::size_t corners) {
    std::vector<Triangle> triangles;
    for (std::uint32_t i = 1; i + 1 < corners; ++i) triangles.push_back({0, i, i + 1});
    return triangles;
}

/// No other corner lies in the triangle before, i, after.
bool is_ear(const std::vector<glm::dvec2>& p, const std::vector<std::uint32_t>& ring, std::size_t i) {
    const std::size_t n = ring.size();
    const auto &a = p[ring[(i + n - 1) % n]], &b = p[ring[i]], &c = p[ring[(i + 1) % n]];
    if (turn(a, b, c) <= 0.0) return false;
    for (std::size_t k = 0; k < n; ++k) {
        const auto& q = p[ring[k]];
        if (q == a || q == b || q == c) continue;
        if (turn(a, b, q) >= 0.0 && turn(b, c, q) >= 0.0 && turn(c, a, q) >= 0.0) return false;
    }
    return true;
}

std::vector<Triangle> clip_ears(const std::vector<glm::dvec2>& p) {
    std::vector<std::uint32_t> ring(p.size());
    for (std::size_t i = 0; i < ring.size(); ++i) ring[i] = static_cast<std::uint32_t>(i);
    std::vector<Triangle> triangles;
    while (ring.size() > 3) {
        std::size_t ear = 0;
        while (ear < ring.size() && !is_ear(p, ring, ear)) ++ear;
        if (ear == ring.size()) ear = 1;  // not simple: any cut is as good
        const std::size_t n = ring.size();
        triangles.push_back({ring[(ear + n - 1) % n], ring[ear], ring[(ear + 1) % n]});
        ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(ear));
    }
    triangles.push_back({ring[0], ring[1], ring[2]});
    return triangles;
}

}  // namespace

std::vector<Triangle> triangulate_polygon(std::span<const glm::vec3> corners) {
    if (corners.size() < 3) return {};
    if (corners.size() == 3) return {{0, 1, 2}};
    const std::vector<glm::dvec2> flat = flatten(corners);
    return corners.size() > kMostCornersToClip || is_convex(flat) ? fan(corners.size()) : clip_ears(flat);
}

}  // namespace pentaprism
