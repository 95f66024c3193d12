// The traffic on the bridge: cars, trucks, a double-decker, trains.

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

namespace {

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

}  // namespace

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

}  // namespace pentaprism::builtin
