// bridge: a double-decker crosses a suspension bridge in the evening sun, trains below it, boats, an island and a city
// beyond. It is a model railway's landscape, 1:87, so a real lens has it shallow in focus. Nearly two million triangles
// through instances: some forty meshes are placed some three thousand times.

#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include "scene/builtin/assembly.h"
#include "scene/builtin/plants.h"
#include "scene/builtin/random.h"
#include "scene/builtin/recipes.h"
#include "scene/builtin/textures.h"

namespace pentaprism::builtin {
namespace {

constexpr double kDuration = 3.0;
constexpr double kTwoPi = 6.283185307179586;
constexpr double kModel = 1.0 / 87.0;  // all lengths below are those of the big original, in metres

constexpr double kDeck = 60.0;  // height of the road over the water; the bridge runs along x
constexpr double kTower = 320.0, kTowerTop = 205.0;
constexpr double kPanel = 12.0;  // between hangers
constexpr int kPanels = 116;
constexpr double kCable = 15.2;   // from the bridge's middle
constexpr double kPlace = 105.0;  // where the bus is after a second
constexpr double kBus = 42.0;     // metres per second; models are always a little fast

const glm::dvec3 kOxide{0.50, 0.072, 0.028};

Transform placed(glm::dvec3 p, double yaw = 0.0, double scale = 1.0) {
    return {p, turn({0.0, 1.0, 0.0}, yaw), glm::dvec3(scale)};
}

/// What hangs in the wind, at x, of the main cable.
double cable_height(double x) {
    const double a = std::abs(x);
    if (a < kTower) return kDeck + 7.0 + (kTowerTop - kDeck - 7.0) * (a / kTower) * (a / kTower);
    const double s = (a - kTower) / 360.0;  // side span: a straight line that sags a little
    return glm::mix(kTowerTop, kDeck + 2.0, s) - 22.0 * s * (1.0 - s);
}

// ---------------------------------------------------------------- the bridge

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

// ---------------------------------------------------------------- what rolls

/// A body between cross-sections, superellipses of the given fullness; x forward, y up.
struct Section {
    double x, half, bottom, top;
};

void loft(MeshBuilder& m, const std::vector<Section>& sections, double fullness, int around, int along_count) {
    std::vector<TubePoint> middle, size;
    for (const Section& s : sections) {
        middle.push_back({{s.x, 0.5 * (s.bottom + s.top), 0.0}, 0.0});
        size.push_back({{s.half, 0.5 * (s.top - s.bottom), 0.0}, 0.0});
    }
    m.surface(around, along_count, [&](double u, double v) {
        const glm::dvec3 p = along(middle, v).p, h = along(size, v).p;
        const double c = std::cos(kTwoPi * u), s = std::sin(kTwoPi * u);
        const double k = std::pow(std::pow(std::abs(c), fullness) + std::pow(std::abs(s), fullness), -1.0 / fullness);
        return glm::dvec3(p.x, p.y - std::max(0.0, h.y) * k * s, std::max(0.0, h.x) * k * c);
    });
}

void add_wheels(MeshBuilder& m, std::initializer_list<double> axles, double half, double radius, double width) {
    const glm::dmat4 before = m.transform;
    for (const double x : axles)
        for (const double side : {1.0, -1.0}) {
            m.transform = before * glm::translate(glm::dmat4(1.0), glm::dvec3(x, radius, half * side)) *
                          glm::rotate(glm::dmat4(1.0), degrees(90.0 * side), glm::dvec3(1.0, 0.0, 0.0));
            const double h = 0.5 * width;
            m.lathe({{0.55 * radius, -h},
                     {0.9 * radius, -h},
                     {radius, -0.7 * h},
                     {radius, 0.7 * h},
                     {0.9 * radius, h},
                     {0.6 * radius, h},
                     {0.56 * radius, 0.6 * h},
                     {0.0, 0.8 * h}},
                    9, 5, [](double, double v, glm::dvec3) { return v > 0.72 ? glm::dvec3(0.36) : glm::dvec3(0.02); });
        }
    m.transform = before;
}

Primitive car(Index material, glm::dvec3 paint) {
    MeshBuilder m;
    m.color = paint;
    loft(m,
         {{-2.2, 0.0, 0.55, 0.6},
          {-2.15, 0.72, 0.35, 0.88},
          {-1.6, 0.86, 0.25, 0.98},
          {0.0, 0.90, 0.24, 0.96},
          {1.5, 0.86, 0.25, 0.90},
          {2.05, 0.74, 0.32, 0.74},
          {2.2, 0.0, 0.5, 0.55}},
         4.5, 16, 12);
    m.color = {0.02, 0.025, 0.03};
    loft(m,
         {{-1.75, 0.0, 0.85, 0.9},
          {-1.6, 0.66, 0.80, 1.0},
          {-0.95, 0.72, 0.80, 1.42},
          {0.2, 0.72, 0.80, 1.44},
          {0.95, 0.70, 0.80, 1.05},
          {1.15, 0.0, 0.85, 0.9}},
         5.0, 16, 10);
    m.color = paint;
    loft(m,
         {{-1.15, 0.0, 1.38, 1.40},
          {-1.05, 0.62, 1.36, 1.455},
          {-0.4, 0.66, 1.36, 1.475},
          {0.25, 0.62, 1.36, 1.46},
          {0.35, 0.0, 1.38, 1.40}},
         5.0, 12, 6);
    m.color = {0.92, 0.88, 0.75};
    for (const double z : {-0.6, 0.6}) m.ellipsoid({2.04, 0.62, z}, {0.12, 0.09, 0.15}, 6, 3);
    m.color = {0.65, 0.02, 0.015};
    for (const double z : {-0.62, 0.62}) m.ellipsoid({-2.1, 0.72, z}, {0.08, 0.09, 0.16}, 6, 3);
    add_wheels(m, {-1.35, 1.35}, 0.78, 0.33, 0.22);
    return m.take(material);
}

Primitive truck(Index material, glm::dvec3 cab, glm::dvec3 load) {
    MeshBuilder m;
    m.color = cab;
    loft(m,
         {{2.9, 0.0, 1.5, 1.6},
          {2.95, 1.2, 0.6, 3.1},
          {4.4, 1.2, 0.5, 3.0},
          {4.9, 1.15, 0.5, 2.2},
          {5.0, 0.0, 1.2, 1.3}},
         7.0, 20, 12);
    m.color = {0.02, 0.025, 0.03};
    m.box({4.45, 1.75, -1.02}, {4.86, 2.55, 1.02});
    m.box({3.7, 1.8, -1.23}, {4.4, 2.5, 1.23});
    m.color = load;
    loft(m,
         {{-5.0, 0.0, 2.0, 2.1},
          {-4.98, 1.25, 1.1, 3.7},
          {-1.0, 1.25, 1.1, 3.7},
          {2.6, 1.25, 1.1, 3.7},
          {2.62, 0.0, 2.0, 2.1}},
         14.0, 24, 12);
    m.color = glm::mix(load, glm::dvec3(0.8), 0.5);
    m.box({-4.2, 2.0, -1.27}, {1.8, 2.9, 1.27});
    m.color = {0.05, 0.05, 0.05};
    m.box({-4.9, 0.7, -0.6}, {4.2, 1.1, 0.6});
    add_wheels(m, {-4.0, -2.8, 3.7}, 1.0, 0.5, 0.35);
    return m.take(material);
}

/// A yellow double-decker: what the picture is about.
Primitive bus(Index material) {
    MeshBuilder m;
    const glm::dvec3 yellow{0.80, 0.43, 0.015}, cream{0.84, 0.78, 0.62}, glass{0.018, 0.026, 0.034};
    m.color = yellow;
    loft(m,
         {{-4.6, 0.0, 2.2, 2.3},
          {-4.58, 1.15, 0.4, 4.2},
          {-4.3, 1.25, 0.32, 4.4},
          {0.0, 1.26, 0.30, 4.42},
          {4.2, 1.25, 0.32, 4.4},
          {4.58, 1.12, 0.42, 4.1},
          {4.6, 0.0, 2.2, 2.3}},
         9.0, 48, 36);
    m.color = cream;
    m.box({-4.5, 2.42, -1.275}, {4.5, 2.56, 1.275});
    m.color = glass;
    for (int deck = 0; deck < 2; ++deck)
        for (int k = 0; k < 7; ++k) {
            const double x = -4.15 + 1.2 * k, y = deck == 0 ? 1.45 : 2.95;
            if (deck == 0 && k == 6) continue;
            m.color = cream;
            m.box({x - 0.05, y - 0.05, -1.268}, {x + 1.05, y + 0.85, 1.268});
            m.color = glass;
            m.box({x, y, -1.285}, {x + 1.0, y + 0.8, 1.285});
        }
    m.color = glass;
    m.box({4.3, 1.3, -1.0}, {4.63, 2.3, 1.0});
    m.box({4.3, 2.9, -1.05}, {4.62, 3.75, 1.05});
    m.box({-4.62, 2.9, -1.0}, {-4.4, 3.75, 1.0});
    m.color = {0.9, 0.85, 0.7};
    m.box({4.4, 2.44, -0.7}, {4.66, 2.74, 0.7});
    for (const double z : {-0.85, 0.85}) m.ellipsoid({4.55, 0.85, z}, {0.12, 0.15, 0.15}, 12, 8);
    m.color = {0.02, 0.02, 0.02};
    m.box({4.4, 0.35, -1.1}, {4.66, 0.6, 1.1});
    // A placard along the side, in bars.
    m.color = {0.80, 0.78, 0.72};
    m.box({-3.6, 2.58, -1.272}, {2.6, 2.86, 1.272});
    m.color = {0.06, 0.12, 0.34};
    for (int k = 0; k < 9; ++k) m.box({-3.3 + 0.62 * k, 2.63, -1.28}, {-2.9 + 0.62 * k, 2.81, 1.28});
    add_wheels(m, {-2.9, 2.9}, 1.05, 0.52, 0.36);
    return m.take(material);
}

Primitive coach(Index material, glm::dvec3 paint) {
    MeshBuilder m;
    m.color = paint;
    loft(m,
         {{-10.8, 0.0, 2.0, 2.1},
          {-10.75, 1.35, 0.9, 3.9},
          {-6.0, 1.42, 0.8, 4.0},
          {6.0, 1.42, 0.8, 4.0},
          {10.75, 1.35, 0.9, 3.9},
          {10.8, 0.0, 2.0, 2.1}},
         7.0, 24, 16);
    for (int k = 0; k < 10; ++k) {
        m.color = k % 3 == 1 ? glm::dvec3(0.90, 0.74, 0.42) : glm::dvec3(0.03, 0.04, 0.05);
        m.box({-9.6 + 1.96 * k, 2.2, -1.46}, {-8.2 + 1.96 * k, 3.2, 1.46});
    }
    m.color = {0.82, 0.78, 0.66};
    m.box({-10.6, 1.75, -1.45}, {10.6, 1.95, 1.45});
    add_wheels(m, {-8.5, -6.5, 6.5, 8.5}, 0.75, 0.46, 0.2);
    return m.take(material);
}

/// A lane's node moves; its cars are instances, so all of a lane keep their distance.
void add_traffic(Assembly& scene, Index root) {
    Random random(11);
    Material lacquer = painted("lacquer", 0.25);
    const Index paint = scene.add(lacquer);
    const glm::dvec3 colors[] = {{0.60, 0.58, 0.55},  {0.035, 0.10, 0.30}, {0.70, 0.44, 0.04}, {0.06, 0.24, 0.20},
                                 {0.05, 0.05, 0.055}, {0.34, 0.50, 0.62},  {0.50, 0.05, 0.04}};
    std::vector<Index> kinds;
    for (const glm::dvec3& c : colors) kinds.push_back(scene.add_mesh("car", car(paint, c)));
    kinds.push_back(scene.add_mesh("truck", truck(paint, {0.06, 0.22, 0.42}, {0.66, 0.64, 0.60})));
    kinds.push_back(scene.add_mesh("truck", truck(paint, {0.70, 0.40, 0.04}, {0.28, 0.10, 0.05})));

    const auto drive = [&](Index node, double speed, double from, double z, double y) {
        scene.animate_translation(node, 7, [=](double t) { return glm::dvec3(from + speed * (t - 1.0), y, z); });
    };
    // The near lanes go with the bus, the far ones come towards it.
    const double lanes[] = {2.1, 5.6, 9.1, -2.1, -5.6, -9.1};
    for (int lane = 0; lane < 6; ++lane) {
        const bool there = lane < 3;
        const double speed = there ? kBus * (1.12 - 0.07 * lane) : -kBus * (1.05 - 0.06 * (lane - 3));
        std::vector<std::vector<Transform>> cars(kinds.size());
        double x = -690.0;
        while (x < 690.0) {
            const bool heavy = random.chance(lane % 3 == 2 ? 0.16 : 0.05);
            const std::size_t kind = heavy ? std::size_t(7 + random.below(2)) : std::size_t(random.below(7));
            const double gap = random.range(7.0, 21.0) + (heavy ? 6.0 : 0.0), shift = random.around(0.0, 0.25);
            // Room for the bus, and before and behind it.
            if (lane != 2 || std::abs(x - kPlace) > 14.0)
                cars[kind].push_back(placed({x, 0.0, shift}, there ? 0.0 : degrees(180.0)));
            x += gap;
        }
        for (std::size_t kind = 0; kind < kinds.size(); ++kind) {
            if (cars[kind].empty()) continue;
            const Index node = scene.add_node("lane", root, {}, kinds[kind]);
            scene.node(node).instances = std::move(cars[kind]);
            drive(node, lane == 2 ? kBus : speed, 0.0, lanes[lane], kDeck + 0.02);
        }
    }
    const Index hero = scene.add_node("bus", root, {}, scene.add_mesh("bus", bus(paint)));
    scene.animate_translation(hero, 25, [](double t) {
        return glm::dvec3(kPlace + kBus * (t - 1.0), kDeck + 0.02 + 0.02 * std::sin(11.0 * t), 9.1);
    });
    // Two trains on the lower deck.
    const Index coaches[] = {scene.add_mesh("coach", coach(paint, {0.03, 0.16, 0.13})),
                             scene.add_mesh("coach", coach(paint, {0.34, 0.05, 0.03}))};
    for (int k = 0; k < 2; ++k) {
        const Index train = scene.add_node("train", root, {}, coaches[k]);
        for (int c = 0; c < 14; ++c) scene.node(train).instances.push_back(placed({-150.0 + 22.3 * c, 0.0, 0.0}));
        drive(train, k == 0 ? 62.0 : -55.0, k == 0 ? 40.0 : 20.0, k == 0 ? 4.5 : -4.5, kDeck - 8.25);
    }
}

// ---------------------------------------------------------------- water, land, boats

/// Height of the land: the far bank with its hills, the near bank, an island; below 0 in the river.
double land(double x, double z) {
    const double rough = fractal_noise({0.006 * x + 90.0, 0.006 * z + 90.0}, 5) - 0.5;
    const double far_shore = x - 455.0 - 70.0 * (fractal_noise({0.004 * z + 50.0, 7.0}, 3) - 0.5);
    const double plain = 9.0 * glm::smoothstep(-15.0, 45.0, far_shore) - 9.0 * glm::smoothstep(15.0, -60.0, far_shore);
    const double hills = (95.0 + 330.0 * rough) * glm::smoothstep(520.0, 1250.0, far_shore);
    const double near_shore = -x - 460.0;
    const double near = 26.0 * glm::smoothstep(-15.0, 120.0, near_shore) +
                        60.0 * std::max(0.0, rough) * glm::smoothstep(0.0, 200.0, near_shore);
    const double dx = (x - 175.0) / 62.0, dz = (z + 150.0) / 40.0, r = std::sqrt(dx * dx + dz * dz);
    const double island = (17.0 + 30.0 * rough) * (1.0 - glm::smoothstep(0.35, 1.0, r)) +
                          (r < 1.3 ? 8.0 * (1.0 - glm::smoothstep(0.9, 1.3, r)) : 0.0);
    return std::max(
        {plain + std::max(0.0, hills), near - 9.0 * glm::smoothstep(0.0, -60.0, near_shore), island - 8.0, -9.0});
}

void add_land(Assembly& scene, Index root) {
    Material soil = painted("land", 0.95);
    const Index ground = scene.add(soil);
    const Tint grown = [](double, double, glm::dvec3 p) {
        const double n = fractal_noise({0.02 * p.x, 0.02 * p.z}, 4);
        const glm::dvec3 green = glm::mix(glm::dvec3(0.075, 0.13, 0.03), glm::dvec3(0.26, 0.24, 0.075), n);
        const glm::dvec3 shore{0.40, 0.33, 0.22};
        const glm::dvec3 near = glm::mix(shore, green, glm::smoothstep(1.0, 4.0, p.y));
        return glm::mix(near, glm::dvec3(0.36, 0.38, 0.42), 0.75 * glm::smoothstep(900.0, 2400.0, p.x));  // haze
    };
    MeshBuilder m;
    const auto patch = [&](double x0, double x1, double z0, double z1, int nx, int nz) {
        m.surface(
            nx, nz,
            [=](double u, double v) {
                const double x = glm::mix(x0, x1, u), z = glm::mix(z0, z1, v);
                return glm::dvec3(x, land(x, z), z);
            },
            grown);
    };
    patch(380.0, 2500.0, 900.0, -2300.0, 110, 130);
    patch(100.0, 250.0, -95.0, -205.0, 36, 28);
    patch(-1000.0, -380.0, 700.0, -700.0, 30, 50);
    scene.add_node("land", root, {}, scene.add_mesh("land", m.take(ground)));

    Material deep = painted("water", 0.12);
    const Index water = scene.add(deep);
    const Surface river = [](double u, double v) {
        // Waves of three sizes; small ones only where the grid is fine, near the bridge.
        const double a = 2.0 * u - 0.7, b = 2.0 * v - 1.25;
        const double x = 480.0 * a * (0.35 + 0.65 * a * a), z = -1250.0 * b * (0.25 + 0.75 * b * b);
        const double calm = 1.0 / (1.0 + 4.0 * a * a + 6.0 * b * b);
        const double y = 1.6 * (fractal_noise({0.06 * x, 0.10 * z}, 3) - 0.5) * (0.25 + 0.75 * calm) +
                         0.5 * std::sin(0.11 * x + 0.05 * z);
        return glm::dvec3(x, y, z);
    };
    m.surface(190, 210, river, [](double, double, glm::dvec3 p) {
        const double far = glm::smoothstep(150.0, 1800.0, std::hypot(p.x + 70.0, p.z - 40.0));
        return glm::mix(glm::dvec3(0.020, 0.085, 0.105), glm::dvec3(0.20, 0.25, 0.29), far);
    });
    const Index surface = scene.add_node("river", root, {}, scene.add_mesh("river", m.take(water)));
    scene.animate_translation(surface, 13,
                              [](double t) { return glm::dvec3(1.5 * t, 0.12 * std::sin(2.0 * t), 9.0 * t); });
}

Primitive sail_boat(Index material, glm::dvec3 hull, glm::dvec3 sail) {
    MeshBuilder m;
    m.color = hull;
    loft(m,
         {{-5.0, 0.0, 0.5, 0.7},
          {-4.8, 1.3, -0.4, 1.0},
          {0.0, 1.7, -0.8, 1.1},
          {4.0, 0.8, -0.4, 1.3},
          {6.2, 0.0, 0.9, 1.3}},
         2.6, 14, 16);
    m.color = {0.75, 0.72, 0.66};
    m.box({-2.5, 1.0, -0.8}, {1.0, 1.7, 0.8});
    m.color = {0.30, 0.20, 0.12};
    m.tube({{{0.9, 0.8, 0.0}, 0.11}, {{0.9, 14.0, 0.0}, 0.06}}, 6, 1);
    m.color = sail;
    m.surface(8, 10, [](double u, double v) {
        return glm::dvec3(0.8 - 5.2 * u * (1.0 - v), 1.9 + 11.5 * v, 0.9 * std::sin(3.1 * u) * (1.0 - v) + 0.35 * u);
    });
    m.surface(8, 10, [](double u, double v) {
        return glm::dvec3(1.1 + 4.4 * u * (1.0 - v), 1.6 + 10.0 * v, 0.8 * std::sin(3.1 * u) * (1.0 - v));
    });
    m.color = glm::dvec3(0.22, 0.33, 0.37);
    m.surface(2, 8, [](double u, double v) {
        return glm::dvec3(-5.0 - 26.0 * v, 0.75 - 0.4 * v, (2.0 * u - 1.0) * (0.8 + 3.0 * v) * -1.0);
    });
    return m.take(material);
}

Primitive ferry(Index material) {
    MeshBuilder m;
    m.color = {0.05, 0.07, 0.10};
    loft(m,
         {{-24.0, 0.0, 1.5, 2.0},
          {-23.0, 4.6, -0.6, 3.4},
          {0.0, 5.6, -1.5, 3.3},
          {17.0, 4.2, -0.8, 3.8},
          {26.0, 0.0, 2.2, 4.4}},
         3.6, 20, 24);
    m.color = {0.80, 0.79, 0.75};
    m.box({-20.0, 3.2, -4.4}, {14.0, 6.0, 4.4});
    m.box({-16.0, 6.0, -3.8}, {10.0, 8.6, 3.8});
    m.box({2.0, 8.6, -2.8}, {9.0, 11.0, 2.8});
    m.color = {0.03, 0.04, 0.05};
    for (int k = 0; k < 12; ++k) {
        m.box({-18.5 + 2.6 * k, 4.2, -4.45}, {-16.7 + 2.6 * k, 5.3, 4.45});
        if (k < 9) m.box({-14.5 + 2.6 * k, 6.9, -3.85}, {-12.7 + 2.6 * k, 8.0, 3.85});
    }
    m.color = {0.60, 0.05, 0.03};
    m.lathe({{1.5, 8.6}, {1.5, 13.0}, {1.25, 13.1}, {0.0, 12.6}}, 14, 6);
    m.color = {0.24, 0.36, 0.40};
    m.surface(2, 16, [](double u, double v) {
        return glm::dvec3(-22.0 - 90.0 * v, 0.8 - 0.3 * v, (2.0 * u - 1.0) * (4.0 + 9.0 * v) * -1.0);
    });
    return m.take(material);
}

void add_boats(Assembly& scene, Index root) {
    Random random(19);
    Material cloth = painted("boats", 0.6);
    cloth.double_sided = true;
    const Index material = scene.add(cloth);
    const Index boats[] = {scene.add_mesh("sail boat", sail_boat(material, {0.70, 0.68, 0.64}, {0.82, 0.80, 0.75})),
                           scene.add_mesh("sail boat", sail_boat(material, {0.06, 0.14, 0.32}, {0.80, 0.76, 0.66})),
                           scene.add_mesh("sail boat", sail_boat(material, {0.42, 0.05, 0.03}, {0.70, 0.24, 0.10}))};
    for (int k = 0; k < 30; ++k) {
        const double x = random.range(40.0, 400.0), z = -random.range(30.0, 620.0), yaw = random.angle(),
                     size = random.range(0.9, 1.5);
        if (land(x, z) > -6.0) continue;
        const Index node = scene.add_node("sail boat", root, placed({x, 0.0, z}, yaw, size), boats[k % 3]);
        const glm::dvec3 ahead{6.0 * std::cos(yaw), 0.0, -6.0 * std::sin(yaw)};
        const double phase = random.angle();
        scene.animate_translation(
            node, 9, [=](double t) { return glm::dvec3(x, 0.2 * std::sin(2.0 * t + phase), z) + ahead * (t - 1.0); });
    }
    const Index ship = scene.add_mesh("ferry", ferry(material));
    struct Course {
        double x, z, yaw;
    };
    for (const Course& c : {Course{120.0, -70.0, 2.2}, Course{300.0, -330.0, -0.6}, Course{210.0, 70.0, 1.2},
                            Course{60.0, -260.0, 0.5}}) {
        const Index node = scene.add_node("ferry", root, placed({c.x, 0.0, c.z}, c.yaw), ship);
        scene.animate_translation(node, 9, [=](double t) {
            return glm::dvec3(c.x, 0.15 * std::sin(1.5 * t), c.z) +
                   11.0 * (t - 1.0) * glm::dvec3(std::cos(c.yaw), 0.0, -std::sin(c.yaw));
        });
    }
    // Gulls.
    MeshBuilder m;
    m.color = {0.80, 0.79, 0.76};
    m.surface(4, 6, [](double u, double v) {
        return glm::dvec3(0.28 * (1.0 - 2.0 * u) * (1.0 - 0.55 * v), 0.12 * std::sin(2.6 * v), 0.75 * v);
    });
    const Index wing = scene.add_mesh("gull's wing", m.take(material));
    m.color = {0.84, 0.83, 0.80};
    m.ellipsoid(glm::dvec3(0.0), {0.42, 0.13, 0.13}, 8, 6);
    m.color = {0.75, 0.42, 0.04};
    m.ellipsoid({0.44, 0.0, 0.0}, {0.12, 0.03, 0.03}, 5, 4);
    const Index body = scene.add_mesh("gull", m.take(material));
    for (int k = 0; k < 16; ++k) {
        const glm::dvec3 p =
            k < 4 ? glm::dvec3(kPlace + random.range(-30.0, -14.0), random.range(69.0, 78.0), random.range(17.0, 25.0))
                  : glm::dvec3(kPlace + random.range(0.0, 170.0), random.range(64.0, 105.0), random.range(-60.0, 10.0));
        const double phase = random.angle(), yaw = random.around(0.3, 0.5),
                     pace = random.range(0.75, 1.05) * (k < 4 ? kBus : 14.0);
        const Index gull = scene.add_node("gull", root, placed(p, yaw, 1.25), body);
        scene.animate_translation(gull, 13, [=](double t) {
            return p + pace * (t - 1.0) * glm::dvec3(std::cos(k < 4 ? 0.0 : yaw), 0.0, -std::sin(k < 4 ? 0.0 : yaw)) +
                   glm::dvec3(0.0, 0.25 * std::sin(9.0 * t + phase), 0.0);
        });
        for (const double side : {1.0, -1.0}) {
            Transform hinge;
            hinge.scale = {1.0, 1.0, side};
            const Index flap = scene.add_node("gull's wing", gull, hinge, wing);
            scene.animate_rotation(flap, 43, [=](double t) {
                return turn({1.0, 0.0, 0.0}, side * (-0.15 + 0.6 * std::sin(9.0 * t + phase)));
            });
        }
    }
}

// ---------------------------------------------------------------- trees and the city

Primitive leafy_tree(Index material, Random& random, const Palette& palette, int leaves) {
    MeshBuilder m;
    m.color = {0.11, 0.08, 0.055};
    m.tube({{{0.0, -0.6, 0.0}, 0.6}, {{0.1, 2.0, 0.0}, 0.38}, {{0.0, 5.0, 0.2}, 0.25}, {{0.1, 9.0, 0.0}, 0.06}}, 6, 5);
    for (int k = 0; k < leaves; ++k) {
        const glm::dvec3 d = random.direction();
        const double r = std::cbrt(random.uniform());
        Blade leaf;
        leaf.base = glm::dvec3(0.0, 7.2, 0.0) + r * d * glm::dvec3(3.7, 4.4, 3.7);
        leaf.axis = random.direction() + 0.6 * d;
        leaf.face = glm::dvec3(0.0, 0.8, 0.0) + d;
        leaf.length = random.range(0.9, 1.6);
        leaf.width = 0.55 * leaf.length;
        leaf.bend = 0.6;
        leaf.fold = 0.3;
        const glm::dvec3 color = palette.pick(random) * (0.35 + 0.65 * r) * (0.72 + 0.28 * d.y);
        m.blade(leaf, [&](double, double v, glm::dvec3) { return color * (0.8 + 0.3 * v); });
    }
    return m.take(material);
}

Primitive conifer(Index material, Random& random, const Palette& palette, int boughs) {
    MeshBuilder m;
    m.color = {0.10, 0.07, 0.05};
    m.tube({{{0.0, -0.6, 0.0}, 0.45}, {{0.0, 6.0, 0.0}, 0.25}, {{0.0, 15.0, 0.0}, 0.04}}, 6, 3);
    for (int k = 0; k < boughs; ++k) {
        const double t = (k + random.uniform()) / boughs, a = 2.399963 * k + random.around(0.0, 0.4);
        const glm::dvec3 out{std::cos(a), 0.0, std::sin(a)};
        Blade bough;
        bough.base = {0.0, 1.8 + 13.2 * t, 0.0};
        bough.axis = out + glm::dvec3(0.0, -0.25 + 0.5 * t, 0.0);
        bough.face = glm::dvec3(0.0, 1.0, 0.0) + 0.2 * out;
        bough.length = (3.6 - 3.2 * t) * random.range(0.8, 1.15);
        bough.width = 0.48 * bough.length + 0.15;
        bough.bend = 0.55;
        bough.fold = -0.35;
        bough.widest = 0.5;
        bough.segments = 3;
        const glm::dvec3 color = palette.pick(random) * (0.6 + 0.4 * t);
        m.blade(bough, [&](double, double v, glm::dvec3) { return color * (0.45 + 0.75 * v); });
    }
    return m.take(material);
}

void add_trees(Assembly& scene, Index root, int count) {
    Random random(23);
    Material leaves = painted("foliage", 0.75);
    leaves.double_sided = true;
    const Index material = scene.add(leaves);
    const Palette green{{0.045, 0.13, 0.025}, {0.19, 0.29, 0.05}, {0.32, 0.30, 0.06}, 0.1},
        autumn{{0.20, 0.16, 0.03}, {0.46, 0.28, 0.05}, {0.50, 0.16, 0.03}, 0.25},
        pine{{0.020, 0.065, 0.025}, {0.075, 0.15, 0.045}, {0.12, 0.17, 0.05}, 0.1};
    std::vector<Index> woods;
    const auto wood = [&](const char* name, Primitive tree) {
        woods.push_back(scene.add_node(name, root, {}, scene.add_mesh(name, std::move(tree))));
    };
    wood("tree", leafy_tree(material, random, green, 300));
    wood("tree", leafy_tree(material, random, green, 280));
    wood("tree", leafy_tree(material, random, autumn, 290));
    wood("pine", conifer(material, random, pine, 150));
    wood("pine", conifer(material, random, pine, 140));
    int planted = 0;
    while (planted < count) {
        // The island, the far shore, the streets, the hills, and the near bank.
        const double where = random.uniform();
        glm::dvec2 p{0.0};
        if (where < 0.15)
            p = glm::dvec2(175.0, -150.0) + glm::dvec2(52.0, 34.0) * random.in_disk();
        else if (where < 0.45)
            p = {random.range(450.0, 545.0), random.range(-900.0, 260.0)};
        else if (where < 0.60)
            p = {random.range(545.0, 1000.0), random.range(-900.0, 200.0)};
        else if (where < 0.90)
            p = {random.range(1000.0, 1500.0), random.range(-1300.0, 300.0)};
        else
            p = {random.range(-800.0, -480.0), random.range(-300.0, 300.0)};
        const int kind = random.below(5);
        const double yaw = random.angle(), size = random.range(0.75, 1.5) * (p.x > 1000.0 ? 1.5 : 1.0);
        const double y = land(p.x, p.y);
        if (y < 2.2 || std::abs(p.y) < 24.0) continue;
        scene.node(woods[std::size_t(kind)]).instances.push_back(placed({p.x, y, p.y}, yaw, size));
        ++planted;
    }
}

/// A tower block with a window in every field; `lit` of them shine.
Primitive building(Index material, Random& random, double width, double depth, double height, glm::dvec3 wall,
                   glm::dvec3 glass, double lit) {
    MeshBuilder m;
    m.color = wall;
    m.box({-0.5 * width, -6.0, -0.5 * depth}, {0.5 * width, height, 0.5 * depth});
    m.color = 0.8 * wall;
    m.box({-0.52 * width, height - 0.4, -0.52 * depth}, {0.52 * width, height + 0.8, 0.52 * depth});
    m.box({-0.2 * width, height, -0.25 * depth}, {0.25 * width, height + 4.0, 0.2 * depth});
    if (height > 90.0) m.tube({{{0.0, height, 0.0}, 0.8}, {{0.0, height + 22.0, 0.0}, 0.08}}, 6, 1);
    const int floors = static_cast<int>(height / 4.2);
    for (int face = 0; face < 4; ++face) {
        const double along_face = face % 2 == 0 ? width : depth, out = 0.5 * (face % 2 == 0 ? depth : width) + 0.06;
        const int columns = static_cast<int>(along_face / 3.6);
        m.transform = glm::rotate(glm::dmat4(1.0), degrees(90.0 * face), glm::dvec3(0.0, 1.0, 0.0));
        for (int f = 0; f < floors; ++f)
            for (int c = 0; c < columns; ++c) {
                const double x = along_face * ((c + 0.5) / columns - 0.5), y = 1.2 + 4.2 * f,
                             w = 0.36 * along_face / columns;
                const bool shines = random.chance(lit);
                const double shade = random.range(0.7, 1.3);
                const glm::dvec3 color = shines ? glm::dvec3(0.85, 0.58, 0.30) : glass * shade;
                const glm::dvec3 n{0.0, 0.0, 1.0};
                const std::uint32_t a = m.vertex({x - w, y, out}, n, {0.0, 0.0}, color),
                                    b = m.vertex({x + w, y, out}, n, {1.0, 0.0}, color),
                                    d = m.vertex({x + w, y + 2.6, out}, n, {1.0, 1.0}, color),
                                    e = m.vertex({x - w, y + 2.6, out}, n, {0.0, 1.0}, color);
                m.triangle(a, b, d);
                m.triangle(a, d, e);
            }
    }
    m.transform = glm::dmat4(1.0);
    return m.take(material);
}

void add_city(Assembly& scene, Index root, int count) {
    Random random(31);
    const Index stone = scene.add(painted("buildings", 0.55));
    const glm::dvec3 walls[] = {{0.40, 0.36, 0.31}, {0.31, 0.33, 0.37}, {0.46, 0.43, 0.40},
                                {0.34, 0.20, 0.15}, {0.46, 0.40, 0.42}, {0.28, 0.32, 0.38}};
    struct Kind {
        Index node;
        double height;
    };
    std::vector<Kind> kinds;
    for (int k = 0; k < 12; ++k) {
        const double height = k < 4   ? random.range(16.0, 28.0)
                              : k < 8 ? random.range(36.0, 62.0)
                                      : random.range(85.0, 150.0);
        const double width = k < 4 ? random.range(22.0, 34.0) : random.range(20.0, 28.0),
                     depth = random.range(16.0, 26.0);
        const glm::dvec3 glass = k % 2 == 0 ? glm::dvec3(0.11, 0.14, 0.19) : glm::dvec3(0.17, 0.18, 0.20);
        const Index mesh = scene.add_mesh(
            "building", building(stone, random, width, depth, height, walls[std::size_t(k % 6)], glass, 0.16));
        kinds.push_back({scene.add_node("buildings", root, {}, mesh), height});
    }
    for (int k = 0; k < count;) {
        // Blocks of a grid of streets; the tall ones downtown.
        const double x = 560.0 + 42.0 * random.below(11), z = -640.0 + 40.0 * random.below(21);
        const double downtown = std::exp(-std::pow((z + 300.0) / 170.0, 2.0));
        const std::size_t kind = random.chance(0.55 * downtown) ? std::size_t(8 + random.below(4))
                                 : random.chance(0.5)           ? std::size_t(4 + random.below(4))
                                                                : std::size_t(random.below(4));
        const double turned = degrees(90.0 * random.below(4)) + 0.12, stretch = random.range(0.85, 1.2);
        ++k;
        if (std::abs(z) < 30.0) continue;
        Transform t = placed({x, land(x, z), z}, turned);
        t.scale.y = stretch;
        scene.node(kinds[kind].node).instances.push_back(t);
    }
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
    add_land(scene, root);
    add_boats(scene, root);
    add_trees(scene, root, 430);
    add_city(scene, root, 210);
    add_sky(scene, root);
    return scene.take({0.35f, 0.36f, 0.42f});
}

}  // namespace pentaprism::builtin
