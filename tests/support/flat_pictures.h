#pragma once
// Pictures of what samples see and nothing else: each triangle in one grey, no shading, the plain mean over a pixel's
// samples. For measuring what a sample pattern does to a picture. cover() is the renderer's own.

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <vector>

#include "render/visibility.h"
#include "sample/net.h"

namespace pentaprism::support {

/// By the way each triangle is turned and, less, by its part: neighbours differ as they would under a lamp.
inline std::vector<float> flat_greys(const Frame& frame) {
    std::vector<float> greys(frame.triangle_count());
    for (std::uint32_t t = 0; t < greys.size(); ++t) {
        glm::dvec3 p[3];
        for (int i = 0; i < 3; ++i) {
            const glm::vec4& q = frame.points[frame.corners[3 * std::size_t{t} + i]];
            p[i] = {q.x / frame.view.fx, q.y / frame.view.fx, q.z};
        }
        const glm::dvec3 normal = glm::cross(p[1] - p[0], p[2] - p[0]);
        const double length = glm::length(normal);
        const double facing =
            length > 0.0 ? std::abs(glm::dot(normal, glm::normalize(glm::dvec3(1, 2, 1)))) / length : 0.0;
        const double of_part = mix(frame.part_of[t] + 1u) / 4294967296.0;
        greys[t] = static_cast<float>((0.15 + 0.85 * facing) * (0.5 + 0.5 * of_part));
    }
    return greys;
}

/// Row by row; `limits` as `visibility` has them, whole cells. What is hit by nothing is black.
inline std::vector<float> flat_picture(const Visibility& visibility, const SampleTable& samples,
                                       const std::vector<float>& greys, const PixelRect& limits) {
    const int width = limits.x1 - limits.x0, slots = samples.slots();
    std::vector<float> picture(static_cast<std::size_t>(width) * (limits.y1 - limits.y0));
    Hits hits;
    CoverCounts counts;
    for (const Tile& tile : visibility.tiles()) {
        visibility.cover(tile, samples, hits, counts, nullptr);
        for (int py = tile.y0; py < tile.y1; ++py)
            for (int px = tile.x0; px < tile.x1; ++px) {
                double sum = 0.0;
                for (int slot = 0; slot < slots; ++slot) {
                    const std::uint32_t seen = hits.triangle[hits.entry(px, py, slot)];
                    if (seen != kNoTriangle) sum += greys[seen];
                }
                picture[static_cast<std::size_t>(py - limits.y0) * width + (px - limits.x0)] =
                    static_cast<float>(sum / slots);
            }
    }
    return picture;
}

/// Means of blocks of `side` pixels, which divides both sides of the picture.
inline std::vector<float> block_means(const std::vector<float>& picture, int width, int side) {
    const int height = static_cast<int>(picture.size()) / width, columns = width / side;
    std::vector<float> means(static_cast<std::size_t>(columns) * (height / side));
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            means[static_cast<std::size_t>(y / side) * columns + x / side] +=
                picture[static_cast<std::size_t>(y) * width + x] / static_cast<float>(side * side);
    return means;
}

}  // namespace pentaprism::support
