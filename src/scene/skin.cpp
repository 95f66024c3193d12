// Vertices at a time: morph targets, then the skin or the node's matrix (glTF 2.0, 3.7.2.2 and 3.7.3.3). In double: the
// scene is where errors start, and the camera may be far from its origin.

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <vector>

#include "base/parallel.h"
#include "scene/pose.h"

namespace pentaprism {

namespace {

constexpr std::size_t kVerticesAtOnce = 2048;  // by one thread

/// Adds the targets' displacements of vertices [first, first + values.size()), in the order of the targets.
template <class Displacements>
void morph(const PlacedVertices& placed, std::size_t first, std::span<glm::dvec3> values, Displacements displacements) {
    const std::vector<MorphTarget>& targets = placed.primitive().targets;
    for (std::size_t t = 0; t < targets.size() && t < placed.weights().size(); ++t) {
        const std::vector<glm::vec3>& moves = displacements(targets[t]);
        const double weight = placed.weights()[t];
        if (moves.empty() || weight == 0.0) continue;
        for (std::size_t i = 0; i < values.size(); ++i) values[i] += weight * glm::dvec3(moves[first + i]);
    }
}

}  // namespace

PlacedVertices::PlacedVertices(const Scene& scene, const Pose& pose, const Placement& placement)
    : primitive_(&scene.meshes[static_cast<std::size_t>(placement.mesh)]
                      .primitives[static_cast<std::size_t>(placement.primitive)]),
      weights_(pose.weights[static_cast<std::size_t>(placement.node)]) {
    const Node& node = scene.nodes[static_cast<std::size_t>(placement.node)];
    if (node.skin == kNone || primitive_->influences == 0) {
        matrix_ = Affine(placement_matrix(scene, pose, placement));
        return;
    }
    const Skin& skin = scene.skins[static_cast<std::size_t>(node.skin)];
    joints_.reserve(skin.joints.size());
    for (std::size_t i = 0; i < skin.joints.size(); ++i)
        joints_.emplace_back(pose.world[static_cast<std::size_t>(skin.joints[i])] *
                             glm::dmat4(skin.inverse_bind_matrices[i]));
}

void PlacedVertices::positions(std::size_t first, std::span<glm::dvec3> out) const {
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = glm::dvec3(primitive_->positions[first + i]);
    morph(*this, first, out,
          [](const MorphTarget& target) -> const std::vector<glm::vec3>& { return target.positions; });
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = transform(first + i).point(out[i]);
}

void pose_positions(const Scene& scene, const Pose& pose, const Placement& placement, std::span<glm::dvec3> out) {
    const PlacedVertices placed(scene, pose, placement);
    parallel_ranges(out.size(), kVerticesAtOnce, [&](std::size_t begin, std::size_t end) {
        placed.positions(begin, out.subspan(begin, end - begin));
    });
}

void pose_normals(const Scene& scene, const Pose& pose, const Placement& placement, std::span<glm::vec3> out) {
    const PlacedVertices placed(scene, pose, placement);
    const std::vector<glm::vec3>& normals = placed.primitive().normals;
    parallel_ranges(normals.size(), kVerticesAtOnce, [&](std::size_t begin, std::size_t end) {
        std::vector<glm::dvec3> moved(normals.begin() + begin, normals.begin() + end);
        morph(placed, begin, moved,
              [](const MorphTarget& target) -> const std::vector<glm::vec3>& { return target.normals; });
        for (std::size_t i = begin; i < end; ++i) {
            const glm::dvec3 normal = placed.transform(i).normal(moved[i - begin]);
            const double length = glm::length(normal);
            out[i] = length > 0.0 ? glm::vec3(normal / length) : normals[i];
        }
    });
}

void pose_tangents(const Scene& scene, const Pose& pose, const Placement& placement,
                   std::span<const glm::vec4> tangents, bool mirrored, std::span<glm::vec4> out) {
    const PlacedVertices placed(scene, pose, placement);
    parallel_ranges(tangents.size(), kVerticesAtOnce, [&](std::size_t begin, std::size_t end) {
        std::vector<glm::dvec3> moved(tangents.begin() + begin, tangents.begin() + end);
        morph(placed, begin, moved,
              [](const MorphTarget& target) -> const std::vector<glm::vec3>& { return target.tangents; });
        for (std::size_t i = begin; i < end; ++i) {
            const glm::dvec3 t = placed.transform(i).vector(moved[i - begin]);
            const double length = glm::length(t);
            out[i] = glm::vec4(length > 0.0 ? glm::vec3(t / length) : glm::vec3(0.0f),
                               mirrored ? -tangents[i].w : tangents[i].w);
        }
    });
}

}  // namespace pentaprism
