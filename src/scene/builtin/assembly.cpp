#include "scene/builtin/assembly.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

namespace pentaprism::builtin {

glm::dquat turn(glm::dvec3 axis, double angle) {
    return glm::angleAxis(angle, glm::normalize(axis));
}

glm::dquat looking(glm::dvec3 eye, glm::dvec3 target, glm::dvec3 up) {
    const glm::dvec3 back = glm::normalize(eye - target);
    const glm::dvec3 right = glm::normalize(glm::cross(up, back));
    return glm::normalize(glm::quat_cast(glm::dmat3(right, glm::cross(back, right), back)));
}

Assembly::Assembly(std::string name, double duration) : duration_(duration) {
    scene_.name = std::move(name);
    scene_.animations.push_back({"shot", {}, duration});
}

Index Assembly::add(Image image) {
    scene_.images.push_back(std::move(image));
    return static_cast<Index>(scene_.images.size() - 1);
}

Index Assembly::add(Material material) {
    scene_.materials.push_back(std::move(material));
    return static_cast<Index>(scene_.materials.size() - 1);
}

Index Assembly::add_mesh(std::string name, Primitive primitive) {
    std::vector<Primitive> one;
    one.push_back(std::move(primitive));
    return add_mesh(std::move(name), std::move(one));
}

Index Assembly::add_mesh(std::string name, std::vector<Primitive> primitives) {
    scene_.meshes.push_back({std::move(name), std::move(primitives), {}});
    return static_cast<Index>(scene_.meshes.size() - 1);
}

Index Assembly::add_node(std::string name, Index parent, const Transform& transform, Index mesh) {
    const auto index = static_cast<Index>(scene_.nodes.size());
    Node node;
    node.name = std::move(name);
    node.parent = parent;
    node.transform = transform;
    node.mesh = mesh;
    scene_.nodes.push_back(std::move(node));
    if (parent == kNone)
        scene_.roots.push_back(index);
    else
        this->node(parent).children.push_back(index);
    return index;
}

Index Assembly::add_camera(std::string name, const Transform& transform, const Lens& lens) {
    Camera camera;
    camera.name = name;
    camera.yfov = 2.0 * std::atan(18.0 / lens.focal_length_mm * 9.0 / 16.0);
    camera.znear = 0.01;
    camera.lens.focal_length_mm = lens.focal_length_mm;
    camera.lens.sensor_width_mm = 36.0;
    camera.lens.fstop = lens.fstop;
    camera.lens.focus_distance = lens.focus_distance;
    camera.lens.shutter = lens.shutter;
    if (lens.blades > 0) camera.lens.aperture_blades = lens.blades;
    scene_.cameras.push_back(std::move(camera));
    const Index index = add_node(std::move(name), kNone, transform);
    node(index).camera = static_cast<Index>(scene_.cameras.size() - 1);
    return index;
}

void Assembly::add_sun(std::string name, glm::dvec3 towards_light, glm::vec3 color, double lux) {
    Light light;
    light.name = name;
    light.kind = LightKind::kDirectional;
    light.color = color;
    light.intensity = static_cast<float>(lux);
    scene_.lights.push_back(std::move(light));
    Transform transform;
    transform.rotation = looking(towards_light, glm::dvec3(0.0));
    node(add_node(std::move(name), kNone, transform)).light = static_cast<Index>(scene_.lights.size() - 1);
}

Index Assembly::add_point_light(std::string name, Index parent, glm::dvec3 position, glm::vec3 color, double candela) {
    Light light;
    light.name = name;
    light.color = color;
    light.intensity = static_cast<float>(candela);
    scene_.lights.push_back(std::move(light));
    const Index index = add_node(std::move(name), parent, {position, {1.0, 0.0, 0.0, 0.0}, glm::dvec3(1.0)});
    node(index).light = static_cast<Index>(scene_.lights.size() - 1);
    return index;
}

void Assembly::animate(Index node, ChannelPath path, int width, int count, const std::function<glm::dvec4(double)>& f) {
    constexpr double kStep = 1e-4;  // seconds, for the derivative
    Channel channel;
    channel.node = node;
    channel.path = path;
    channel.interpolation = Interpolation::kCubicSpline;
    channel.width = width;
    for (int i = 0; i < count; ++i) {
        const double t = duration_ * i / (count - 1);
        const glm::dvec4 value = f(t), tangent = (f(t + kStep) - f(t - kStep)) / (2.0 * kStep);
        channel.times.push_back(static_cast<float>(t));
        for (const glm::dvec4& part : {tangent, value, tangent})
            for (int k = 0; k < width; ++k) channel.values.push_back(static_cast<float>(part[k]));
    }
    scene_.animations.front().channels.push_back(std::move(channel));
}

void Assembly::animate_translation(Index node, int count, const std::function<glm::dvec3(double)>& f) {
    animate(node, ChannelPath::kTranslation, 3, count, [&](double t) { return glm::dvec4(f(t), 0.0); });
    this->node(node).transform.translation = f(0.0);
}

void Assembly::animate_rotation(Index node, int count, const std::function<glm::dquat(double)>& f) {
    // q and -q are the same rotation but not the same key: stay on one side of the sphere.
    glm::dquat last = f(0.0);
    animate(node, ChannelPath::kRotation, 4, count, [&](double t) {
        glm::dquat q = f(t);
        if (glm::dot(q, last) < 0.0) q = -q;
        last = q;
        return glm::dvec4(q.x, q.y, q.z, q.w);
    });
    this->node(node).transform.rotation = f(0.0);
}

void Assembly::animate_scale(Index node, int count, const std::function<glm::dvec3(double)>& f) {
    animate(node, ChannelPath::kScale, 3, count, [&](double t) { return glm::dvec4(f(t), 0.0); });
    this->node(node).transform.scale = f(0.0);
}

void Assembly::sway(Index index, glm::dvec3 axis, double amplitude, double period, double phase) {
    const glm::dquat rest = node(index).transform.rotation;
    const int count = 1 + static_cast<int>(std::ceil(4.0 * duration_ / period));
    animate_rotation(index, count, [=](double t) {
        return turn(axis, amplitude * std::sin(2.0 * 3.141592653589793 * t / period + phase)) * rest;
    });
}

Scene Assembly::take(glm::vec3 background) {
    scene_.background = background;
    return std::move(scene_);
}

TextureRef texture(Index image, glm::dvec2 scale) {
    TextureRef ref;
    ref.image = image;
    ref.scale = glm::vec2(scale);
    return ref;
}

Material painted(std::string name, double roughness) {
    Material material;
    material.name = std::move(name);
    material.metallic = 0.0f;
    material.roughness = static_cast<float>(roughness);
    return material;
}

Material backdrop(std::string name) {
    Material material;
    material.name = std::move(name);
    material.unlit = true;
    material.double_sided = true;
    return material;
}

}  // namespace pentaprism::builtin
