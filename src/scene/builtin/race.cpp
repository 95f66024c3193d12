// race: five racing cars of the sixties in a fast right-hand bend before a full grandstand, seen through a long lens
// from a car that runs ahead of them. The leader is sharp, the others fall out of focus one after the other, the crowd
// streaks past.

#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include "scene/builtin/assembly.h"
#include "scene/builtin/plants.h"
#include "scene/builtin/racing_car.h"
#include "scene/builtin/random.h"
#include "scene/builtin/recipes.h"
#include "scene/builtin/textures.h"

namespace pentaprism::builtin {
namespace {

constexpr double kDuration = 2.0;
constexpr double kSpeed = 26.0;    // metres per second along the middle of the road
constexpr double kRadius = 190.0;  // of the bend
constexpr double kHalfRoad = 5.2;

/// The place `s` metres along the middle of the road and `d` to its left; a right-hand bend, so left is outside.
glm::dvec3 on_track(double s, double d, double height = 0.0) {
    const double a = s / kRadius, r = kRadius + d;
    return {r * std::sin(a), height, kRadius - r * std::cos(a)};
}

glm::dquat heading(double s) {
    return turn({0.0, 1.0, 0.0}, -s / kRadius);
}

// ---------------------------------------------------------------- the cars

struct Entry {
    RacingCarLook look;
    double s, d;   ///< place on the track at one second
    double gain;   ///< metres per second faster than the field
    double drift;  ///< degrees that its nose points into the bend
};

void add_cars(Assembly& scene) {
    RacingCars cars(scene);
    const Entry entries[] = {
        {{"red car", "red livery", {0.55, 0.010, 0.008}, {0.88, 0.86, 0.80}, 5, {0.82, 0.80, 0.74}},
         0.0,
         0.5,
         0.0,
         3.0},
        {{"blue car", "blue livery", {0.012, 0.065, 0.36}, {0.85, 0.84, 0.80}, 8, {0.75, 0.06, 0.04}},
         -5.2,
         -2.1,
         0.8,
         2.0},
        {{"green car", "green livery", {0.006, 0.085, 0.040}, {0.85, 0.60, 0.02}, 1, {0.05, 0.10, 0.30}},
         -10.5,
         3.0,
         0.4,
         4.0},
        {{"yellow car", "yellow livery", {0.80, 0.46, 0.010}, {0.02, 0.02, 0.02}, 3, {0.02, 0.02, 0.02}},
         -15.5,
         1.0,
         -0.3,
         2.0},
        {{"white car", "white livery", {0.78, 0.77, 0.74}, {0.55, 0.02, 0.015}, 9, {0.70, 0.45, 0.02}},
         -21.0,
         4.3,
         0.6,
         3.0},
    };
    double phase = 0.3;
    for (const Entry& e : entries) {
        const double speed = kSpeed + e.gain;
        const auto s = [=](double t) { return kSpeed + e.s + speed * (t - 1.0) + 0.06 * std::sin(2.3 * t + phase); };
        RacingCarMotion motion;
        motion.place = [=](double t) { return on_track(s(t), e.d + 0.10 * std::sin(1.9 * t + phase)); };
        motion.heading = [=](double t) {
            return heading(s(t)) * turn({0.0, 1.0, 0.0}, degrees(-e.drift + 0.7 * std::sin(2.7 * t + phase)));
        };
        motion.speed = speed;
        motion.steer = degrees(2.0);  // a little opposite lock
        motion.lean_deg = -2.2;
        motion.phase = phase;
        cars.add(e.look, motion);
        phase += 1.7;
    }
}

// ---------------------------------------------------------------- the track

constexpr double kFrom = -95.0, kTo = 130.0;  // along the track

/// A ribbon along the track from left distance d0 to d1, its texture in metres.
void ribbon(MeshBuilder& m, double d0, double d1, double h0, double h1, int pieces, const Tint& tint) {
    m.surface(
        pieces, 2,
        [=](double u, double v) { return on_track(glm::mix(kFrom, kTo, u), glm::mix(d0, d1, v), glm::mix(h0, h1, v)); },
        tint);
}

Primitive in_metres(Primitive p) {
    for (std::size_t i = 0; i < p.positions.size(); ++i) p.texcoords[0][i] = {p.positions[i].x, p.positions[i].z};
    return p;
}

void add_track(Assembly& scene) {
    Material asphalt = painted("asphalt", 0.8), grass = painted("grass", 0.95);
    const Index litter = scene.add(litter_texture());
    asphalt.base_color_texture = texture(litter, glm::dvec2(0.45));
    grass.base_color_texture = texture(litter, glm::dvec2(0.3));
    MeshBuilder m;
    std::vector<Primitive> ground;
    ribbon(m, -kHalfRoad, kHalfRoad, 0.0, 0.0, 130, [](double, double v, glm::dvec3) {
        // The line the cars take is black with rubber.
        const double d = std::abs(v - 0.52);
        return glm::dvec3(0.165, 0.165, 0.175) * (0.62 + 0.75 * glm::smoothstep(0.05, 0.4, d));
    });
    ground.push_back(in_metres(m.take(scene.add(asphalt))));
    const Tint meadow = [](double, double, glm::dvec3 p) {
        const double n = fractal_noise({0.35 * p.x, 0.7 * p.z}, 3);
        return glm::mix(glm::dvec3(0.075, 0.19, 0.03), glm::dvec3(0.27, 0.36, 0.075), n);
    };
    ribbon(m, kHalfRoad + 0.9, 16.0, 0.02, 0.1, 120, meadow);
    ribbon(m, 16.0, 150.0, 0.1, 2.5, 60, meadow);
    ribbon(m, -24.0, -kHalfRoad - 0.9, -0.1, 0.02, 120, meadow);
    ground.push_back(in_metres(m.take(scene.add(grass))));
    scene.add_node("ground", kNone, {}, scene.add_mesh("ground", std::move(ground)));

    // Kerbs on both sides, lines along them.
    MeshBuilder paint;
    for (const double side : {1.0, -1.0}) {
        for (int k = 0; k < 190; ++k) {
            const double s = kFrom + 1.18 * k;
            paint.color = k % 2 == 0 ? glm::dvec3(0.66, 0.025, 0.018) : glm::dvec3(0.80, 0.79, 0.76);
            paint.surface(1, 2, [=](double u, double v) {
                const double w = side > 0.0 ? v : 1.0 - v;
                return on_track(s + 1.18 * u, side * (kHalfRoad + 0.95 * w), 0.01 + 0.07 * std::sin(1.9 * w));
            });
        }
        paint.color = {0.78, 0.77, 0.73};
        paint.surface(60, 1, [=](double u, double v) {
            return on_track(glm::mix(-60.0, kTo, u), side * (kHalfRoad - 0.32) + 0.15 * v, 0.006);
        });
    }
    scene.add_node("kerbs", kNone, {}, scene.add_mesh("kerbs", paint.take(scene.add(painted("road paint", 0.55)))));
}

// ---------------------------------------------------------------- what stands beside it

/// A transform with its x axis along the track and its z axis towards the road from the left side.
Transform beside(double s, double d, double height, double scale = 1.0, double yaw = 0.0) {
    return {on_track(s, d, height), heading(s) * turn({0.0, 1.0, 0.0}, yaw), glm::dvec3(scale)};
}

constexpr int kTiers = 7;
constexpr double kStandDepth = 0.95, kStandRise = 0.55, kStandWidth = 16.0;

/// One section of the grandstand, its front at z = 0, x from -8 to 8.
Primitive grandstand(Index material) {
    MeshBuilder m;
    const double half = 0.5 * kStandWidth;
    for (int tier = 0; tier < kTiers; ++tier) {
        m.color = tier % 2 == 0 ? glm::dvec3(0.36, 0.35, 0.34) : glm::dvec3(0.30, 0.29, 0.285);
        m.box({-half, 0.0, -kStandDepth * (tier + 1)}, {half, 1.5 + kStandRise * tier, -kStandDepth * tier});
    }
    const double back = -kStandDepth * kTiers, top = 1.5 + kStandRise * kTiers;
    m.color = {0.05, 0.11, 0.26};
    m.box({-half, 0.0, back - 0.3}, {half, top + 3.3, back});
    m.color = {0.72, 0.71, 0.68};
    m.box({-half, top + 3.0, back - 0.6}, {half, top + 3.25, 1.2});  // roof
    m.color = {0.62, 0.03, 0.02};
    m.box({-half, top + 2.75, 1.15}, {half, top + 3.45, 1.3});
    m.color = {0.70, 0.69, 0.66};
    for (const double x : {-0.5, 0.0, 0.5}) {
        m.box({x * kStandWidth - 0.09, 0.0, 0.45}, {x * kStandWidth + 0.09, top + 3.0, 0.63});
    }
    m.box({-half, 2.15, 0.1}, {half, 2.22, 0.16});  // rail
    return m.take(material);
}

/// A spectator: legs, body, arms, a head with a hat. Few triangles: they are never in focus.
Primitive spectator(Index material, glm::dvec3 shirt, glm::dvec3 hat, double raise) {
    MeshBuilder m;
    m.color = shirt;
    m.ellipsoid({0.0, 0.42, 0.0}, {0.23, 0.36, 0.16}, 5, 4);
    m.color = {0.62, 0.38, 0.27};
    m.ellipsoid({0.0, 0.90, 0.02}, {0.11, 0.15, 0.12}, 5, 3);
    m.color = hat;
    m.ellipsoid({0.0, 0.98, 0.0}, {0.125, 0.08, 0.13}, 4, 3);
    m.color = shirt * 0.9;
    m.tube({{{0.21, 0.62, 0.0}, 0.06}, {{0.34, 0.62 + 0.45 * raise, 0.08}, 0.045}}, 3, 1);
    return m.take(material);
}

void add_grandstand(Assembly& scene) {
    Random random(7);
    const Index concrete = scene.add(painted("grandstand", 0.85)), cloth = scene.add(painted("crowd", 0.8));
    const Index stand_mesh = scene.add_mesh("grandstand", grandstand(concrete));
    const glm::dvec3 shirts[] = {{0.72, 0.70, 0.65}, {0.60, 0.05, 0.04}, {0.06, 0.16, 0.46},
                                 {0.70, 0.46, 0.04}, {0.05, 0.28, 0.12}, {0.32, 0.55, 0.66}};
    const glm::dvec3 hats[] = {{0.75, 0.70, 0.55}, {0.08, 0.05, 0.03}, {0.72, 0.72, 0.72},
                               {0.16, 0.08, 0.03}, {0.62, 0.05, 0.04}, {0.22, 0.13, 0.05}};
    std::vector<Index> people;
    for (int k = 0; k < 6; ++k)
        people.push_back(scene.add_mesh("spectator", spectator(cloth, shirts[k], hats[k], k % 3 == 1 ? 1.0 : -0.6)));
    constexpr double kLeft = 20.0;  // of the road's middle
    std::array<Index, 6> rows{};
    for (std::size_t k = 0; k < 6; ++k) rows[k] = scene.add_node("crowd", kNone, {}, people[k]);
    for (int section = 0; section < 4; ++section) {
        const double s = -42.0 + section * (kStandWidth + 0.25);
        const Transform place = beside(s, kLeft, 0.0);
        scene.add_node("grandstand", kNone, place, stand_mesh);
        for (int tier = 0; tier < kTiers; ++tier)
            for (double x = -7.5; x < 7.6; x += 0.72) {
                const double shift = random.around(0.0, 0.13), turned = random.around(0.0, 0.5),
                             size = random.range(0.92, 1.12);
                const int who = random.below(6);
                if (random.chance(0.26)) continue;
                const glm::dvec3 seat{x + shift, 1.45 + kStandRise * tier, -kStandDepth * (tier + 0.45)};
                scene.node(rows[std::size_t(who)])
                    .instances.push_back({place.translation + place.rotation * seat,
                                          place.rotation * turn({0.0, 1.0, 0.0}, turned), glm::dvec3(size)});
            }
    }
    // A crowd that cheers: each sixth of it hops in its own time.
    for (std::size_t k = 0; k < 6; ++k)
        scene.animate_translation(rows[k], 33, [=](double t) {
            return glm::dvec3(0.0, 0.05 * std::abs(std::sin(5.5 * t + 1.1 * double(k))), 0.0);
        });

    // Flags on the roof.
    MeshBuilder m;
    m.color = {0.7, 0.7, 0.7};
    m.tube({{{0.0, 0.0, 0.0}, 0.05}, {{0.0, 3.2, 0.0}, 0.03}}, 6, 1);
    const Index pole = scene.add_mesh("flag pole", m.take(concrete));
    Material silk = painted("flag", 0.7);
    silk.double_sided = true;
    const Index silk_index = scene.add(silk);
    for (int k = 0; k < 12; ++k) {
        const glm::dvec3 a = shirts[std::size_t(k * 5 % 6)], b = shirts[std::size_t((k * 5 + 2) % 6)];
        m.surface(
            12, 6,
            [=](double u, double v) { return glm::dvec3(-1.9 * u, 3.1 - 1.1 * v, 0.16 * u * std::sin(7.0 * u + k)); },
            [=](double, double v, glm::dvec3) { return v < 0.34   ? a
                                                       : v < 0.67 ? glm::dvec3(0.78)
                                                                  : b; });
        const Index flag = scene.add_mesh("flag", m.take(silk_index));
        const Transform place = beside(-46.0 + 5.8 * k, kLeft - 0.6, 1.5 + kStandRise * kTiers + 3.2);
        scene.add_node("flag pole", kNone, place, pole);
        scene.sway(scene.add_node("flag", kNone, place, flag), {0.0, 1.0, 0.0}, degrees(16.0), random.range(0.5, 0.8),
                   random.angle());
    }
}

/// A hoarding's picture: a name of a maker that never was, as bars and a sign.
Image hoarding_picture(int kind, glm::dvec3 ground, glm::dvec3 ink) {
    return paint("hoarding " + std::to_string(kind), 256, 64, 3, [=](double u, double v) {
        const double x = 4.0 * u, y = v;  // in heights
        bool on = false;
        if (kind % 3 == 0) {  // a roundel and strokes of letters
            const double r = std::hypot(x - 0.55, y - 0.5);
            on = (r < 0.34 && r > 0.20) || r < 0.09;
            const double cell = (x - 1.15) / 0.42, f = cell - std::floor(cell);
            if (cell > 0.0 && cell < 6.0 && y > 0.26 && y < 0.74)
                on = f < 0.30 || (f < 0.78 && (std::abs(y - (0.32 + 0.18 * (static_cast<int>(cell) % 3))) < 0.06));
        } else if (kind % 3 == 1) {  // slanting bars
            const double slant = (x + 0.5 * y) / 0.52, f = slant - std::floor(slant);
            on = y > 0.18 && y < 0.82 && f < 0.55 && x > 0.25 && x < 3.75;
        } else {  // checkers and a bar
            on = x < 0.9 || x > 3.1 ? ((static_cast<int>(x / 0.15) + static_cast<int>(y / 0.167)) & 1) != 0
                                    : y > 0.34 && y < 0.66;
        }
        return glm::dvec4(on ? ink : ground, 1.0);
    });
}

void add_roadside(Assembly& scene) {
    Random random(13);
    const Index plain = scene.add(painted("roadside", 0.8));
    const glm::dvec3 grounds[] = {{0.74, 0.70, 0.62}, {0.62, 0.03, 0.02}, {0.03, 0.12, 0.36},
                                  {0.76, 0.50, 0.03}, {0.02, 0.22, 0.10}, {0.05, 0.05, 0.055}};
    const glm::dvec3 inks[] = {{0.55, 0.02, 0.02}, {0.78, 0.76, 0.70}, {0.78, 0.76, 0.70},
                               {0.02, 0.02, 0.02}, {0.78, 0.60, 0.05}, {0.78, 0.76, 0.70}};
    std::vector<Index> boards;
    MeshBuilder m;
    for (int k = 0; k < 6; ++k) {
        Material sheet = painted("hoarding", 0.5);
        sheet.base_color_texture = texture(scene.add(hoarding_picture(k, grounds[k], inks[k])));
        const Index sheet_index = scene.add(sheet);
        m.surface(1, 1, [](double u, double v) { return glm::dvec3(-2.45 + 4.9 * u, 1.25 * v, 0.0); });
        Primitive front = m.take(sheet_index);
        for (glm::vec2& uv : front.texcoords[0]) uv.y = 1.0f - uv.y;
        m.color = {0.3, 0.3, 0.3};
        m.box({-2.5, 0.0, -0.08}, {2.5, 1.28, -0.01});
        m.color = glm::dvec3(1.0);
        std::vector<Primitive> parts;
        parts.push_back(std::move(front));
        parts.push_back(m.take(plain));
        boards.push_back(scene.add_mesh("hoarding", std::move(parts)));
    }
    for (int k = 0; k < 26; ++k)
        scene.add_node("hoarding", kNone, beside(-78.0 + 5.4 * k, 10.6, 0.12), boards[std::size_t(k * 7 % 6)]);

    // Stacks of tyres before the hoardings, painted now and then.
    std::vector<Index> stacks;
    for (int kind = 0; kind < 2; ++kind) {
        for (int k = 0; k < 3; ++k) {
            m.color = kind == 1 && k == 1 ? glm::dvec3(0.72, 0.70, 0.66) : glm::dvec3(0.028, 0.028, 0.030);
            const double y = 0.21 * k;
            m.lathe({{0.17, y + 0.02}, {0.33, y}, {0.36, y + 0.10}, {0.33, y + 0.20}, {0.17, y + 0.19}}, 9, 3);
        }
        stacks.push_back(scene.add_node("tyres", kNone, {}, scene.add_mesh("tyres", m.take(plain))));
    }
    for (int k = 0; k < 44; ++k) {
        const double s = k < 22 ? -20.0 + 0.76 * k : 16.0 + 0.76 * (k - 22);
        scene.node(stacks[std::size_t(k % 5 == 0)]).instances.push_back(beside(s, 9.7, 0.08));
    }

    // A gantry over the road.
    m.color = {0.68, 0.67, 0.64};
    for (const double side : {1.0, -1.0})
        for (const double x : {0.0, 1.0}) m.box({x - 0.09, 0.0, side * 7.4 - 0.09}, {x + 0.09, 5.2, side * 7.4 + 0.09});
    m.color = {0.62, 0.03, 0.02};
    m.box({-0.15, 5.0, -7.6}, {1.15, 6.5, 7.6});
    m.color = {0.80, 0.79, 0.75};
    for (int k = 0; k < 30; ++k)
        for (int row = 0; row < 3; ++row)
            if ((k + row) % 2 == 0)
                m.box({1.14, 5.0 + 0.5 * row, -7.5 + 0.5 * k}, {1.18, 5.5 + 0.5 * row, -7.0 + 0.5 * k});
    scene.add_node("gantry", kNone, beside(-30.0, 0.0, 0.0), scene.add_mesh("gantry", m.take(plain)));

    // Trees behind it all.
    Material leafy = painted("foliage", 0.7);
    leafy.double_sided = true;
    const Index leafy_index = scene.add(leafy);
    std::vector<Index> crowns;
    for (int kind = 0; kind < 2; ++kind) {
        MeshBuilder trunk, crown;
        DistantTreeStyle style;
        style.trunk = {
            {{0.0, -0.2, 0.0}, 0.35}, {{0.05, 1.6, 0.0}, 0.22}, {{0.0, 4.0, 0.1}, 0.13}, {{0.1, 6.4, 0.0}, 0.04}};
        style.trunk_around = 7;
        style.trunk_along = 6;
        style.leaves = 115;
        style.crown_height = 5.2;
        style.crown_radii = {2.4, 3.0, 2.4};
        style.shortest_leaf = 0.9;
        style.longest_leaf = 1.5;
        style.leaf_width = 0.55;
        style.inner_light = 0.35;
        style.low_light = 0.4;
        const Palette palette = kind == 0 ? Palette{{0.035, 0.13, 0.025}, {0.16, 0.30, 0.05}, {0.30, 0.34, 0.07}, 0.1}
                                          : Palette{{0.06, 0.15, 0.03}, {0.24, 0.33, 0.06}, {0.42, 0.30, 0.05}, 0.15};
        add_distant_tree(trunk, crown, random, style, palette);
        std::vector<Primitive> parts;
        parts.push_back(trunk.take(plain));
        parts.push_back(crown.take(leafy_index));
        crowns.push_back(scene.add_mesh("tree", std::move(parts)));
    }
    for (int k = 0; k < 18; ++k) {
        const double s = -90.0 + 10.5 * k + random.around(0.0, 2.5), d = random.range(31.0, 48.0), yaw = random.angle();
        scene.add_node("tree", kNone, beside(s, d, 0.3, random.range(1.1, 1.9), yaw), crowns[std::size_t(k % 2)]);
    }
}

void add_sky(Assembly& scene) {
    MeshBuilder m;
    m.surface(
        44, 14,
        [](double u, double v) {
            const double a = degrees(120.0 + 150.0 * u);
            return glm::dvec3(26.0 + 230.0 * std::sin(a - degrees(20.0)), -4.0 + 110.0 * v,
                              60.0 + 230.0 * std::cos(a - degrees(20.0)));
        },
        [](double u, double v, glm::dvec3) {
            const double cloud = fractal_noise({22.0 * u, 13.0 * v}, 5);
            const glm::dvec3 clear =
                glm::mix(glm::dvec3(0.66, 0.70, 0.72), glm::dvec3(0.13, 0.33, 0.66), glm::smoothstep(0.03, 0.42, v));
            const glm::dvec3 above =
                glm::mix(clear, glm::dvec3(0.96, 0.93, 0.88), 0.85 * glm::smoothstep(0.48, 0.70, cloud));
            const double hills = fractal_noise({14.0 * u, 3.0}, 3);
            return glm::mix(glm::dvec3(0.16, 0.25, 0.20), above, glm::smoothstep(0.0, 0.02, v - 0.05 - 0.06 * hills));
        });
    scene.add_node("sky", kNone, {}, scene.add_mesh("sky", m.take(scene.add(backdrop("sky")))));
}

void add_camera_and_light(Assembly& scene) {
    const Index camera = scene.add_camera("ahead of the field", {}, {66.0, 0.85, 12.3, 0.5, 0});
    const auto eye = [](double t) {
        const double s = kSpeed * t + 11.0 + 0.5 * (t - 1.0);
        return on_track(s, -5.0 + 0.3 * (t - 1.0), 1.15);
    };
    const auto target = [](double t) { return on_track(kSpeed * t - 2.6 - 0.15 * (t - 1.0), -0.15, 1.32); };
    scene.animate_translation(camera, 13, eye);
    scene.animate_rotation(camera, 13, [=](double t) { return looking(eye(t), target(t)); });
    scene.add_sun("sun", {0.75, 0.70, 0.55}, {1.0f, 0.90f, 0.74f}, 4.6);
    scene.add_sun("sky light", {-0.2, 1.0, 0.15}, {0.55f, 0.72f, 1.0f}, 1.5);
    // What road and meadow throw back reaches under the roof of the grandstand.
    scene.add_sun("bounce", {0.35, 0.15, 0.93}, {1.0f, 0.93f, 0.82f}, 1.5);
}

}  // namespace

Scene race() {
    Assembly scene("builtin:race", kDuration);
    add_camera_and_light(scene);
    add_track(scene);
    add_roadside(scene);
    add_grandstand(scene);
    add_sky(scene);
    add_cars(scene);
    return scene.take({0.45f, 0.58f, 0.75f});
}

}  // namespace pentaprism::builtin
