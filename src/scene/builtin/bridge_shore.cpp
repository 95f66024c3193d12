// What lies around the bridge: land, water, boats, trees and the city.

#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include "scene/builtin/assembly.h"
#include "scene/builtin/bridge_parts.h"
#include "scene/builtin/plants.h"
#include "scene/builtin/random.h"
#include "scene/builtin/recipes.h"
#include "scene/builtin/textures.h"

namespace pentaprism::builtin {
namespace {

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

}  // namespace

void add_shore(Assembly& scene, Index root) {
    add_land(scene, root);
    add_boats(scene, root);
    add_trees(scene, root, 430);
    add_city(scene, root, 210);
}

}  // namespace pentaprism::builtin
