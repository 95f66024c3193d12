#include "scene/builtin/mesh_builder.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>
#include <glm/matrix.hpp>
#include <utility>

namespace pentaprism::builtin {
namespace {

constexpr double kTwoPi = 2.0 * glm::pi<double>();

glm::dvec3 unit_or(glm::dvec3 v, glm::dvec3 otherwise) {
    const double length = glm::length(v);
    return length > 1e-30 ? v / length : otherwise;
}

// Taken a little inside the square, so that poles, where a derivative vanishes, have a normal too.
glm::dvec3 surface_normal(const Surface& p, double u, double v) {
    constexpr double kStep = 1e-4;
    u = std::clamp(u, 2.0 * kStep, 1.0 - 2.0 * kStep);
    v = std::clamp(v, 2.0 * kStep, 1.0 - 2.0 * kStep);
    const glm::dvec3 du = p(u + kStep, v) - p(u - kStep, v);
    const glm::dvec3 dv = p(u, v + kStep) - p(u, v - kStep);
    return unit_or(glm::cross(du, dv), {0.0, 1.0, 0.0});
}

}  // namespace

std::uint32_t MeshBuilder::vertex(glm::dvec3 p, glm::dvec3 n, glm::dvec2 uv, glm::dvec3 vertex_color) {
    const glm::dvec3 placed{transform * glm::dvec4(p, 1.0)};
    const glm::dvec3 normal = unit_or(glm::transpose(glm::inverse(glm::dmat3(transform))) * n, {0.0, 1.0, 0.0});
    mesh_.positions.emplace_back(placed);
    mesh_.normals.emplace_back(normal);
    mesh_.texcoords[0].emplace_back(uv * uv_scale);
    mesh_.colors.emplace_back(glm::vec4(glm::vec3(glm::clamp(vertex_color, 0.0, 1.0)), 1.0f));
    return static_cast<std::uint32_t>(mesh_.positions.size() - 1);
}

void MeshBuilder::triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    const auto& p = mesh_.positions;
    if (p[a] == p[b] || p[b] == p[c] || p[c] == p[a]) return;
    mesh_.indices.insert(mesh_.indices.end(), {a, b, c});
}

void MeshBuilder::surface(int nu, int nv, const Surface& p, const Tint& tint) {
    const auto first = static_cast<std::uint32_t>(mesh_.positions.size());
    for (int j = 0; j <= nv; ++j) {
        for (int i = 0; i <= nu; ++i) {
            const double u = double(i) / nu, v = double(j) / nv;
            const glm::dvec3 point = p(u, v);
            vertex(point, surface_normal(p, u, v), {u, v}, tint ? tint(u, v, point) : color);
        }
    }
    const auto at = [&](int i, int j) { return first + static_cast<std::uint32_t>(j * (nu + 1) + i); };
    for (int j = 0; j < nv; ++j) {
        for (int i = 0; i < nu; ++i) {
            triangle(at(i, j), at(i + 1, j), at(i + 1, j + 1));
            triangle(at(i, j), at(i + 1, j + 1), at(i, j + 1));
        }
    }
}

void MeshBuilder::tube(const std::vector<TubePoint>& points, int around, int along_count, const Tint& tint) {
    // One fixed reference direction keeps the rings from twisting; it only has to differ from the tube's direction.
    const glm::dvec3 whole = unit_or(points.back().p - points.front().p, {0.0, 1.0, 0.0});
    const glm::dvec3 reference = frame_around(whole).side;
    const Surface p = [&](double u, double v) {
        const TubePoint here = along(points, v);
        const double a = std::max(0.0, v - 1e-3), b = std::min(1.0, v + 1e-3);
        const glm::dvec3 tangent = unit_or(along(points, b).p - along(points, a).p, whole);
        const glm::dvec3 up = unit_or(glm::cross(tangent, reference), {0.0, 1.0, 0.0});
        const glm::dvec3 side = glm::cross(up, tangent);
        return here.p + here.radius * (std::cos(kTwoPi * u) * side + std::sin(kTwoPi * u) * up);
    };
    surface(around, along_count, p, tint);
}

void MeshBuilder::ellipsoid(glm::dvec3 centre, glm::dvec3 radii, int around, int along_count, const Tint& tint) {
    const Surface p = [&](double u, double v) {
        const double s = v == 0.0 || v == 1.0 ? 0.0 : std::sin(glm::pi<double>() * v);  // exactly one point at a pole
        const double a = kTwoPi * u;
        return centre + radii * glm::dvec3(s * std::sin(a), -std::cos(glm::pi<double>() * v), s * std::cos(a));
    };
    surface(around, along_count, p, tint);
}

