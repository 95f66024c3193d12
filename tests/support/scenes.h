#pragma once
// Small scenes built in code: a camera and a few animated objects.

#include <pentaprism/scene.h>
#include <string>
#include <vector>

namespace pentaprism::support {

/// Appends a visible root node and returns its index.
inline Index add_node(Scene& scene, const std::string& name, const glm::dvec3& place) {
    Node node;
    node.name = name;
    node.transform.translation = place;
    scene.nodes.push_back(node);
    const Index index = static_cast<Index>(scene.nodes.size()) - 1;
    scene.roots.push_back(index);
    return index;
}

/// A camera that looks along -z from `place`.
inline Index add_camera(Scene& scene, const std::string& name, const glm::dvec3& place, const Camera& camera = {}) {
    const Index node = add_node(scene, name, place);
    scene.cameras.push_back(camera);
    scene.cameras.back().name = name + " camera";
    scene.nodes[node].camera = static_cast<Index>(scene.cameras.size()) - 1;
    return node;
}

/// A square in the xy plane, side 2 * `half`, that faces +z.
inline Index add_square(Scene& scene, const std::string& name, const glm::dvec3& place, float half) {
    Primitive square;
    square.positions = {{-half, -half, 0}, {half, -half, 0}, {half, half, 0}, {-half, half, 0}};
    square.normals.assign(4, {0, 0, 1});
    square.indices = {0, 1, 2, 0, 2, 3};
    Mesh mesh;
    mesh.primitives.push_back(square);
    scene.meshes.push_back(mesh);
    const Index node = add_node(scene, name, place);
    scene.nodes[node].mesh = static_cast<Index>(scene.meshes.size()) - 1;
    return node;
}

/// Linear keys of one property of a node, in the scene's only clip.
inline void animate(Scene& scene, Index node, ChannelPath path, const std::vector<float>& times,
                    const std::vector<float>& values) {
    if (scene.animations.empty()) scene.animations.emplace_back();
    Channel channel;
    channel.node = node;
    channel.path = path;
    channel.width = path == ChannelPath::kRotation ? 4 : 3;
    channel.times = times;
    channel.values = values;
    scene.animations[0].channels.push_back(channel);
    scene.animations[0].duration = std::max(scene.animations[0].duration, static_cast<double>(times.back()));
}

}  // namespace pentaprism::support
