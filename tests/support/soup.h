#pragma once
// Frames made of hard triangles, without a scene file: the vertex arrays are filled directly.

#include <vector>

#include "bin/bins.h"
#include "support/hard_triangles.h"

namespace pentaprism::support {

struct Soup {
    int width = 75, height = 46;
    bool motion = true, defocus = true, orthographic = false, single_sided = false;
    double ratio = 1.0;
    double magnify = 1.0;  ///< of all lengths in space: the picture stays, the numbers grow
    AlphaMode alpha = AlphaMode::kOpaque;
    int triangles = 11;  ///< of each part; one part for each of `classes`
    int segments = 0;    ///< of what moves; 0: from one to five
    std::vector<Hard> classes{kHardClasses.begin(), kHardClasses.end()};
};

/// What is_opaque_at() asks for: one mesh with one material of alpha 0.6.
inline const Scene& translucent_scene(AlphaMode mode) {
    static const auto make = [](AlphaMode alpha) {
        Scene scene;
        scene.meshes.resize(1);
        scene.meshes[0].primitives.resize(1);
        scene.materials.resize(1);
        scene.materials[0].base_color.w = 0.6f;
        scene.materials[0].alpha_mode = alpha;
        return scene;
    };
    static const Scene mask = make(AlphaMode::kMask), blend = make(AlphaMode::kBlend);
    return mode == AlphaMode::kMask ? mask : blend;
}

namespace detail {

inline void append_knot(Frame& frame, const Soup& soup, const Corners& k, int end, const CellCentre& centre,
                        double depth) {
    for (int i = 0; i < 3; ++i) {
        const double w = soup.orthographic ? 1.0 : k.w[i][end];
        const double over = soup.orthographic && k.w[i][end] != 0 ? 1.0 / k.w[i][end] : 1.0;
        const double c = soup.defocus ? k.c[i][end] * over : 0.0;
        frame.points.emplace_back(static_cast<float>(soup.magnify * (k.x[i][end] * over + centre.x * w)),
                                  static_cast<float>(soup.magnify * (k.y[i][end] * over + centre.y * w)),
                                  static_cast<float>(soup.orthographic ? 1.0 : soup.magnify * w),
                                  static_cast<float>(soup.magnify * c));
        if (soup.orthographic) frame.depths.push_back(static_cast<float>(depth + k.w[i][end]));
    }
}

}  // namespace detail

inline Frame make_soup(Random& r, const Soup& soup) {
    Frame frame;
    frame.view.width = soup.width;
    frame.view.height = soup.height;
    frame.view.perspective = !soup.orthographic;
    frame.view.lens.ratio = soup.ratio;
    frame.view.lens.radius = soup.defocus ? 0.1 : 0.0;
    frame.view.depth_near = 0.05 * soup.magnify;
    if (soup.alpha != AlphaMode::kOpaque) frame.scene = &translucent_scene(soup.alpha);
    for (const Hard hard : soup.classes) {
        Part part;
        part.first_triangle = frame.triangle_count();
        part.triangle_count = static_cast<std::uint32_t>(soup.triangles);
        part.first_point = static_cast<std::uint32_t>(frame.points.size());
        part.vertex_count = 3 * part.triangle_count;
        part.moves = soup.motion && hard != Hard::kStatic;
        if (part.moves) part.segments = soup.segments != 0 ? soup.segments : r.between(1, 5);
        part.two_sided = !soup.single_sided || r.chance(0.3);
        part.alpha_mode = soup.alpha;
        part.material = soup.alpha == AlphaMode::kOpaque ? kNone : 0;
        part.placement = {0, 0, 0, kNone};
        std::vector<std::pair<Corners, CellCentre>> placed;
        for (int t = 0; t < soup.triangles; ++t) {
            const int columns = (soup.width + kCellSize - 1) / kCellSize,
                      rows = (soup.height + kCellSize - 1) / kCellSize;
            placed.emplace_back(hard_corners(r, hard, frame.view.depth_near),
                                cell_centre(frame.view, r.below(columns), r.below(rows)));
            frame.part_of.push_back(static_cast<std::uint32_t>(frame.parts.size()));
            for (std::uint32_t i = 0; i < 3; ++i)
                frame.corners.push_back(part.first_point + 3 * static_cast<std::uint32_t>(t) + i);
        }
        // Paths to and fro between the two ends.
        for (int knot = 0; knot <= (part.moves ? part.segments : 0); ++knot)
            for (const auto& [corners, centre] : placed)
                detail::append_knot(frame, soup, corners, knot % 2, centre, 3.0 - knot);
        frame.parts.push_back(part);
    }
    return frame;
}

}  // namespace pentaprism::support
