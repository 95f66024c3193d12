// Which things the scene places, and where its nodes are at a time.

#include "scene/pose.h"

#include <algorithm>
#include <charconv>
#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>
#include <pentaprism/error.h>

#include "scene/keyframes.h"

namespace pentaprism {

namespace {

template <class T>
const T& at(const std::vector<T>& values, Index i) {
    return values[static_cast<std::size_t>(i)];
}

template <class T>
T& at(std::vector<T>& values, Index i) {
    return values[static_cast<std::size_t>(i)];
}

glm::dmat4 matrix_of(const Transform& transform) {
    glm::dmat4 matrix = glm::mat4_cast(transform.rotation);
    for (int column = 0; column < 3; ++column) matrix[column] *= transform.scale[column];
    matrix[3] = glm::dvec4(transform.translation, 1.0);
    return matrix;
}

void apply_channel(const Channel& channel, double time, Transform& transform, std::vector<float>& weights) {
    double value[4];
    switch (channel.path) {
        case ChannelPath::kTranslation:
            sample_channel(channel, time, std::span(value, 3));
            transform.translation = {value[0], value[1], value[2]};
            break;
        case ChannelPath::kRotation:
            sample_channel(channel, time, std::span(value, 4));
            transform.rotation = glm::dquat(value[3], value[0], value[1], value[2]);
            break;
        case ChannelPath::kScale:
            sample_channel(channel, time, std::span(value, 3));
            transform.scale = {value[0], value[1], value[2]};
            break;
        case ChannelPath::kWeights: {
            std::vector<double> values(static_cast<std::size_t>(channel.width));
            sample_channel(channel, time, values);
            weights.assign(values.begin(), values.end());
            break;
        }
        case ChannelPath::kYfov:
        case ChannelPath::kFocusDistance:
        case ChannelPath::kFstop:
            break;  // of a camera
    }
}

// Splines may swing out of what a camera can be.
void apply_channel(const Channel& channel, double time, Camera& camera) {
    constexpr double kWidestYfov = 3.1, kLeast = 1e-3;
    double value = 0.0;
    sample_channel(channel, time, std::span(&value, 1));
    if (channel.path == ChannelPath::kYfov) camera.yfov = std::clamp(value, kLeast, kWidestYfov);
    if (channel.path == ChannelPath::kFocusDistance) camera.lens.focus_distance = std::max(value, kLeast);
    if (channel.path == ChannelPath::kFstop) camera.lens.fstop = std::max(value, kLeast);
}

bool has_targets(const Mesh& mesh) {
    return std::any_of(mesh.primitives.begin(), mesh.primitives.end(),
                       [](const Primitive& p) { return !p.targets.empty(); });
}

bool is_skinned(const Scene& scene, const Placement& placement) {
    return at(scene.nodes, placement.node).skin != kNone &&
           at(at(scene.meshes, placement.mesh).primitives, placement.primitive).influences > 0;
}

}  // namespace

std::vector<Placement> placements(const Scene& scene) {
    std::vector<Placement> result;
    // A stack, for hierarchies may be deep; children are pushed in reverse so that they are met in order.
    std::vector<Index> open(scene.roots.rbegin(), scene.roots.rend());
    while (!open.empty()) {
        const Index i = open.back();
        open.pop_back();
        const Node& node = at(scene.nodes, i);
        open.insert(open.end(), node.children.rbegin(), node.children.rend());
        if (!node.visible || node.mesh == kNone) continue;
        const auto primitives = static_cast<Index>(at(scene.meshes, node.mesh).primitives.size());
        const auto instances = static_cast<Index>(node.instances.size());
        for (Index primitive = 0; primitive < primitives; ++primitive) {
            if (instances == 0) result.push_back({i, node.mesh, primitive, kNone});
            for (Index instance = 0; instance < instances; ++instance)
                result.push_back({i, node.mesh, primitive, instance});
        }
    }
    return result;
}

std::vector<Index> choose_animations(const Scene& scene, const std::string& choice) {
    std::vector<Index> chosen;
    const auto count = static_cast<Index>(scene.animations.size());
    if (choice.empty() || choice == "all") {
        for (Index i = 0; i < count; ++i) chosen.push_back(i);
        return chosen;
    }
    for (Index i = 0; i < count; ++i) {
        if (at(scene.animations, i).name == choice) return {i};
    }
    Index index = 0;
    const auto [end, problem] = std::from_chars(choice.data(), choice.data() + choice.size(), index);
    if (problem == std::errc() && end == choice.data() + choice.size() && index >= 0 && index < count) return {index};

    std::string known;
    for (const Animation& animation : scene.animations)
        known += (known.empty() ? "" : ", ") + fmt::format("\"{}\"", animation.name);
    throw Error(ErrorKind::kUsage, fmt::format("{}: there is no animation \"{}\"; there {}", scene.name, choice,
                                               known.empty() ? "are none" : (count == 1 ? "is " : "are ") + known));
}

Pose evaluate(const Scene& scene, std::span<const Index> animations, double time) {
    const std::size_t count = scene.nodes.size();
    std::vector<Transform> transforms(count);
    Pose pose;
    pose.weights.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
        const Node& node = scene.nodes[i];
        transforms[i] = node.transform;
        if (node.mesh != kNone && has_targets(at(scene.meshes, node.mesh))) {
            pose.weights[i] = node.weights.empty() ? at(scene.meshes, node.mesh).weights : node.weights;
        }
    }
    for (const Index animation : animations) {
        for (const Channel& channel : at(scene.animations, animation).channels) {
            if (channel.camera == kNone) {
                apply_channel(channel, time, at(transforms, channel.node), at(pose.weights, channel.node));
                continue;
            }
            if (pose.cameras.empty()) pose.cameras = scene.cameras;
            apply_channel(channel, time, at(pose.cameras, channel.camera));
        }
    }

