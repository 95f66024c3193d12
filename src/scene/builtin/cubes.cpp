// cubes: four boxes with hard-edged textures tumble over a checkered floor, fifty triangles in all. Few, large
// triangles that cross the camera's plane, and textures that show every error of filtering: the opposite of the forest.

#include <cmath>

#include "scene/builtin/assembly.h"
#include "scene/builtin/mesh_builder.h"
#include "scene/builtin/recipes.h"
#include "scene/builtin/textures.h"

namespace pentaprism::builtin {
namespace {

void add_floor(Assembly& cubes) {
    constexpr double kHalf = 30.0, kSquare = 0.16;  // metres
    Material material = painted("checkered floor", 0.45);
    const Index image = cubes.add(checker_texture("floor", 128, 8, {0.02, 0.035, 0.05}, {0.78, 0.74, 0.66}));
    material.base_color_texture = texture(image, glm::dvec2(2.0 * kHalf / (8.0 * kSquare)));
    MeshBuilder m;
    const auto corner = [&](double x, double z) {
        return m.vertex({kHalf * x, 0.0, kHalf * z}, {0.0, 1.0, 0.0}, {0.5 * (x + 1.0), 0.5 * (z + 1.0)}, m.color);
    };
    const std::uint32_t a = corner(-1, 1), b = corner(1, 1), c = corner(1, -1), d = corner(-1, -1);
    m.triangle(a, b, c);
    m.triangle(a, c, d);
    cubes.add_node("floor", kNone, {}, cubes.add_mesh("floor", m.take(cubes.add(material))));
}

struct Box {
    const char* name;
    Image image;
    double size;
    glm::dvec3 centre, swing;  ///< it goes to and fro, and up and down twice as often
    double pace, phase;        ///< radians per second, radians
    glm::dvec3 axis;
    double spin;  ///< radians per second
};

void add_box(Assembly& cubes, Box box) {
    Material material = painted(box.name, 0.4);
    material.base_color_texture = texture(cubes.add(std::move(box.image)));
    MeshBuilder m;
    m.box(glm::dvec3(-0.5 * box.size), glm::dvec3(0.5 * box.size));
    const Index node = cubes.add_node(box.name, kNone, {}, cubes.add_mesh(box.name, m.take(cubes.add(material))));
    cubes.animate_translation(node, 25, [=](double t) {
        const double a = box.pace * t + box.phase;
        return box.centre + box.swing * glm::dvec3(std::sin(a), std::sin(2.0 * a + 0.6), std::cos(a));
    });
    cubes.animate_rotation(node, 49, [=](double t) { return turn(box.axis, box.spin * t + 0.4); });
}

void add_camera_and_light(Assembly& cubes) {
    const Index camera = cubes.add_camera("glide", {}, {28.0, 1.5, 0.85, 0.5, 0});
    const auto eye = [](double t) { return glm::dvec3(-0.04 + 0.06 * (t - 1.0), 0.30, 0.85 - 0.10 * (t - 1.0)); };
    cubes.animate_translation(camera, 13, eye);
    cubes.animate_rotation(camera, 13, [=](double t) { return looking(eye(t), {0.02 * (t - 1.0), 0.16, 0.0}); });
    cubes.add_sun("key", {-0.6, 0.9, 0.7}, {1.0f, 0.90f, 0.76f}, 3.4);
    cubes.add_sun("rim", {0.9, 0.35, -0.5}, {0.45f, 0.65f, 1.0f}, 1.6);
    cubes.add_sun("fill", {0.5, 0.2, 1.0}, {0.8f, 0.85f, 1.0f}, 0.8);
}

}  // namespace

Scene cubes() {
    Assembly cubes("builtin:cubes", 2.0);
    add_camera_and_light(cubes);
    add_floor(cubes);
    add_box(cubes, {"red checker",
                    checker_texture("red checker", 128, 4, {0.55, 0.02, 0.02}, {0.85, 0.80, 0.70}),
                    0.19,
                    {-0.17, 0.20, 0.0},
                    {0.09, 0.05, 0.05},
                    4.4,
                    0.3,
                    {0.7, 0.5, 0.3},
                    4.2});
    add_box(cubes, {"warning stripes",
                    stripe_texture("warning stripes", 128, 3, {0.02, 0.02, 0.02}, {0.88, 0.55, 0.02}),
                    0.14,
                    {0.17, 0.17, 0.13},
                    {0.10, 0.06, 0.06},
                    -5.2,
                    1.0,
                    {-0.3, 0.6, 0.8},
                    -6.0});
    add_box(cubes, {"blue target",
                    target_texture("blue target", 128, 3, {0.02, 0.10, 0.42}, {0.75, 0.85, 0.9}),
                    0.26,
                    {0.32, 0.27, -0.70},
                    {0.20, 0.06, 0.12},
                    3.4,
                    -0.6,
                    {0.2, 1.0, 0.4},
                    3.0});
    add_box(cubes, {"green checker",
                    checker_texture("green checker", 128, 2, {0.02, 0.22, 0.10}, {0.70, 0.80, 0.30}),
                    0.11,
                    {-0.10, 0.40, -0.45},
                    {0.34, 0.05, 0.10},
                    3.0,
                    2.4,
                    {1.0, 0.3, -0.2},
                    7.0});
    return cubes.take({0.16f, 0.23f, 0.32f});
}

}  // namespace pentaprism::builtin
