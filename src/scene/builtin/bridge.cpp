// bridge: a double-decker crosses a suspension bridge in the evening sun, trains below it, boats, an island and a city
// beyond. It is a model railway's landscape, 1:87, so a real lens has it shallow in focus. Nearly two million triangles
// through instances: some forty meshes are placed some three thousand times.

#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include "scene/builtin/assembly.h"
#include "scene/builtin/bridge_parts.h"
#include "scene/builtin/random.h"
#include "scene/builtin/recipes.h"
#include "scene/builtin/textures.h"

namespace pentaprism::builtin {
namespace {

constexpr double kDuration = 3.0;
constexpr double kModel = 1.0 / 87.0;

constexpr double kTower = 320.0, kTowerTop = 205.0;
constexpr double kPanel = 12.0;  // between hangers
constexpr int kPanels = 116;
constexpr double kCable = 15.2;  // from the bridge's middle

const glm::dvec3 kOxide{0.50, 0.072, 0.028};

/// What hangs in the wind, at x, of the main cable.
double cable_height(double x) {
    const double a = std::abs(x);
    if (a < kTower) return kDeck + 7.0 + (kTowerTop - kDeck - 7.0) * (a / kTower) * (a / kTower);
    const double s = (a - kTower) / 360.0;  // side span: a straight line that sags a little
    return glm::mix(kTowerTop, kDeck + 2.0, s) - 22.0 * s * (1.0 - s);
}

/// A beam of square section from a to b.
void beam(MeshBuilder& m, glm::dvec3 a, glm::dvec3 b, double thick) {
    const glm::dmat4 before = m.transform;
    const glm::dvec3 axis = glm::normalize(b - a);
    const Frame f = frame_around(axis);
    m.transform = before * glm::dmat4(glm::dvec4(f.side, 0.0), glm::dvec4(f.up, 0.0), glm::dvec4(axis, 0.0),
                                      glm::dvec4(0.5 * (a + b), 1.0));
    const double h = 0.5 * thick, l = 0.5 * glm::length(b - a);
    m.box({-h, -h, -l}, {h, h, l});
    m.transform = before;
}

/// Twelve metres of both decks, from x = 0 on, the road at y = 0.
std::vector<Primitive> panel(Index road, Index steel) {
    MeshBuilder m;
    std::vector<Primitive> parts;
    m.color = {0.105, 0.105, 0.11};
    m.box({0.0, -0.6, -11.0}, {kPanel, 0.0, 11.0});
    m.color = {0.34, 0.33, 0.31};
    for (const double side : {1.0, -1.0}) {
        const double a = 11.0 * side, b = 13.9 * side;
        m.box({0.0, -0.6, std::min(a, b)}, {kPanel, 0.22, std::max(a, b)});  // the walk
    }
    m.color = {0.74, 0.73, 0.69};
    for (const double z : {-3.9, 3.9, -7.3, 7.3}) m.box({0.0, -0.1, z - 0.12}, {4.5, 0.02, z + 0.12});
    m.color = {0.75, 0.52, 0.05};
    for (const double z : {-0.25, 0.25}) m.box({0.0, -0.1, z - 0.09}, {kPanel, 0.02, z + 0.09});
    parts.push_back(m.take(road));
    // Railings: posts, rails, bars.
    m.color = kOxide;
    for (const double z : {-13.7, 13.7}) {
        m.box({0.0, 1.28, z - 0.09}, {kPanel, 1.42, z + 0.09});
        m.box({0.0, 0.40, z - 0.06}, {kPanel, 0.50, z + 0.06});
        for (int k = 0; k < 24; ++k) {
            const double x = 0.5 * k, w = k % 8 == 0 ? 0.11 : 0.04;
            m.box({x - w, 0.2, z - w}, {x + w, k % 8 == 0 ? 1.55 : 1.3, z + w});
        }
    }
    // Crash barriers between road and walk.
    m.color = {0.44, 0.45, 0.46};
    for (const double z : {-11.0, 11.0}) {
        m.box({0.0, 0.55, z - 0.07}, {kPanel, 0.85, z + 0.07});
        for (int k = 0; k < 4; ++k) m.box({3.0 * k - 0.07, 0.0, z - 0.06}, {3.0 * k + 0.07, 0.7, z + 0.06});
    }
    // Trusses of both sides and what crosses between them.
    m.color = kOxide;
    for (const double z : {-14.3, 14.3}) {
        beam(m, {0.0, -0.7, z}, {kPanel, -0.7, z}, 0.95);
        beam(m, {0.0, -9.0, z}, {kPanel, -9.0, z}, 0.95);
        beam(m, {0.0, -0.7, z}, {0.0, -9.0, z}, 0.6);
        beam(m, {0.5 * kPanel, -0.7, z}, {0.5 * kPanel, -9.0, z}, 0.5);
        beam(m, {0.0, -9.0, z}, {0.5 * kPanel, -0.7, z}, 0.55);
        beam(m, {0.5 * kPanel, -0.7, z}, {kPanel, -9.0, z}, 0.55);
        for (int k = 0; k < 6; ++k) {  // lattice on the chords
            const double x = 2.0 * k;
            beam(m, {x, -0.3, z + (z > 0.0 ? 0.5 : -0.5)}, {x + 1.0, -1.1, z + (z > 0.0 ? 0.5 : -0.5)}, 0.14);
            beam(m, {x + 1.0, -1.1, z + (z > 0.0 ? 0.5 : -0.5)}, {x + 2.0, -0.3, z + (z > 0.0 ? 0.5 : -0.5)}, 0.14);
        }
    }
    for (const double x : {0.0, 0.5 * kPanel}) {
        beam(m, {x, -1.1, -14.3}, {x, -1.1, 14.3}, 0.7);
        beam(m, {x, -9.0, -14.3}, {x, -9.0, 14.3}, 0.7);
    }
    beam(m, {0.0, -9.0, -14.3}, {kPanel, -9.0, 14.3}, 0.35);
    beam(m, {0.0, -9.0, 14.3}, {kPanel, -9.0, -14.3}, 0.35);
    // The railway below: sleepers and rails of two tracks.
    for (const double z : {-4.5, 4.5}) {
        m.color = {0.10, 0.08, 0.065};
        for (int k = 0; k < 16; ++k) m.box({0.75 * k + 0.2, -8.6, z - 1.3}, {0.75 * k + 0.45, -8.4, z + 1.3});
        m.color = {0.33, 0.30, 0.28};
        for (const double rail : {-0.72, 0.72}) m.box({0.0, -8.4, z + rail - 0.05}, {kPanel, -8.22, z + rail + 0.05});
    }
    parts.push_back(m.take(steel));
    return parts;
}

Primitive lamp(Index material) {
    MeshBuilder m;
    m.color = kOxide;
    m.tube({{{0.0, 0.0, 0.0}, 0.16},
            {{0.0, 4.0, 0.0}, 0.11},
            {{0.0, 7.0, 0.0}, 0.09},
            {{0.0, 8.2, -0.8}, 0.08},
            {{0.0, 8.5, -2.4}, 0.07}},
           6, 10);
    m.color = {0.95, 0.88, 0.70};
    m.ellipsoid({0.0, 8.4, -2.6}, {0.28, 0.16, 0.5}, 8, 5);
    return m.take(material);
}

/// A tower: two stepped legs, portals between them with panels, a pier in the water.
Primitive tower(Index material) {
    MeshBuilder m;
    m.color = {0.40, 0.37, 0.33};
    m.lathe({{27.0, -12.0}, {26.0, 4.0}, {23.0, 5.0}, {22.0, 9.0}, {19.0, 9.6}, {0.0, 9.7}}, 40, 10);
    const double steps[] = {9.0, 58.0, 100.0, 138.0, 172.0, 205.0};
    for (const double side : {1.0, -1.0})
        for (int k = 0; k < 5; ++k) {
            const double along = 5.4 - 0.55 * k, across = 3.9 - 0.38 * k, z = side * (kCable + 1.2);
            m.color = kOxide * (1.0 - 0.02 * k);
            m.box({-along, steps[k], z - across}, {along, steps[k + 1] + 0.5, z + across});
            // Flutes and rivet bands.
            for (int f = -2; f <= 2; ++f) {
                const double x = 0.36 * along * f;
                m.box({x - 0.42, steps[k] + 1.0, z - across - 0.4}, {x + 0.42, steps[k + 1] - 1.0, z + across + 0.4});
            }
            for (int f = -1; f <= 1; ++f)
                m.box({-along - 0.4, steps[k] + 1.0, z + 0.55 * across * f - 0.4},
                      {along + 0.4, steps[k + 1] - 1.0, z + 0.55 * across * f + 0.4});
            for (int band = 0; band < 7; ++band) {
                const double y = glm::mix(steps[k], steps[k + 1], (band + 0.5) / 7.0);
                m.box({-along - 0.25, y - 0.2, z - across - 0.25}, {along + 0.25, y + 0.2, z + across + 0.25});
            }
            m.box({-along - 0.9, steps[k + 1] - 1.4, z - across - 0.9},
                  {along + 0.9, steps[k + 1] + 0.6, z + across + 0.9});
        }
    // Portals.
    m.color = kOxide;
    for (const double y : {45.0, 97.0, 135.0, 169.0, 200.0}) {
        const double h = y < 50.0 ? 4.0 : 5.0;
        m.box({-3.4, y - h, -kCable}, {3.4, y + h, kCable});
        for (int k = -6; k <= 6; ++k) m.box({-3.8, y - 0.8 * h, 2.1 * k - 0.35}, {3.8, y + 0.8 * h, 2.1 * k + 0.35});
        m.box({-3.9, y + h - 0.8, -kCable}, {3.9, y + h + 0.4, kCable});
        m.box({-3.9, y - h - 0.4, -kCable}, {3.9, y - h + 0.8, kCable});
    }
    for (const double side : {1.0, -1.0}) {  // crosses below the deck
        beam(m, {0.0, 10.0, -kCable * side}, {0.0, 41.0, kCable * side}, 3.0);
        m.color = {0.9, 0.08, 0.04};
        m.ellipsoid({0.0, 208.0, side * (kCable + 1.2)}, {0.9, 1.2, 0.9}, 10, 8);
        m.color = kOxide;
    }
    return m.take(material);
}

void add_bridge(Assembly& scene, Index root) {
    Material steel = painted("oxide red steel", 0.45);
    const Index steel_index = scene.add(steel);
    const Index panels =
        scene.add_node("deck", root, placed({0.0, kDeck, 0.0}),
                       scene.add_mesh("deck panel", panel(scene.add(painted("road", 0.9)), steel_index)));
    const double from = -0.5 * kPanel * kPanels;
    for (int k = 0; k < kPanels; ++k) scene.node(panels).instances.push_back(placed({from + kPanel * k, 0.0, 0.0}));
    const Index lamps =
        scene.add_node("lamps", root, placed({0.0, kDeck + 0.2, 0.0}), scene.add_mesh("lamp", lamp(steel_index)));
    for (int k = 0; k < kPanels; k += 3)
        for (const double side : {1.0, -1.0})
            scene.node(lamps).instances.push_back(
                placed({from + kPanel * k + 6.0, 0.0, 12.9 * side}, side > 0.0 ? 0.0 : degrees(180.0)));
    const Index towers = scene.add_node("towers", root, {}, scene.add_mesh("tower", tower(steel_index)));
    for (const double x : {-kTower, kTower}) scene.node(towers).instances.push_back(placed({x, 0.0, 0.0}));

    MeshBuilder m;
    m.color = kOxide;
    // A hanger one metre high, made as long as it has to be by its instances.
    for (const double x : {-0.28, 0.28}) m.tube({{{x, 0.0, 0.0}, 0.105}, {{x, 1.0, 0.0}, 0.105}}, 8, 1);
    const Index hangers = scene.add_node("hangers", root, {}, scene.add_mesh("hanger", m.take(steel_index)));
    m.color = kOxide;
    m.ellipsoid(glm::dvec3(0.0), {0.8, 0.62, 0.62}, 8, 5);
    const Index clamps = scene.add_node("clamps", root, {}, scene.add_mesh("clamp", m.take(steel_index)));
    for (int k = 0; k <= kPanels; ++k) {
        const double x = from + kPanel * k;
        if (std::abs(x) > 670.0 || std::abs(std::abs(x) - kTower) < 5.0) continue;
        for (const double side : {1.0, -1.0}) {
            Transform t = placed({x, kDeck - 0.6, kCable * side});
            t.scale.y = cable_height(x) - kDeck + 0.6;
            scene.node(hangers).instances.push_back(t);
            scene.node(clamps).instances.push_back(placed({x, cable_height(x), kCable * side}));
        }
    }
    for (const double side : {1.0, -1.0}) {
        m.color = kOxide;
        m.surface(12, 240, [=](double u, double v) {
            const double x = glm::mix(-680.0, 680.0, v), a = kTwoPi * u;
            return glm::dvec3(x, cable_height(x) + 0.46 * std::sin(a), side * kCable - 0.46 * std::cos(a));
        });
    }
    scene.add_node("main cables", root, {}, scene.add_mesh("main cables", m.take(steel_index)));
}

void add_sky(Assembly& scene, Index root) {
    MeshBuilder m;
    m.surface(
        70, 36,
        [](double u, double v) {
            const double a = degrees(-30.0 + 150.0 * u);
            return glm::dvec3(2700.0 * std::cos(a), -60.0 + 1900.0 * v, -2700.0 * std::sin(a));
        },
        [](double u, double v, glm::dvec3) {
            const double cloud = fractal_noise({18.0 * u + 2.0 * v, 14.0 * v + 3.0}, 5);
            const glm::dvec3 low{0.92, 0.62, 0.40}, middle{0.50, 0.52, 0.62}, high{0.12, 0.24, 0.48};
            const glm::dvec3 clear =
                glm::mix(low, glm::mix(middle, high, glm::smoothstep(0.18, 0.6, v)), glm::smoothstep(0.03, 0.22, v));
            const glm::dvec3 lit = glm::mix(glm::dvec3(0.98, 0.72, 0.50), glm::dvec3(0.95, 0.84, 0.76), v);
            return glm::mix(clear, lit, 0.8 * glm::smoothstep(0.48, 0.72, cloud));
        });
    scene.add_node("evening sky", root, {}, scene.add_mesh("evening sky", m.take(scene.add(backdrop("evening sky")))));
}

void add_camera_and_light(Assembly& scene) {
    const Index camera = scene.add_camera("beside the bus", {}, {35.0, 3.4, 54.0 * kModel, 0.5, 0});
    // It runs along a little slower than the bus, and so comes to see it from behind.
    const auto eye = [](double t) { return kModel * glm::dvec3(kPlace - 47.0 + 0.95 * kBus * (t - 1.0), 71.5, 33.0); };
    const auto target = [](double t) { return kModel * glm::dvec3(kPlace + 8.0 + 0.99 * kBus * (t - 1.0), 66.5, 5.0); };
    scene.animate_translation(camera, 13, eye);
    scene.animate_rotation(camera, 13, [=](double t) { return looking(eye(t), target(t)); });
    scene.add_sun("evening sun", {-0.55, 0.42, 0.72}, {1.0f, 0.76f, 0.48f}, 5.0);
    scene.add_sun("sky light", {0.1, 1.0, 0.1}, {0.55f, 0.70f, 1.0f}, 1.3);
    scene.add_sun("glow behind", {0.9, 0.25, -0.3}, {1.0f, 0.62f, 0.36f}, 1.2);
}

}  // namespace

Scene bridge() {
    Assembly scene("builtin:bridge", kDuration);
    Transform model;
    model.scale = glm::dvec3(kModel);
    const Index root = scene.add_node("model landscape 1:87", kNone, model);
    add_camera_and_light(scene);
    add_bridge(scene, root);
    add_traffic(scene, root);
    add_shore(scene, root);
    add_sky(scene, root);
    return scene.take({0.35f, 0.36f, 0.42f});
}

}  // namespace pentaprism::builtin