    pose.world.assign(count, glm::dmat4(1.0));
    std::vector<Index> open;
    for (std::size_t i = 0; i < count; ++i) {
        if (scene.nodes[i].parent == kNone) open.push_back(static_cast<Index>(i));
    }
    while (!open.empty()) {
        const Index i = open.back();
        open.pop_back();
        const Node& node = at(scene.nodes, i);
        const glm::dmat4 local = node.matrix ? *node.matrix : matrix_of(at(transforms, i));
        at(pose.world, i) = node.parent == kNone ? local : at(pose.world, node.parent) * local;
        open.insert(open.end(), node.children.begin(), node.children.end());
    }
    return pose;
}

bool may_move(const Scene& scene, std::span<const Index> animations, const Placement& placement) {
    const auto is_animated = [&](Index node, bool weights) {
        for (const Index animation : animations) {
            for (const Channel& channel : at(scene.animations, animation).channels) {
                if (channel.node == node && (channel.path == ChannelPath::kWeights) == weights &&
                    channel.times.size() > 1)
                    return true;
            }
        }
        return false;
    };
    const auto chain_moves = [&](Index node) {
        for (; node != kNone; node = at(scene.nodes, node).parent) {
            if (is_animated(node, false)) return true;
        }
        return false;
    };
    const Primitive& primitive = at(at(scene.meshes, placement.mesh).primitives, placement.primitive);
    if (!primitive.targets.empty() && is_animated(placement.node, true)) return true;
    if (!is_skinned(scene, placement)) return chain_moves(placement.node);
    const Skin& skin = at(scene.skins, at(scene.nodes, placement.node).skin);
    return std::any_of(skin.joints.begin(), skin.joints.end(), chain_moves);
}

bool is_rigid(const Scene& scene, const Placement& placement) {
    const Primitive& primitive = at(at(scene.meshes, placement.mesh).primitives, placement.primitive);
    return primitive.targets.empty() && !is_skinned(scene, placement);
}

glm::dmat4 placement_matrix(const Scene& scene, const Pose& pose, const Placement& placement) {
    const glm::dmat4& world = at(pose.world, placement.node);
    if (placement.instance == kNone) return world;
    return world * matrix_of(at(at(scene.nodes, placement.node).instances, placement.instance));
}

bool is_mirrored(const Scene& scene, const Pose& pose, const Placement& placement) {
    if (!is_skinned(scene, placement))
        return glm::determinant(glm::dmat3(placement_matrix(scene, pose, placement))) < 0.0;
    // The node's own transform does not count for a skinned mesh: its first joint says how the body stands.
    const Skin& skin = at(scene.skins, at(scene.nodes, placement.node).skin);
    return glm::determinant(glm::dmat3(at(pose.world, skin.joints[0]) * glm::dmat4(skin.inverse_bind_matrices[0]))) <
           0.0;
}

}  // namespace pentaprism
