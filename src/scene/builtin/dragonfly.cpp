// dragonfly: a macro view, 22 cm from the lens, of a dragonfly that hovers over a lily pond in the morning. Thin veined
// wings beat fast, reeds stand right before the lens, the far bank dissolves.

#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "scene/builtin/assembly.h"
#include "scene/builtin/implicit.h"
#include "scene/builtin/plants.h"
#include "scene/builtin/recipes.h"
#include "scene/builtin/textures.h"

namespace pentaprism::builtin {
namespace {

constexpr double kDuration = 3.0;
constexpr double kFocus = 0.22;
constexpr double kTwoPi = 6.283185307179586;

const Palette kReed{{0.05, 0.12, 0.02}, {0.19, 0.30, 0.05}, {0.38, 0.30, 0.10}, 0.12};

// ---------------------------------------------------------------- the dragonfly, in millimetres, head towards +z

const glm::dvec3 kBlue{0.02, 0.22, 0.42}, kTeal{0.02, 0.34, 0.30}, kBlack{0.012, 0.014, 0.018};

Primitive thorax(Index material) {
    const std::vector<Limb> limbs{
        {{0.0, 0.0, -2.5}, {0.0, 0.6, 4.0}, 3.4, 3.9, kTeal, 0},
        {{0.0, 2.2, 0.0}, {0.0, 2.4, 3.2}, 2.4, 2.2, kBlue, 0},
        {{1.6, 0.2, 3.0}, {2.0, -1.4, -1.5}, 2.3, 2.0, kBlack, 0},
        {{-1.6, 0.2, 3.0}, {-2.0, -1.4, -1.5}, 2.3, 2.0, kBlack, 0},
        {{2.9, 0.8, 1.8}, {2.7, -0.6, -1.4}, 1.0, 0.9, {0.55, 0.60, 0.08}, 0},
        {{-2.9, 0.8, 1.8}, {-2.7, -0.6, -1.4}, 1.0, 0.9, {0.55, 0.60, 0.08}, 0},
        {{0.0, 0.2, 6.0}, {0.0, 0.2, 7.4}, 1.3, 1.5, kBlack, 0},
    };
    return ImplicitBody(limbs, 1.2).polygonize(0.62, material, false);
}

/// Ten segments, each a little swollen, the last ones wider.
Primitive abdomen(Index material) {
    MeshBuilder m;
    const Surface p = [](double u, double v) {
        const double segment = 10.0 * v - std::floor(10.0 * v);
        const double club =
            1.0 + 0.35 * std::exp(-std::pow((v - 0.83) / 0.1, 2.0)) + 0.5 * std::exp(-std::pow(v / 0.09, 2.0));
        const double end = std::sqrt(std::max(0.0, 1.0 - std::pow(v, 14.0)));
        const double r = 1.45 * club * end * (0.93 + 0.1 * std::sin(3.14159265 * segment));
        const double sag = 2.6 * std::sin(2.2 * v);
        const double a = kTwoPi * u;
        return glm::dvec3(r * std::cos(a), 0.3 - sag + 0.92 * r * std::sin(a), -2.5 - 44.0 * v);
    };
    m.surface(18, 80, p, [](double u, double v, glm::dvec3) {
        const double segment = 10.0 * v - std::floor(10.0 * v);
        const double ring = glm::smoothstep(0.80, 0.9, segment);
        const double belly = glm::smoothstep(-0.1, -0.6, std::sin(kTwoPi * u));
        const glm::dvec3 blue = glm::mix(glm::dvec3(0.03, 0.30, 0.52), glm::dvec3(0.02, 0.16, 0.45), v);
        return glm::mix(glm::mix(blue, kBlack, ring), kBlack, 0.7 * belly);
    });
    for (const double side : {1.0, -1.0}) {
        m.color = kBlack;
        m.tube({{{0.4 * side, -1.9, -46.2}, 0.32}, {{0.8 * side, -1.9, -47.6}, 0.3}, {{0.7 * side, -1.8, -49.0}, 0.08}},
               6, 6);
    }
    return m.take(material);
}

Primitive head_and_eyes(Index material) {
    MeshBuilder m;
    m.color = {0.30, 0.42, 0.06};
    m.ellipsoid({0.0, -0.4, 9.0}, {2.4, 2.0, 1.7}, 24, 14);
    m.color = {0.62, 0.56, 0.12};
    m.ellipsoid({0.0, -1.0, 10.2}, {1.5, 1.2, 0.9}, 18, 10);
    for (const double side : {1.0, -1.0}) {
        m.ellipsoid({2.15 * side, 0.5, 8.9}, {2.25, 2.5, 2.3}, 28, 18, [](double, double v, glm::dvec3) {
            return glm::mix(glm::dvec3(0.10, 0.36, 0.20), glm::dvec3(0.20, 0.03, 0.04), glm::smoothstep(0.35, 0.8, v));
        });
        m.color = kBlack;
        m.tube({{{0.6 * side, 1.2, 10.3}, 0.12}, {{0.9 * side, 2.2, 11.1}, 0.08}, {{1.0 * side, 2.9, 11.9}, 0.03}}, 5,
               4);
    }
    return m.take(material);
}

Primitive legs(Index material) {
    MeshBuilder m;
    m.color = kBlack;
    for (const double side : {1.0, -1.0})
        for (int k = 0; k < 3; ++k) {
            const double z = 4.6 - 2.2 * k, back = 1.2 - 2.4 * k;
            const glm::dvec3 hip{1.4 * side, -2.6, z}, knee{(4.0 - 0.3 * k) * side, -5.2, z + 0.5 * back},
                foot{(2.6 + 0.6 * k) * side, -8.8, z + back}, toe{(2.9 + 0.8 * k) * side, -10.8, z + 1.4 * back};
            m.tube({{hip, 0.55},
                    {glm::mix(hip, knee, 0.6), 0.45},
                    {knee, 0.36},
                    {glm::mix(knee, foot, 0.5), 0.27},
                    {foot, 0.2},
                    {toe, 0.06}},
                   6, 14);
            for (int b = 0; b < 6; ++b) {
                const glm::dvec3 at = glm::mix(knee, foot, 0.15 + 0.14 * b);
                m.tube({{at, 0.07}, {at + glm::dvec3(0.7 * side, 0.1, -0.2), 0.01}}, 3, 1);
            }
        }
    return m.take(material);
}

/// A wing along +x, leading edge towards +z, with the folds between its veins.
Primitive wing(double length, double width, Index material) {
    MeshBuilder m;
    m.surface(20, 44, [=](double u, double v) {
        const double chord = width *
                             (0.24 + 0.76 * std::pow(std::sin(3.14159265 * std::pow(0.04 + 0.96 * v, 0.62)), 0.6)) *
                             std::pow(std::max(0.0, 1.0 - std::pow(v, 9.0)), 0.5);
        const double lead = 0.05 * length * std::sin(3.0 * v) - 0.06 * length * v * v;
        const double corrugation = 0.016 * width * std::sin(34.0 * std::pow(u, 0.7)) * (1.0 - 0.7 * v);
        const double camber = 0.05 * width * std::sin(3.14159265 * u) - 0.035 * length * v * v;
        return glm::dvec3(length * v, camber + corrugation, lead - chord * (u - 0.12));
    });
    return m.take(material);
}

struct DragonflyParts {
    Index body, fore, hind;
};

DragonflyParts make_dragonfly(Assembly& pond) {
    Material chitin = painted("dragonfly body", 0.28);
    chitin.metallic = 0.25f;
    Material eye = painted("dragonfly eye", 0.12);
    const Index chitin_index = pond.add(chitin), eye_index = pond.add(eye);
    Material membrane = painted("dragonfly wing", 0.4);
    membrane.base_color_texture =
        texture(pond.add(wing_texture("dragonfly wing", {0.70, 0.80, 0.78}, {0.05, 0.03, 0.015}, 0.26)));
    membrane.base_color_texture.wrap_s = membrane.base_color_texture.wrap_t = Wrap::kClampToEdge;
    membrane.alpha_mode = AlphaMode::kBlend;
    membrane.double_sided = true;
    const Index wing_index = pond.add(membrane);
    std::vector<Primitive> parts;
    parts.push_back(thorax(chitin_index));
    parts.push_back(abdomen(chitin_index));
    parts.push_back(legs(chitin_index));
    parts.push_back(head_and_eyes(eye_index));
    return {pond.add_mesh("dragonfly", std::move(parts)), pond.add_mesh("fore wing", wing(46.0, 10.5, wing_index)),
            pond.add_mesh("hind wing", wing(43.0, 13.5, wing_index))};
}

/// `beats` in hertz; the hind wings follow the fore wings by half a beat, as when a dragonfly hovers.
void add_dragonfly(Assembly& pond, const DragonflyParts& parts, Index parent, double beats, double phase) {
    pond.add_node("dragonfly body", parent, {}, parts.body);
    for (int pair = 0; pair < 2; ++pair)
        for (const double side : {1.0, -1.0}) {
            Transform hinge;
            hinge.translation = {1.2 * side, 3.2, pair == 0 ? 3.0 : -1.2};
            const std::string name =
                std::string(side > 0.0 ? "left " : "right ") + (pair == 0 ? "fore wing" : "hind wing");
            // The right wing is the left one mirrored.
            hinge.scale = {side, 1.0, 1.0};
            const Index node = pond.add_node(name, parent, hinge, pair == 0 ? parts.fore : parts.hind);
            pond.animate_rotation(node, 1 + static_cast<int>(12.0 * beats * kDuration), [=](double t) {
                const double a = kTwoPi * beats * t + phase + 2.4 * pair;
                const double stroke = degrees(6.0) + degrees(27.0) * std::sin(a), twist = degrees(14.0) * std::cos(a);
                const double sweep = degrees(pair == 0 ? 9.0 : -12.0);
                return turn({0.0, 0.0, 1.0}, side * stroke) * turn({0.0, 1.0, 0.0}, -side * sweep) *
                       turn({1.0, 0.0, 0.0}, twist);
            });
        }
}

void add_dragonflies(Assembly& pond) {
    const DragonflyParts parts = make_dragonfly(pond);
    const auto hover = [](double t) {
        return glm::dvec3(0.012 + 0.007 * (t - 1.0) + 0.003 * std::sin(3.1 * t),
                          0.058 + 0.004 * std::sin(2.3 * t + 1.0), 0.002 * std::sin(1.7 * t));
    };
    const Index hero = pond.add_node("dragonfly", kNone, {hover(0.0), {1.0, 0.0, 0.0, 0.0}, glm::dvec3(0.0014)});
    pond.animate_translation(hero, 25, hover);
    pond.animate_rotation(hero, 25, [](double t) {
        return turn({0.0, 1.0, 0.0}, degrees(44.0 + 3.0 * std::sin(1.9 * t))) *
               turn({1.0, 0.0, 0.0}, degrees(33.0 + 3.0 * std::sin(2.3 * t))) *
               turn({0.0, 0.0, 1.0}, degrees(22.0 + 3.0 * std::sin(2.9 * t)));
    });
    add_dragonfly(pond, parts, hero, 4.0, 1.0);

    const auto pass = [](double t) { return glm::dvec3(0.20 - 0.16 * t, 0.16 + 0.01 * std::sin(3.0 * t), -0.26); };
    const Index rival =
        pond.add_node("second dragonfly", kNone, {pass(0.0), turn({0.0, 1.0, 0.0}, degrees(-80.0)), glm::dvec3(0.001)});
    pond.animate_translation(rival, 25, pass);
    add_dragonfly(pond, parts, rival, 5.0, 0.3);
}

// ---------------------------------------------------------------- the pond, in metres

void add_water(Assembly& pond) {
    Material water = painted("water", 0.08);
    MeshBuilder m;
    m.surface(
        64, 96,
        [](double u, double v) {
            const double z = 0.35 - 5.0 * std::pow(v, 2.2);
            const double x = (2.0 * u - 1.0) * (0.4 + 3.6 * std::pow(v, 1.6));
            // Rings from where the dragonfly's downwash touches the water, over a faint swell.
            const double r = glm::length(glm::dvec2(x - 0.02, z));
            const double rings = 0.0012 * std::sin(150.0 * r) * std::exp(-9.0 * r);
            const double swell = 0.004 * (fractal_noise({9.0 * x, 16.0 * z}, 3) - 0.5);
            return glm::dvec3(x, rings + swell, z);
        },
        [](double, double, glm::dvec3 p) {
            // The sky's reflection is painted: bright bands where the ripples face it, more of them far away.
            const double band = fractal_noise({7.0 * p.x, 34.0 * p.z}, 4), distance = glm::smoothstep(-0.1, 1.6, -p.z);
            const double mirrored = glm::smoothstep(0.62 - 0.35 * distance, 0.80 - 0.25 * distance, band);
            const glm::dvec3 deep{0.008, 0.036, 0.036}, sky{0.30, 0.36, 0.28};
            return glm::mix(deep * (0.7 + 0.6 * band), sky, 0.75 * mirrored);
        });
    pond.add_node("water", kNone, {}, pond.add_mesh("water", m.take(pond.add(water))));
}

/// Pads with a notch and upturned rims, some with flowers, that bob.
void add_water_lilies(Assembly& pond) {
    Random random(19);
    Material leathery = painted("lily pad", 0.3);
    leathery.double_sided = true;
    MeshBuilder m;
    m.surface(
        40, 8,
        [](double u, double v) {
            const double a = degrees(12.0) + degrees(336.0) * u;
            const double wave = 0.035 * std::sin(5.0 * a) * v * v;
            return glm::dvec3(-v * std::sin(a), wave + 0.05 * std::pow(v, 8.0) + 0.01 * (1.0 - v), v * std::cos(a));
        },
        [](double u, double v, glm::dvec3) {
            const double vein = std::pow(0.5 + 0.5 * std::cos(kTwoPi * 14.0 * u), 8.0) * (1.0 - 0.5 * v);
            const glm::dvec3 green = glm::mix(glm::dvec3(0.05, 0.17, 0.04), glm::dvec3(0.13, 0.28, 0.05), v);
            return glm::mix(glm::mix(green, glm::dvec3(0.24, 0.36, 0.10), 0.6 * vein), glm::dvec3(0.30, 0.12, 0.05),
                            glm::smoothstep(0.9, 1.0, v));
        });
    const Index pad = pond.add_mesh("lily pad", m.take(pond.add(leathery)));
    const glm::dvec3 pads[] = {
        {-0.075, -0.035, 0.042}, {0.085, -0.06, 0.05}, {0.01, 0.075, 0.030}, {-0.16, 0.03, 0.038}, {0.15, 0.02, 0.036},
        {-0.05, -0.17, 0.052},   {0.20, -0.20, 0.06},  {-0.26, -0.22, 0.06}, {0.05, -0.36, 0.065}, {-0.42, -0.5, 0.07},
        {0.40, -0.55, 0.07},     {-0.1, -0.7, 0.08},   {0.15, -0.95, 0.09},  {-0.75, -1.0, 0.09},  {0.8, -1.1, 0.1}};
    for (const glm::dvec3& p : pads) {
        const double yaw = random.angle();
        const Index node =
            pond.add_node("lily pad", kNone, {{p.x, 0.003, p.y}, turn({0.0, 1.0, 0.0}, yaw), glm::dvec3(p.z)}, pad);
        pond.sway(node, {1.0, 0.0, 0.6}, degrees(1.6), random.range(1.4, 2.2), random.angle());
    }

    Material silk = painted("lily flower", 0.45);
    silk.double_sided = true;
    silk.emissive = {0.03f, 0.012f, 0.02f};
    MeshBuilder f;
    for (int ring = 0; ring < 4; ++ring) {
        const int petals = 11 - ring;
        for (int k = 0; k < petals; ++k) {
            const double a = kTwoPi * (k + 0.5 * ring) / petals, rise = 0.25 + 0.32 * ring;
            const glm::dvec3 out{std::sin(a), 0.0, std::cos(a)}, up{0.0, 1.0, 0.0};
            f.blade({0.12 * out, std::cos(rise) * out + std::sin(rise) * up, std::cos(rise) * up - std::sin(rise) * out,
                     1.05 - 0.12 * ring, 0.42, -0.75, 0.3, 0.5, 6},
                    [ring](double, double v, glm::dvec3) {
                        return glm::mix(glm::dvec3(0.90, 0.78, 0.74), glm::dvec3(0.86, 0.22 + 0.06 * ring, 0.42), v);
                    });
        }
    }
    for (int k = 0; k < 24; ++k) {
        const double a = 2.4 * k, r = 0.06 + 0.008 * k;
        f.color = {0.9, 0.55, 0.03};
        f.tube({{{r * std::sin(a), 0.05, r * std::cos(a)}, 0.02},
                {{1.3 * r * std::sin(a), 0.32, 1.3 * r * std::cos(a)}, 0.03}},
               4, 2);
    }
    const Index flower = pond.add_mesh("lily flower", f.take(pond.add(silk)));
    for (const glm::dvec3& p : {glm::dvec3(-0.068, -0.045, 0.024), glm::dvec3(0.17, -0.17, 0.030),
                                glm::dvec3(-0.36, -0.48, 0.034), glm::dvec3(0.11, -0.75, 0.04)}) {
        const Index node = pond.add_node(
            "lily flower", kNone, {{p.x, 0.004, p.y}, turn({0.0, 1.0, 0.0}, 7.0 * p.x), glm::dvec3(p.z)}, flower);
        pond.sway(node, {1.0, 0.0, 0.6}, degrees(2.0), 1.7, 9.0 * p.x);
    }
}

void add_reeds(Assembly& pond) {
    Random random(29);
    Material leafy = painted("reed", 0.5);
    leafy.double_sided = true;
    const Index material = pond.add(leafy);
    std::vector<Index> clumps;
    for (int i = 0; i < 2; ++i) {
        MeshBuilder m;
        add_grass_tuft(m, random, 14, 1.0, kReed);
        for (int k = 0; k < 3; ++k) {  // bulrushes
            const glm::dvec2 foot = 0.2 * random.in_disk();
            const double height = random.range(0.8, 1.1);
            m.color = {0.12, 0.18, 0.04};
            m.tube({{{foot.x, 0.0, foot.y}, 0.012},
                    {{1.3 * foot.x, 0.5 * height, 1.3 * foot.y}, 0.01},
                    {{1.7 * foot.x, height, 1.7 * foot.y}, 0.006}},
                   6, 8);
            m.color = {0.16, 0.07, 0.025};
            const glm::dvec3 top{1.6 * foot.x, 0.9 * height, 1.6 * foot.y};
            m.tube({{top - glm::dvec3(0.0, 0.10, 0.0), 0.004},
                    {top - glm::dvec3(0.0, 0.085, 0.0), 0.03},
                    {top, 0.033},
                    {top + glm::dvec3(0.0, 0.085, 0.0), 0.028},
                    {top + glm::dvec3(0.0, 0.1, 0.0), 0.003}},
                   10, 14);
        }
        clumps.push_back(pond.add_mesh("reeds", m.take(material)));
    }
    const auto plant = [&](double x, double z, double height, int kind) {
        const double yaw = random.angle();
        const Index node = pond.add_node(
            "reeds", kNone, {{x, -0.01, z}, turn({0.0, 1.0, 0.0}, yaw), glm::dvec3(height)}, clumps[std::size_t(kind)]);
        pond.sway(node, {0.2, 0.0, 1.0}, degrees(random.range(1.5, 3.0)), random.range(1.4, 2.4), random.angle());
    };
    plant(-0.105, 0.095, 0.15, 0);  // right before the lens
    plant(0.115, 0.105, 0.12, 1);
    plant(-0.20, -0.10, 0.30, 1);
    plant(0.27, -0.22, 0.34, 0);
    plant(-0.33, -0.38, 0.42, 0);
    for (int k = 0; k < 13; ++k) {
        const double z = -0.7 - 2.4 * k / 12.0;
        const double x = (k % 2 == 0 ? -1.0 : 1.0) * (0.25 + random.uniform() * 0.75) * (0.25 - 0.62 * z);
        plant(x, z, random.range(0.45, 0.9), k % 2);
    }
}

/// The far bank in the morning haze, behind everything and in no light's way, with the sun's glitter before it.
void add_far_bank(Assembly& pond) {
    MeshBuilder m;
    m.surface(
        40, 24,
        [](double u, double v) {
            const double a = degrees(-50.0 + 100.0 * u);
            return glm::dvec3(5.0 * std::sin(a), -0.15 + 3.2 * v, 0.22 - 5.0 * std::cos(a));
        },
        [](double u, double v, glm::dvec3) {
            const double trees = fractal_noise({12.0 * u, 2.0}, 4);
            const glm::dvec3 wood = glm::mix(glm::dvec3(0.05, 0.11, 0.06), glm::dvec3(0.16, 0.22, 0.09),
                                             fractal_noise({18.0 * u, 14.0 * v}, 3));
            const glm::dvec3 sky =
                glm::mix(glm::dvec3(0.95, 0.74, 0.46), glm::dvec3(0.36, 0.52, 0.62), glm::smoothstep(0.2, 0.7, v));
            return glm::mix(wood, sky, glm::smoothstep(-0.05, 0.08, v - 0.14 - 0.34 * trees));
        });
    pond.add_node("far bank", kNone, {}, pond.add_mesh("far bank", m.take(pond.add(backdrop("far bank")))));

    Random random(37);
    Material glint = painted("glitter");
    glint.base_color = {0.0f, 0.0f, 0.0f, 1.0f};
    glint.emissive = {8.0f, 6.2f, 3.4f};
    MeshBuilder s;
    s.ellipsoid(glm::dvec3(0.0), glm::dvec3(1.0), 6, 4);
    const Index mesh = pond.add_mesh("glitter", s.take(pond.add(glint)));
    for (int k = 0; k < 48; ++k) {
        const double depth = 0.42 + 1.3 * std::pow(random.uniform(), 1.5);
        const double x = random.around(-0.33 * depth, 0.17 * depth);
        const double size = 0.0042 * (depth - kFocus) * random.range(0.5, 1.1);
        const Index node =
            pond.add_node("glitter", kNone, {{x, 0.006, 0.22 - depth}, {1.0, 0.0, 0.0, 0.0}, glm::dvec3(size)}, mesh);
        const double phase = random.angle(), rate = random.range(4.0, 8.0);
        pond.animate_scale(node, 31,
                           [=](double t) { return glm::dvec3(size * (0.55 + 0.45 * std::sin(rate * t + phase))); });
    }
}

void add_camera_and_light(Assembly& pond) {
    const Index camera = pond.add_camera("macro", {}, {35.0, 8.0, kFocus, 0.5, 7});
    const auto eye = [](double t) { return glm::dvec3(-0.006 + 0.008 * (t - 1.0), 0.066, 0.22); };
    pond.animate_translation(camera, 7, eye);
    pond.animate_rotation(camera, 7, [=](double t) {
        return looking(eye(t), {0.003 + 0.005 * (t - 1.0), 0.053, 0.0});
    });
    pond.add_sun("morning sun", {-0.55, 0.55, -0.35}, {1.0f, 0.78f, 0.50f}, 6.0);
    pond.add_sun("sky", {0.2, 1.0, 0.3}, {0.60f, 0.80f, 1.0f}, 1.6);
    pond.add_sun("fill", {0.5, 0.4, 1.0}, {1.0f, 0.92f, 0.82f}, 2.0);
}

}  // namespace

Scene dragonfly() {
    Assembly pond("builtin:dragonfly", kDuration);
    add_camera_and_light(pond);
    add_water(pond);
    add_far_bank(pond);
    add_water_lilies(pond);
    add_reeds(pond);
    add_dragonflies(pond);
    return pond.take({0.42f, 0.48f, 0.45f});
}

}  // namespace pentaprism::builtin
