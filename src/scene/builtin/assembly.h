#pragma once
// Puts a procedural scene together: what the recipes of the built-in scenes have in common.

#include <functional>
#include <pentaprism/scene.h>
#include <string>
#include <utility>
#include <vector>

namespace pentaprism::builtin {

/// Radians from degrees, for recipes.
constexpr double degrees(double d) {
    return d * 0.017453292519943295;
}

glm::dquat turn(glm::dvec3 axis, double angle);

/// The rotation that turns a camera or light (-z forward, y up) at `eye` towards `target`.
glm::dquat looking(glm::dvec3 eye, glm::dvec3 target, glm::dvec3 up = {0.0, 1.0, 0.0});

/// The lens as photographers give it; the field of view follows from the focal length and a sensor 36 mm wide, 16:9.
struct Lens {
    double focal_length_mm = 35.0, fstop = 2.0, focus_distance = 1.0, shutter = 0.5;
    int blades = 0;
};

class Assembly {
  public:
    Assembly(std::string name, double duration);

    Index add(Image image);
    Index add(Material material);
    Index add_mesh(std::string name, Primitive primitive);
    Index add_mesh(std::string name, std::vector<Primitive> primitives);
    Index add_node(std::string name, Index parent, const Transform& transform, Index mesh = kNone);
    Index add_camera(std::string name, const Transform& transform, const Lens& lens);
    void add_sun(std::string name, glm::dvec3 towards_light, glm::vec3 color, double lux);
    Index add_point_light(std::string name, Index parent, glm::dvec3 position, glm::vec3 color, double candela);

    /// Cubic-spline keys, `count` of them evenly over the duration, through the function and with its derivatives.
    void animate_translation(Index node, int count, const std::function<glm::dvec3(double t)>& f);
    void animate_rotation(Index node, int count, const std::function<glm::dquat(double t)>& f);
    void animate_scale(Index node, int count, const std::function<glm::dvec3(double t)>& f);

    /// The node swings about `axis` around its rest rotation: sway in the wind.
    void sway(Index node, glm::dvec3 axis, double amplitude, double period, double phase);

    Node& node(Index index) { return scene_.nodes[static_cast<std::size_t>(index)]; }
    double duration() const { return duration_; }
    Scene& scene() { return scene_; }

    /// The finished scene; the assembly is empty afterwards.
    Scene take(glm::vec3 background);

  private:
    void animate(Index node, ChannelPath path, int width, int count, const std::function<glm::dvec4(double t)>& f);

    Scene scene_;
    double duration_;
};

/// A texture as recipes use it: repeating, filtered.
TextureRef texture(Index image, glm::dvec2 scale = glm::dvec2(1.0));

/// Dull, opaque material whose colour is the vertices' own.
Material painted(std::string name, double roughness = 0.8);

/// Shows its vertices' colours from both sides, whatever the light: skies and far hills.
Material backdrop(std::string name);

}  // namespace pentaprism::builtin
