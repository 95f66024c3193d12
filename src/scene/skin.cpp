// Vertices at a time: morph targets, then the skin or the node's matrix (glTF 2.0, 3.7.2.2 and 3.7.3.3). In double: the
// scene is where errors start, and the camera may be far from its origin.

#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <vector>

#include "scene/pose.h"

namespace pentaprism {

namespace {

/// The upper three rows of a matrix, as columns: what moves a point.
struct Affine {
    glm::dvec3 x{0.0}, y{0.0}, z{0.0}, origin{0.0};

    Affine() = default;
    explicit Affine(const glm::dmat4& m) : x(m[0]), y(m[1]), z(m[2]), origin(m[3]) {}

    void add(const Affine& other, double weight) {
        x += weight * other.x;
        y += weight * other.y;
        z += weight * other.z;
        origin += weight * other.origin;
    }
    glm::dvec3 point(const glm::dvec3& p) const { return x * p.x + y * p.y + z * p.z + origin; }

    /// Where a surface's normal points: the cofactors are the inverse transpose times the determinant, defined even
    /// without an inverse.
    glm::dvec3 normal(const glm::dvec3& n) const {
        const glm::dvec3 yz = glm::cross(y, z), zx = glm::cross(z, x), xy = glm::cross(x, y);
        const double sign = glm::dot(x, yz) < 0.0 ? -1.0 : 1.0;
        return sign * (yz * n.x + zx * n.y + xy * n.z);
    }
};

struct Parts {
    const Node& node;
    const Primitive& primitive;
    const std::vector<float>& weights;
};

Parts parts_of(const Scene& scene, const Pose& pose, const Placement& placement) {
    const Node& node = scene.nodes[static_cast<std::size_t>(placement.node)];
    const Mesh& mesh = scene.meshes[static_cast<std::size_t>(placement.mesh)];
    return {node, mesh.primitives[static_cast<std::size_t>(placement.primitive)],
            pose.weights[static_cast<std::size_t>(placement.node)]};
}

std::vector<Affine> joint_matrices(const Scene& scene, const Pose& pose, const Node& node) {
    const Skin& skin = scene.skins[static_cast<std::size_t>(node.skin)];
    std::vector<Affine> matrices;
    matrices.reserve(skin.joints.size());
    for (std::size_t i = 0; i < skin.joints.size(); ++i) {
        matrices.emplace_back(pose.world[static_cast<std::size_t>(skin.joints[i])] *
                              glm::dmat4(skin.inverse_bind_matrices[i]));
    }
    return matrices;
}

Affine blend(const std::vector<Affine>& joints, const Primitive& primitive, std::size_t vertex) {
    const auto width = static_cast<std::size_t>(primitive.influences);
    Affine sum;
    for (std::size_t k = vertex * width; k < (vertex + 1) * width; ++k) {
        if (primitive.weights[k] != 0.0f) sum.add(joints[primitive.joints[k]], primitive.weights[k]);
    }
    return sum;
}

/// Calls move(vertex, transform) for all vertices.
template <class Move>
void for_each_vertex(const Scene& scene, const Pose& pose, const Placement& placement, const Parts& parts, Move move) {
    const std::size_t count = parts.primitive.positions.size();
    if (parts.node.skin != kNone && parts.primitive.influences > 0) {
        const std::vector<Affine> joints = joint_matrices(scene, pose, parts.node);
        for (std::size_t i = 0; i < count; ++i) move(i, blend(joints, parts.primitive, i));
    } else {
        const Affine matrix(placement_matrix(scene, pose, placement));
        for (std::size_t i = 0; i < count; ++i) move(i, matrix);
    }
}

/// Adds the targets' displacements, in the order of the targets.
template <class Displacements>
void morph(const Parts& parts, std::span<glm::dvec3> values, Displacements displacements) {
    for (std::size_t t = 0; t < parts.primitive.targets.size() && t < parts.weights.size(); ++t) {
        const std::vector<glm::vec3>& moves = displacements(parts.primitive.targets[t]);
        const double weight = parts.weights[t];
        if (moves.empty() || weight == 0.0) continue;
        for (std::size_t i = 0; i < values.size(); ++i) values[i] += weight * glm::dvec3(moves[i]);
    }
}

}  // namespace

void pose_positions(const Scene& scene, const Pose& pose, const Placement& placement, std::span<glm::dvec3> out) {
    const Parts parts = parts_of(scene, pose, placement);
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = glm::dvec3(parts.primitive.positions[i]);
    morph(parts, out, [](const MorphTarget& target) -> const std::vector<glm::vec3>& { return target.positions; });
    for_each_vertex(scene, pose, placement, parts,
                    [&](std::size_t i, const Affine& transform) { out[i] = transform.point(out[i]); });
}

void pose_normals(const Scene& scene, const Pose& pose, const Placement& placement, std::span<glm::vec3> out) {
    const Parts parts = parts_of(scene, pose, placement);
    std::vector<glm::dvec3> normals(parts.primitive.normals.begin(), parts.primitive.normals.end());
    morph(parts, normals, [](const MorphTarget& target) -> const std::vector<glm::vec3>& { return target.normals; });
    for_each_vertex(scene, pose, placement, parts, [&](std::size_t i, const Affine& transform) {
        const glm::dvec3 normal = transform.normal(normals[i]);
        const double length = glm::length(normal);
        out[i] = length > 0.0 ? glm::vec3(normal / length) : parts.primitive.normals[i];
    });
}

void pose_tangents(const Scene& scene, const Pose& pose, const Placement& placement,
                   std::span<const glm::vec4> tangents, bool mirrored, std::span<glm::vec4> out) {
    const Parts parts = parts_of(scene, pose, placement);
    std::vector<glm::dvec3> moved(tangents.begin(), tangents.end());
    morph(parts, moved, [](const MorphTarget& target) -> const std::vector<glm::vec3>& { return target.tangents; });
    for_each_vertex(scene, pose, placement, parts, [&](std::size_t i, const Affine& transform) {
        const glm::dvec3 t = transform.x * moved[i].x + transform.y * moved[i].y + transform.z * moved[i].z;
        const double length = glm::length(t);
        out[i] = glm::vec4(length > 0.0 ? glm::vec3(t / length) : glm::vec3(0.0f),
                           mirrored ? -tangents[i].w : tangents[i].w);
    });
}

}  // namespace pentaprism
