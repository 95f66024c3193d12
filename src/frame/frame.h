#pragma once
// The scene posed at the shutter knots through one camera: moving triangles in raster clip space (camera/view.h). They
// are never clipped and never divided by w. The numbers stored here are the model: every later stage, the vector
// kernels and the references alike, starts from these floats.

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <memory>
#include <pentaprism/scene.h>
#include <span>
#include <vector>

#include "base/uninitialized.h"
#include "camera/view.h"
#include "scene/pose.h"
#include "scene/texture.h"

namespace pentaprism {

/// A vertex that lies between two others, `share` of the way from a to b.
struct PointOnEdge {
    std::uint32_t a = 0, b = 0;
    double share = 0.5;
};

/// One placed primitive: the triangles [first_triangle, first_triangle + triangle_count).
struct Part {
    Placement placement;
    std::uint32_t first_triangle = 0, triangle_count = 0;
    std::uint32_t first_point = 0;  ///< of knot 0; knot k follows at first_point + k * vertex_count
    std::uint32_t vertex_count = 0;
    int segments = 1;       ///< straight pieces of each path; knots at t = k / segments
    bool moves = false;     ///< false: all knots are the same points, stored once
    bool two_sided = true;  ///< false: back faces are not hit
    bool mirrored = false;  ///< corners were swapped so that front faces are counter-clockwise again
    AlphaMode alpha_mode = AlphaMode::kOpaque;
    Index material = kNone;               ///< into Scene::materials, or kNone
    std::vector<PointOnEdge> cut_points;  ///< the last vertices, which cuts added
};

/// A triangle that was cut (frame/cut_triangles.h): which of its part's Primitive it is a piece of, and where its
/// corners lie in that: barycentrics of the second and third corner.
struct Piece {
    std::uint32_t source = 0;
    glm::vec2 corner[3] = {{0.0f, 0.0f}, {1.0f, 0.0f}, {0.0f, 1.0f}};
};

struct Frame {
    const Scene* scene = nullptr;  ///< not owned; outlives the frame
    View view;
    std::vector<Part> parts;
    UninitializedVector<glm::vec4> points;       ///< x, y, w, c of each vertex at each knot of its part
    UninitializedVector<float> depths;           ///< orthographic cameras only: z of each point (else z = w)
    UninitializedVector<std::uint32_t> corners;  ///< 3 for each triangle: into `points`, at knot 0
    UninitializedVector<std::uint32_t> part_of;  ///< for each triangle: into `parts`
    std::vector<Piece> pieces;                   ///< for each triangle; empty: none is cut
    std::vector<Index> animations;               ///< clips that play
    Pose middle;                                 ///< the scene at mid-shutter, the shading time
    std::shared_ptr<const Textures> textures;    ///< set by who renders, once for all frames; null: factors alone count

    std::uint32_t triangle_count() const { return static_cast<std::uint32_t>(part_of.size()); }

    /// The corners of the triangle in its Primitive (of a piece: of all it is cut from): which vertices carry its
    /// attributes (already swapped if mirrored).
    std::array<std::uint32_t, 3> vertices(std::uint32_t triangle) const;

    /// The number in its Primitive of the triangle, or of what it is a piece of.
    std::uint32_t source(std::uint32_t triangle) const;

    /// From barycentrics of the triangle to those of vertices().
    glm::vec3 in_source(std::uint32_t triangle, const glm::vec3& barycentrics) const;
};

/// Poses the scene. Knots are uniform; `settings.motion_segments` of them or, if 0, as many (a power of two up to 64
/// for each placement) as keep straight segments within 0.1 pixel of the true paths. Triangles with a coordinate that
/// is not finite or above 1e12 are dropped at setup (bound/), not here.
Frame pose_frame(const Scene& scene, const View& view, std::span<const Index> animations,
                 const ShutterSettings& settings);

/// One segment of one triangle. Index [corner][end].
struct MovingTriangle {
    float x[3][2], y[3][2], w[3][2], c[3][2], z[3][2];
};
MovingTriangle moving_triangle(const Frame& frame, std::uint32_t triangle, int segment);

}  // namespace pentaprism
