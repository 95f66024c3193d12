// After MikkTSpace (Mikkelsen 2008, Simulation of Wrinkled Surfaces Revisited): a triangle's tangent is the gradient of
// u, made perpendicular to each corner's normal and summed by the corner's angle over all triangles that share the
// corner's position, normal, texture coordinates and handedness. Ours differs where one vertex serves triangles of both
// handedness: it is not split, and the larger sum of angles decides.

#include "scene/tangents.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>
#include <numeric>

namespace pentaprism {
namespace {

// Everything that makes two vertices the same place of the same surface.
using Key = std::array<float, 8>;

Key key_of(const Primitive& primitive, int texcoord, std::size_t i) {
    const glm::vec3 &p = primitive.positions[i], &n = primitive.normals[i];
    const glm::vec2& uv = primitive.texcoords[texcoord][i];
    return {p.x, p.y, p.z, n.x, n.y, n.z, uv.x, uv.y};
}

// Number of the first vertex that is equal, for each vertex.
std::vector<std::uint32_t> welded(const Primitive& primitive, int texcoord) {
    const std::size_t n = primitive.positions.size();
    std::vector<std::uint32_t> order(n), first(n);
    std::iota(order.begin(), order.end(), 0u);
    const auto compare = [&](std::uint32_t a, std::uint32_t b) {
        const Key ka = key_of(primitive, texcoord, a), kb = key_of(primitive, texcoord, b);
        return std::memcmp(ka.data(), kb.data(), sizeof ka);
    };
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
        const int c = compare(a, b);
        return c != 0 ? c < 0 : a < b;
    });
    for (std::size_t i = 0; i < n; ++i)
        first[order[i]] = i > 0 && compare(order[i], order[i - 1]) == 0 ? first[order[i - 1]] : order[i];
    return first;
}

glm::dvec3 unit_or_zero(const glm::dvec3& v) {
    const double length = glm::length(v);
    return length > 0.0 && std::isfinite(length) ? v / length : glm::dvec3(0.0);
}

glm::dvec3 any_perpendicular(const glm::dvec3& n) {
    return unit_or_zero(std::abs(n.x) < 0.9 ? glm::cross(n, glm::dvec3(1, 0, 0)) : glm::cross(n, glm::dvec3(0, 1, 0)));
}

}  // namespace

std::vector<glm::vec4> make_tangents(const Primitive& primitive, int texcoord) {
    const std::vector<glm::vec2>& uvs = primitive.texcoords[texcoord];
    const std::size_t n = primitive.positions.size();
    if (uvs.size() != n || primitive.normals.size() != n) return {};
    const std::vector<std::uint32_t> first = welded(primitive, texcoord);
    struct Sum {
        glm::dvec3 tangent{0.0};
        double angles = 0.0;
    };
    std::vector<std::array<Sum, 2>> sums(n);  // by handedness
    for (std::size_t t = 0; t + 2 < primitive.indices.size(); t += 3) {
        const std::uint32_t* v = &primitive.indices[t];
        const glm::dvec3 p[3] = {primitive.positions[v[0]], primitive.positions[v[1]], primitive.positions[v[2]]};
        const glm::dvec2 e1 = glm::dvec2(uvs[v[1]]) - glm::dvec2(uvs[v[0]]),
                         e2 = glm::dvec2(uvs[v[2]]) - glm::dvec2(uvs[v[0]]);
        const double area = e1.x * e2.y - e1.y * e2.x;
        if (area == 0.0 || !std::isfinite(area)) continue;
        const glm::dvec3 along_u =
            unit_or_zero(((p[1] - p[0]) * e2.y - (p[2] - p[0]) * e1.y) * (area > 0.0 ? 1.0 : -1.0));
        const int side = area > 0.0 ? 1 : 0;
        for (int i = 0; i < 3; ++i) {
            const glm::dvec3 normal(primitive.normals[v[i]]);
            const auto flat = [&](const glm::dvec3& d) { return unit_or_zero(d - glm::dot(d, normal) * normal); };
            const glm::dvec3 a = flat(p[(i + 1) % 3] - p[i]), b = flat(p[(i + 2) % 3] - p[i]);
            const double angle = std::acos(std::clamp(glm::dot(a, b), -1.0, 1.0));
            Sum& sum = sums[first[v[i]]][side];
            sum.tangent += angle * flat(along_u);
            sum.angles += angle;
        }
    }
    std::vector<glm::vec4> out(n);
    for (std::size_t i = 0; i < n; ++i) {
        const auto& both = sums[first[i]];
        const int side = both[1].angles > both[0].angles ? 1 : 0;
        glm::dvec3 tangent = unit_or_zero(both[side].tangent);
        if (tangent == glm::dvec3(0.0)) tangent = any_perpendicular(glm::dvec3(primitive.normals[i]));
        // v points down in the file and up in the map's own frame: a triangle whose u, v turn as its corners do has
        // its bitangent against its v.
        out[i] = glm::vec4(glm::vec3(tangent), side == 1 ? -1.0f : 1.0f);
    }
    return out;
}

}  // namespace pentaprism
