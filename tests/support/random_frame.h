#pragma once
// Frames of random triangles made without a scene file: what the exact test, the references and the renderer must agree
// on.

#include <cmath>
#include <cstdint>
#include <random>

#include "frame/frame.h"

namespace pentaprism::testing {

/// What a frame of random triangles is like.
struct RandomFrame {
    int width = 48, height = 40, triangles = 40, segments = 1;
    bool perspective = true;
    double lens_radius = 0.05;             ///< metres, 0: pinhole
    double size = 0.6;                     ///< of a triangle, metres
    double speed = 0.5;                    ///< how far a vertex goes during the shutter, metres
    double nearest = 0.5, farthest = 6.0;  ///< depth of the first vertex at shutter open; may be below 0
    double thinness = 1.0;                 ///< below 1: slivers
    bool two_sided = true;
};

/// A view with a lens focused at 2 m (its numbers are such that circles of confusion of depths on a lattice of 1/64 m
/// are exact in float) and one part whose triangles share no vertices.
inline Frame make_random_frame(const RandomFrame& wanted, std::uint32_t seed) {
    Frame frame;
    View& view = frame.view;
    view.width = wanted.width;
    view.height = wanted.height;
    view.perspective = wanted.perspective;
    view.fx = view.fy = wanted.perspective ? wanted.width : wanted.width / 4.0;
    view.depth_near = 0.125;
    view.depth_far = 64.0;
    view.lens.radius = wanted.lens_radius;
    view.lens.focus_distance = wanted.lens_radius > 0.0 ? 2.0 : 0.0;
    if (wanted.lens_radius > 0.0) {
        view.lens.a = -std::round(wanted.lens_radius * view.fx * 64.0) / 64.0;
        view.lens.radius = -view.lens.a / view.fx;
        view.lens.b = -view.lens.a / view.lens.focus_distance;
    }
    view.shutter = {0.0, wanted.speed > 0.0 ? 1.0 : 0.0};

    std::mt19937 random(seed);
    const auto uniform = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    };
    Part part;
    part.triangle_count = static_cast<std::uint32_t>(wanted.triangles);
    part.vertex_count = 3 * part.triangle_count;
    part.segments = wanted.segments;
    part.moves = wanted.speed > 0.0;
    part.two_sided = wanted.two_sided;
    const int knots = part.moves ? part.segments + 1 : 1;
    frame.points.resize(static_cast<std::size_t>(knots) * part.vertex_count);
    if (!wanted.perspective) frame.depths.resize(frame.points.size());
    for (std::uint32_t triangle = 0; triangle < part.triangle_count; ++triangle) {
        glm::dvec3 corner[3], step[3];
        const double depth = uniform(wanted.nearest, wanted.farthest), reach = 0.6 * std::max(1.0, std::abs(depth));
        corner[0] = {uniform(-reach, reach), uniform(-reach, reach), depth};
        for (int i = 1; i < 3; ++i)
            corner[i] = corner[0] + glm::dvec3(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)) * wanted.size;
        if (wanted.thinness < 1.0)  // close to the line through the first two
            corner[2] =
                corner[0] + (corner[1] - corner[0]) * uniform(-1, 1) + (corner[2] - corner[0]) * wanted.thinness;
        for (int knot = 0; knot < knots; ++knot) {
            const glm::dvec3 drift = glm::dvec3(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)) * wanted.speed;
            for (int i = 0; i < 3; ++i) {
                if (knot > 0) {
                    step[i] = drift + glm::dvec3(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)) * (0.3 * wanted.speed);
                    corner[i] += step[i];
                }
                const double z = std::round(corner[i].z * 64.0) / 64.0, w = wanted.perspective ? z : 1.0;
                const std::size_t at = static_cast<std::size_t>(knot) * part.vertex_count + 3 * triangle + i;
                frame.points[at] = {static_cast<float>(corner[i].x * view.fx),
                                    static_cast<float>(corner[i].y * view.fy), static_cast<float>(w),
                                    static_cast<float>(view.lens.a + view.lens.b * z)};
                if (!wanted.perspective) frame.depths[at] = static_cast<float>(z);
            }
        }
    }
    for (std::uint32_t i = 0; i < part.vertex_count; ++i) frame.corners.push_back(i);
    frame.part_of.assign(part.triangle_count, 0);
    frame.parts.push_back(part);
    return frame;
}

}  // namespace pentaprism::testing
