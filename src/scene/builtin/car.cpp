// car: two racing cars of the sixties on a country road, seen from a car that drives beside them. The camera pans
// along, so the cars stay sharp while road, hedge and trees run to streaks, and the wheels, of which every spoke is
// modelled, spin.

#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "scene/builtin/assembly.h"
#include "scene/builtin/plants.h"
#include "scene/builtin/racing_car.h"
#include "scene/builtin/recipes.h"
#include "scene/builtin/textures.h"

namespace pentaprism::builtin {
namespace {

constexpr double kDuration = 2.0;
constexpr double kSpeed = 18.0;  // metres per second along +x

void add_cars(Assembly& scene) {
    RacingCars cars(scene);
    cars.add({"green car", "green livery", {0.008, 0.10, 0.045}, {0.85, 0.60, 0.02}, 7, {0.85, 0.82, 0.75}},
             {[](double t) { return glm::dvec3(kSpeed * t + 0.10 * std::sin(2.0 * t), 0.0, 0.0); },
              {},
              kSpeed,
              0.0,
              0.0,
              0.4});
    cars.add({"red car", "red livery", {0.52, 0.012, 0.010}, {0.85, 0.83, 0.78}, 2, {0.05, 0.12, 0.5}},
             {[](double t) { return glm::dvec3(kSpeed * t - 4.1 + 0.9 * (t - 1.0), 0.0, -2.5); },
              {},
              kSpeed,
              0.0,
              0.0,
              1.9});
}

// ---------------------------------------------------------------- the road and what stands beside it

constexpr double kFrom = -34.0, kTo = 84.0;  // metres along x

void add_road(Assembly& scene) {
    Material asphalt = painted("asphalt", 0.85), grass = painted("verge", 0.95);
    asphalt.base_color_texture = texture(scene.add(litter_texture()), glm::dvec2(0.5));
    grass.base_color_texture = texture(0, glm::dvec2(0.35));
    const Index asphalt_index = scene.add(asphalt), grass_index = scene.add(grass);
    const auto strip = [](MeshBuilder& m, double z0, double z1, double height0, double height1, int along_count,
                          const Tint& tint) {
        m.surface(
            along_count, 2,
            [=](double u, double v) {
                return glm::dvec3(glm::mix(kFrom, kTo, u), glm::mix(height0, height1, v), glm::mix(z0, z1, v));
            },
            tint);
    };
    const auto in_metres = [](Primitive p) {
        for (std::size_t i = 0; i < p.positions.size(); ++i) p.texcoords[0][i] = {p.positions[i].x, p.positions[i].z};
        return p;
    };
    MeshBuilder m;
    strip(m, 2.6, -4.6, 0.0, 0.0, 110,
          [](double, double v, glm::dvec3) { return glm::dvec3(0.17, 0.165, 0.17) * (0.9 + 0.2 * v); });
    std::vector<Primitive> ground;
    ground.push_back(in_metres(m.take(asphalt_index)));
    const Tint meadow = [](double, double, glm::dvec3 p) {
        const double n = fractal_noise({0.5 * p.x, 0.9 * p.z}, 3);
        return glm::mix(glm::dvec3(0.10, 0.21, 0.04), glm::dvec3(0.34, 0.36, 0.09), n);
    };
    strip(m, 9.0, 2.6, -0.1, -0.005, 110, meadow);
    strip(m, -4.6, -13.0, -0.005, 0.15, 110, meadow);
    strip(m, -13.0, -60.0, 0.15, 3.0, 110, meadow);
    ground.push_back(in_metres(m.take(grass_index)));
    scene.add_node("ground", kNone, {}, scene.add_mesh("ground", std::move(ground)));

    // White dashes along the middle, a red and white kerb on the far side.
    MeshBuilder paint;
    paint.color = {0.75, 0.74, 0.70};
    for (double x = kFrom; x < kTo; x += 3.0)
        paint.surface(1, 1, [=](double u, double v) { return glm::dvec3(x + 1.5 * u, 0.006, -1.20 - 0.12 * v); });
    for (double x = kFrom; x < kTo; x += 1.0) {
        paint.color =
            static_cast<int>(std::floor(x)) % 2 == 0 ? glm::dvec3(0.62, 0.03, 0.02) : glm::dvec3(0.78, 0.76, 0.72);
        paint.surface(1, 2, [=](double u, double v) { return glm::dvec3(x + u, 0.008 + 0.07 * v, -4.4 - 0.5 * v); });
    }
    scene.add_node("road paint", kNone, {},
                   scene.add_mesh("road paint", paint.take(scene.add(painted("road paint", 0.6)))));
}

/// Straw bales, a fence, boards, flags, trees: what streaks past.
void add_roadside(Assembly& scene) {
    Random random(3);
    const Index material = scene.add(painted("roadside", 0.8));
    Material cloth = painted("foliage", 0.7);
    cloth.double_sided = true;
    const Index leafy = scene.add(cloth);

    MeshBuilder m;
    m.color = {0.55, 0.38, 0.13};
    m.box({-0.5, 0.0, -0.22}, {0.5, 0.42, 0.22});
    const Index bale = scene.add_node("straw bales", kNone, {}, scene.add_mesh("straw bale", m.take(material)));
    for (double x = kFrom; x < kTo; x += 1.12) {
        const double skew = random.around(0.0, 0.05), shift = random.around(0.0, 0.06);
        scene.node(bale).instances.push_back({{x, 0.03, -6.4 + shift}, turn({0.0, 1.0, 0.0}, skew), glm::dvec3(1.0)});
    }
    m.color = {0.62, 0.60, 0.56};
    m.box({-0.05, 0.0, -0.05}, {0.05, 1.15, 0.05});
    m.box({-1.25, 0.90, -0.02}, {1.25, 1.02, 0.02});
    m.box({-1.25, 0.50, -0.02}, {1.25, 0.62, 0.02});
    const Index fence = scene.add_node("fence", kNone, {}, scene.add_mesh("fence", m.take(material)));
    for (double x = kFrom; x < kTo; x += 2.5)
        scene.node(fence).instances.push_back({{x, 0.1, -10.5}, {1.0, 0.0, 0.0, 0.0}, glm::dvec3(1.0)});

    const glm::dvec3 colors[] = {
        {0.70, 0.50, 0.04}, {0.04, 0.14, 0.42}, {0.60, 0.04, 0.03}, {0.75, 0.73, 0.68}, {0.03, 0.30, 0.20}};
    std::vector<Index> boards;
    for (int k = 0; k < 5; ++k) {
        m.color = colors[k];
        m.box({-2.4, 0.25, -0.04}, {2.4, 1.25, 0.04});
        m.color = colors[(k + 3) % 5];
        m.box({-1.8, 0.55, 0.04}, {1.8, 0.95, 0.06});
        boards.push_back(scene.add_mesh("board", m.take(material)));
    }
    for (int k = 0; k < 14; ++k)
        scene.add_node("board", kNone, {{kFrom + 4.0 + 7.6 * k, 0.1, -8.4}, {1.0, 0.0, 0.0, 0.0}, glm::dvec3(1.0)},
                       boards[std::size_t(k * 2 % 5)]);

    // Trees: a trunk and a crown of large leaves.
    std::vector<Index> crowns;
    for (int kind = 0; kind < 2; ++kind) {
        MeshBuilder trunk, crown;
        DistantTreeStyle style;
        style.trunk = {
            {{0.0, -0.2, 0.0}, 0.32}, {{0.05, 1.4, 0.0}, 0.2}, {{0.0, 3.2, 0.1}, 0.13}, {{0.1, 5.6, 0.0}, 0.04}};
        style.leaves = 140;
        const Palette palette = kind == 0 ? Palette{{0.05, 0.16, 0.03}, {0.20, 0.34, 0.06}, {0.45, 0.40, 0.08}, 0.1}
                                          : Palette{{0.20, 0.20, 0.03}, {0.48, 0.36, 0.06}, {0.50, 0.22, 0.04}, 0.2};
        add_distant_tree(trunk, crown, random, style, palette);
        std::vector<Primitive> parts;
        parts.push_back(trunk.take(material));
        parts.push_back(crown.take(leafy));
        crowns.push_back(scene.add_mesh("tree", std::move(parts)));
    }
    for (int k = 0; k < 16; ++k) {
        const double x = kFrom + 6.8 * k + random.around(0.0, 1.6), z = -15.0 - 11.0 * random.uniform();
        const double yaw = random.angle();
        const Index node = scene.add_node(
            "tree", kNone,
            {{x, 0.1 - 0.06 * (z + 13.0), z}, turn({0.0, 1.0, 0.0}, yaw), glm::dvec3(random.range(0.85, 1.35))},
            crowns[std::size_t(k % 2)]);
        scene.sway(node, {1.0, 0.0, 0.4}, degrees(1.2), random.range(1.6, 2.4), random.angle());
    }
    // Grass between the camera and the road, close to the lens.
    MeshBuilder tuft;
    add_grass_tuft(tuft, random, 12, 1.0, {{0.10, 0.20, 0.03}, {0.35, 0.42, 0.10}, {0.6, 0.5, 0.2}, 0.15});
    const Index grass = scene.add_node("tall grass", kNone, {}, scene.add_mesh("tall grass", tuft.take(leafy)));
    for (int k = 0; k < 45; ++k) {
        const double x = glm::mix(-10.0, 56.0, (k + random.uniform()) / 45.0), z = random.range(3.3, 4.9),
                     yaw = random.angle();
        scene.node(grass).instances.push_back(
            {{x, -0.06, z}, turn({0.0, 1.0, 0.0}, yaw), glm::dvec3(random.range(0.45, 0.75))});
    }
}

void add_sky(Assembly& scene) {
    MeshBuilder m;
    m.surface(
        30, 24, [](double u, double v) { return glm::dvec3(glm::mix(-90.0, 130.0, u), -2.0 + 46.0 * v, -62.0); },
        [](double u, double v, glm::dvec3) {
            const double cloud = fractal_noise({16.0 * u, 30.0 * v}, 4);
            const double hills = fractal_noise({9.0 * u, 3.0}, 3);
            const glm::dvec3 clear =
                glm::mix(glm::dvec3(0.82, 0.72, 0.56), glm::dvec3(0.10, 0.27, 0.58), glm::smoothstep(0.06, 0.30, v));
            const glm::dvec3 above =
                glm::mix(clear, glm::dvec3(0.95, 0.88, 0.78), 0.8 * glm::smoothstep(0.5, 0.72, cloud));
            return glm::mix(glm::dvec3(0.20, 0.27, 0.26), above, glm::smoothstep(0.0, 0.03, v - 0.055 - 0.07 * hills));
        });
    scene.add_node("sky", kNone, {}, scene.add_mesh("sky", m.take(scene.add(backdrop("sky")))));
}

void add_camera_and_light(Assembly& scene) {
    const Index camera = scene.add_camera("panning", {}, {60.0, 0.95, 8.0, 0.5, 0});
    // The camera's car is a little slower, so the picture pans.
    const auto eye = [](double t) { return glm::dvec3(kSpeed * t + 3.3 - 1.1 * (t - 1.0), 0.80, 7.5); };
    const auto target = [](double t) { return glm::dvec3(kSpeed * t + 0.05 - 0.25 * (t - 1.0), 0.70, 0.0); };
    scene.animate_translation(camera, 13, eye);
    scene.animate_rotation(camera, 13, [=](double t) { return looking(eye(t), target(t)); });
    scene.add_sun("afternoon sun", {0.55, 0.62, 0.65}, {1.0f, 0.83f, 0.60f}, 4.2);
    scene.add_sun("sky light", {-0.2, 1.0, -0.25}, {0.55f, 0.72f, 1.0f}, 1.6);
    scene.add_sun("bounce", {-0.5, -0.3, 1.0}, {1.0f, 0.9f, 0.75f}, 0.5);
}

}  // namespace

Scene car() {
    Assembly scene("builtin:car", kDuration);
    add_camera_and_light(scene);
    add_road(scene);
    add_roadside(scene);
    add_sky(scene);
    add_cars(scene);
    return scene.take({0.45f, 0.58f, 0.75f});
}

}  // namespace pentaprism::builtin