void MeshBuilder::lathe(const std::vector<glm::dvec2>& profile, int around, int along_count, const Tint& tint) {
    std::vector<TubePoint> line;
    for (const glm::dvec2& q : profile) line.push_back({{q.x, q.y, 0.0}, 0.0});
    const Surface p = [&](double u, double v) {
        const glm::dvec3 q = along(line, v).p;
        const double a = kTwoPi * u, r = std::max(0.0, q.x);
        return glm::dvec3(r * std::sin(a), q.y, r * std::cos(a));
    };
    surface(around, along_count, p, tint);
}

void MeshBuilder::blade(const Blade& b, const Tint& tint) {
    const glm::dvec3 axis = glm::normalize(b.axis);
    const glm::dvec3 side = unit_or(glm::cross(axis, b.face), frame_around(axis).side);
    const glm::dvec3 face = glm::cross(side, axis);
    const double exponent = std::log(0.5) / std::log(std::clamp(b.widest, 0.05, 0.95));
    const Surface p = [&](double u, double v) {
        const double t = std::clamp(v, 0.0, 1.0);
        const double angle = b.bend * t;
        // A circular arc of the blade's length; straight in the limit of no bend.
        const double forward = std::abs(b.bend) < 1e-6 ? t : std::sin(angle) / b.bend;
        const double down = std::abs(b.bend) < 1e-6 ? 0.0 : (1.0 - std::cos(angle)) / b.bend;
        const glm::dvec3 middle = b.base + b.length * (forward * axis - down * face);
        const glm::dvec3 normal = std::cos(angle) * face + std::sin(angle) * axis;
        const double half = v >= 1.0 ? 0.0 : 0.5 * b.width * std::sin(glm::pi<double>() * std::pow(t, exponent));
        const double s = 2.0 * u - 1.0;
        return middle + half * (s * std::cos(b.fold) * side + std::abs(s) * std::sin(b.fold) * normal);
    };
    // Two strips that meet in the midrib: the fold is a crease, so each half has its own normals.
    for (int half = 0; half < 2; ++half) {
        const Surface strip = [&](double u, double v) { return p(0.5 * (u + half), v); };
        const Tint strip_tint = [&](double u, double v, glm::dvec3 q) {
            return tint ? tint(0.5 * (u + half), v, q) : color;
        };
        const glm::dvec2 scale = uv_scale;
        const std::size_t first = mesh_.texcoords[0].size();
        surface(1, b.segments, strip, strip_tint);
        for (std::size_t i = first; i < mesh_.texcoords[0].size(); ++i)
            mesh_.texcoords[0][i].x = 0.5f * (mesh_.texcoords[0][i].x + float(half * scale.x));
    }
}

void MeshBuilder::box(glm::dvec3 low, glm::dvec3 high) {
    const glm::dvec3 centre = 0.5 * (low + high), half = 0.5 * (high - low);
    for (int axis = 0; axis < 3; ++axis) {
        for (const double sign : {1.0, -1.0}) {
            glm::dvec3 n{0.0}, u{0.0}, v{0.0};
            n[axis] = sign;
            u[(axis + 1) % 3] = sign;
            v[(axis + 2) % 3] = 1.0;
            const auto corner = [&](double a, double b) {
                return vertex(centre + half * (n + a * u + b * v), n, {0.5 + 0.5 * a, 0.5 - 0.5 * b}, color);
            };
            const std::uint32_t p = corner(-1, -1), q = corner(1, -1), r = corner(1, 1), s = corner(-1, 1);
            triangle(p, q, r);
            triangle(p, r, s);
        }
    }
}

Primitive MeshBuilder::take(Index material) {
    mesh_.material = material;
    return std::exchange(mesh_, Primitive{});
}

TubePoint along(const std::vector<TubePoint>& points, double t) {
    const int n = static_cast<int>(points.size());
    const double s = std::clamp(t, 0.0, 1.0) * (n - 1);
    const int i = std::min(static_cast<int>(s), n - 2);
    const double f = s - i;
    const auto point = [&](int k) { return points[static_cast<std::size_t>(std::clamp(k, 0, n - 1))]; };
    const TubePoint a = point(i - 1), b = point(i), c = point(i + 1), d = point(i + 2);
    const auto spline = [f](auto p0, auto p1, auto p2, auto p3) {
        return p1 + 0.5 * f * (p2 - p0 + f * (2.0 * p0 - 5.0 * p1 + 4.0 * p2 - p3 + f * (3.0 * (p1 - p2) + p3 - p0)));
    };
    return {spline(a.p, b.p, c.p, d.p), std::max(0.0, spline(a.radius, b.radius, c.radius, d.radius))};
}

Frame frame_around(glm::dvec3 axis) {
    const glm::dvec3 helper = std::abs(axis.y) < 0.9 ? glm::dvec3(0.0, 1.0, 0.0) : glm::dvec3(1.0, 0.0, 0.0);
    const glm::dvec3 side = glm::normalize(glm::cross(helper, axis));
    return {side, glm::cross(axis, side)};
}

}  // namespace pentaprism::builtin
