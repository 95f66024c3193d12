#pragma once
// The scene at one moment: animation, node hierarchy, skins and morph targets. Everything between the file's data and
// world-space vertices; nothing here knows of cameras' projections or pixels.

#include <glm/mat4x4.hpp>
#include <pentaprism/scene.h>
#include <span>
#include <string>
#include <vector>

#include "scene/affine.h"

namespace pentaprism {

/// One primitive of one mesh, placed once. `instance` is an index into Node::instances, or kNone.
struct Placement {
    Index node = kNone, mesh = kNone, primitive = kNone, instance = kNone;
};

/// All that the shown scene places, depth first from the roots, primitives and instances in order: the order of
/// triangles in a frame, and so part of what the same input means.
std::vector<Placement> placements(const Scene& scene);

/// Which clips play. "all", a name or an index, resolved by choose_animations (throws Error(kUsage) for an unknown
/// one).
std::vector<Index> choose_animations(const Scene& scene, const std::string& choice);

/// The state of every node at one time.
struct Pose {
    std::vector<glm::dmat4> world;            ///< node to world
    std::vector<std::vector<float>> weights;  ///< morph weights in force, for each node with a morphed mesh
    std::vector<Camera> cameras;              ///< Scene::cameras at this time; empty when none is animated
};

/// Clips play once, from time 0: before the first and after the last key the nearest key holds (glTF 2.0). Rotations by
/// slerp; all arithmetic in double.
Pose evaluate(const Scene& scene, std::span<const Index> animations, double time);

/// A camera at the time of the pose.
inline const Camera& camera_at(const Scene& scene, const Pose& pose, Index camera) {
    return (pose.cameras.empty() ? scene.cameras : pose.cameras)[static_cast<std::size_t>(camera)];
}

/// False promises that the placement's world-space vertices are the same at all times.
bool may_move(const Scene& scene, std::span<const Index> animations, const Placement& placement);

/// True when the vertices follow one matrix (no skin, no morph targets): world = placement_matrix * position.
bool is_rigid(const Scene& scene, const Placement& placement);
glm::dmat4 placement_matrix(const Scene& scene, const Pose& pose, const Placement& placement);

/// True when the placement turns counter-clockwise triangles clockwise (negative determinant).
bool is_mirrored(const Scene& scene, const Pose& pose, const Placement& placement);

/// How the vertices of a placement stand at the time of a pose: morph first, then skin or matrix. A skinned mesh
/// ignores its node's own transform (glTF 2.0, 3.7.3.3). Refers to the scene and the pose.
class PlacedVertices {
  public:
    PlacedVertices(const Scene& scene, const Pose& pose, const Placement& placement);

    /// World-space positions of vertices [first, first + out.size()).
    void positions(std::size_t first, std::span<glm::dvec3> out) const;
    /// What the skin or the matrix does to a vertex.
    Affine transform(std::size_t vertex) const {
        if (joints_.empty()) return matrix_;
        const auto width = static_cast<std::size_t>(primitive_->influences);
        Affine sum;
        for (std::size_t k = vertex * width; k < (vertex + 1) * width; ++k)
            if (primitive_->weights[k] != 0.0f) sum.add(joints_[primitive_->joints[k]], primitive_->weights[k]);
        return sum;
    }
    const Primitive& primitive() const { return *primitive_; }
    /// Weights of the primitive's morph targets; may be fewer than there are targets.
    std::span<const float> weights() const { return weights_; }

  private:
    const Primitive* primitive_;
    std::span<const float> weights_;
    std::vector<Affine> joints_;  // empty: all vertices follow matrix_
    Affine matrix_;
};

/// World-space positions of all vertices of the placement; `out` has one entry for each. By all threads, as what
/// follows.
void pose_positions(const Scene& scene, const Pose& pose, const Placement& placement, std::span<glm::dvec3> out);

/// World-space normals (unit length), by the inverse transpose of the same transforms; for a mirrored placement they
/// still point to the side that is counter-clockwise in the file.
void pose_normals(const Scene& scene, const Pose& pose, const Placement& placement, std::span<glm::vec3> out);

/// World-space tangents of any length, by the same transforms as positions; `tangents`: the primitive's, one for each
/// vertex. w stays, but turns over where `mirrored`: the bitangent is cross(normal, tangent) * w.
void pose_tangents(const Scene& scene, const Pose& pose, const Placement& placement,
                   std::span<const glm::vec4> tangents, bool mirrored, std::span<glm::vec4> out);

}  // namespace pentaprism
