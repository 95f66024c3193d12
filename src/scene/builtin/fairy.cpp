#include "scene/builtin/fairy.h"

#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "scene/builtin/implicit.h"
#include "scene/builtin/mesh_builder.h"
#include "scene/builtin/textures.h"

namespace pentaprism::builtin {
namespace {

const glm::dvec3 kSkin{0.80, 0.46, 0.33};
const glm::dvec3 kBlush{0.85, 0.33, 0.24};
const glm::dvec3 kBodice{0.72, 0.10, 0.16};
const glm::dvec3 kTights{0.42, 0.52, 0.20};
const glm::dvec3 kShoe{0.60, 0.07, 0.10};
const glm::dvec3 kHair{0.50, 0.13, 0.03};
const glm::dvec3 kHairTip{0.85, 0.38, 0.08};

Primitive body(Index material) {
    // Groups: 1 left arm, 2 right arm, 3 left leg, 4 right leg; 0 melts into all of them.
    const std::vector<Limb> limbs{
        {{0.0, 7.25, 0.05}, {0.0, 7.6, 0.0}, 0.86, 0.92, kSkin, 0},
        {{0.0, 6.9, 0.28}, {0.0, 6.95, 0.3}, 0.5, 0.5, kSkin, 0},     // chin
        {{0.0, 7.28, 0.92}, {0.0, 7.2, 0.99}, 0.1, 0.09, kBlush, 0},  // nose
        {{0.42, 7.06, 0.62}, {0.42, 7.06, 0.62}, 0.24, 0.24, kBlush, 0},
        {{-0.42, 7.06, 0.62}, {-0.42, 7.06, 0.62}, 0.24, 0.24, kBlush, 0},
        {{0.8, 7.35, 0.0}, {1.5, 7.85, -0.3}, 0.24, 0.05, kSkin, 0},  // ears
        {{-0.8, 7.35, 0.0}, {-1.5, 7.85, -0.3}, 0.24, 0.05, kSkin, 0},
        {{0.0, 6.5, 0.0}, {0.0, 5.9, -0.05}, 0.26, 0.3, kSkin, 0},
        {{-0.6, 5.68, -0.05}, {0.6, 5.68, -0.05}, 0.27, 0.27, kSkin, 0},
        {{0.0, 5.3, 0.0}, {0.0, 4.6, 0.02}, 0.58, 0.46, kBodice, 0},
        {{0.0, 4.5, 0.0}, {0.0, 4.0, 0.0}, 0.42, 0.46, kBodice, 0},
        {{-0.25, 3.6, 0.0}, {0.25, 3.6, 0.0}, 0.52, 0.52, kTights, 0},
        {{0.82, 5.62, -0.05}, {1.45, 4.75, 0.55}, 0.23, 0.17, kSkin, 1},
        {{1.45, 4.75, 0.55}, {1.75, 5.6, 1.45}, 0.17, 0.11, kSkin, 1},
        {{1.75, 5.6, 1.45}, {1.8, 5.95, 1.65}, 0.14, 0.07, kSkin, 1},
        {{-0.82, 5.62, -0.05}, {-1.75, 5.25, -0.35}, 0.23, 0.17, kSkin, 2},
        {{-1.75, 5.25, -0.35}, {-2.5, 5.95, 0.15}, 0.17, 0.11, kSkin, 2},
        {{-2.5, 5.95, 0.15}, {-2.7, 6.3, 0.25}, 0.14, 0.07, kSkin, 2},
        {{0.3, 3.4, 0.0}, {0.42, 1.95, 0.65}, 0.42, 0.3, kTights, 3},
        {{0.42, 1.95, 0.65}, {0.36, 0.65, -0.25}, 0.29, 0.17, kTights, 3},
        {{0.36, 0.6, -0.25}, {0.38, 0.0, -0.15}, 0.19, 0.12, kShoe, 3},
        {{-0.3, 3.4, 0.0}, {-0.36, 1.9, -0.1}, 0.42, 0.3, kTights, 4},
        {{-0.36, 1.9, -0.1}, {-0.32, 0.55, -1.0}, 0.29, 0.17, kTights, 4},
        {{-0.32, 0.5, -1.02}, {-0.34, -0.15, -1.15}, 0.19, 0.12, kShoe, 4},
    };
    return ImplicitBody(limbs, 0.22).polygonize(0.135, material, false);
}

Primitive hair(Index material) {
    std::vector<Limb> limbs{
        {{0.0, 7.75, -0.2}, {0.0, 7.6, -0.35}, 0.99, 0.95, kHair, 0},
        {{-0.5, 8.2, 0.42}, {0.35, 8.3, 0.45}, 0.3, 0.36, kHair, 0},    // fringe
        {{0.0, 8.65, -0.55}, {0.0, 8.95, -0.75}, 0.42, 0.5, kHair, 0},  // knot
    };
    // Strands that the flight blows back.
    for (int k = 0; k < 7; ++k) {
        const double s = (k - 3) / 3.0;
        const glm::dvec3 a{0.62 * s, 7.6 - 0.4 * s * s, -0.75}, b{0.95 * s, 6.9 - 0.15 * (k % 2), -1.6},
            c{0.8 * s + 0.15 * (k % 3 - 1), 6.75 + 0.25 * (k % 2), -2.6}, d{0.7 * s, 6.5 + 0.4 * (k % 3), -3.4};
        limbs.push_back({a, b, 0.42, 0.32, kHair, 0});
        limbs.push_back({b, c, 0.32, 0.2, glm::mix(kHair, kHairTip, 0.5), 0});
        limbs.push_back({c, d, 0.2, 0.04, kHairTip, 0});
    }
    return ImplicitBody(limbs, 0.2).polygonize(0.17, material, false);
}

/// Skirt of two rings of petals, a crown of blossoms, and the eyes.
Primitive ornaments(Index material) {
    MeshBuilder m;
    for (int ring = 0; ring < 2; ++ring) {
        const int petals = ring == 0 ? 9 : 8;
        for (int k = 0; k < petals; ++k) {
            const double a = 6.283185307179586 * (k + 0.5 * ring) / petals;
            const glm::dvec3 out{std::sin(a), 0.0, std::cos(a)};
            const double flare = ring == 0 ? 0.75 : 0.45;
            const Blade petal{glm::dvec3(0.0, 4.15, 0.0) + 0.36 * out,
                              flare * out - glm::dvec3(0.0, 1.0, 0.0),
                              out + glm::dvec3(0.0, flare, 0.0),
                              ring == 0 ? 2.1 : 2.7,
                              1.5,
                              -0.75,
                              -0.25,
                              0.62,
                              8};
            m.blade(petal, [ring](double, double v, glm::dvec3) {
                const glm::dvec3 inner{0.72, 0.12, 0.2}, rim{0.9, 0.52, 0.5}, under{0.62, 0.06, 0.15};
                return ring == 0 ? glm::mix(inner, rim, v * v) : glm::mix(under, inner, v);
            });
        }
    }
    for (int k = 0; k < 7; ++k) {
        const double a = 6.283185307179586 * k / 7.0;
        const glm::dvec3 at =
            glm::dvec3(0.0, 8.15, -0.15) + 0.9 * glm::dvec3(std::sin(a), 0.1 * std::cos(a), 0.85 * std::cos(a));
        const glm::dvec3 out = glm::normalize(at - glm::dvec3(0.0, 7.6, -0.15));
        const Frame frame = frame_around(out);
        for (int p = 0; p < 5; ++p) {
            const double b = 6.283185307179586 * p / 5.0;
            const glm::dvec3 along_petal = std::cos(b) * frame.side + std::sin(b) * frame.up;
            m.blade({at, along_petal + 0.5 * out, out - 0.5 * along_petal, 0.3, 0.2, 0.4, 0.2, 0.6, 3},
                    [](double, double v, glm::dvec3) {
                        return glm::mix(glm::dvec3(0.9, 0.6, 0.3), glm::dvec3(0.92, 0.88, 0.9), v);
                    });
        }
        m.color = {0.9, 0.5, 0.05};
        m.ellipsoid(at + 0.04 * out, glm::dvec3(0.09), 6, 4);
    }
    for (const double side : {1.0, -1.0}) {
        m.color = {0.012, 0.02, 0.02};
        m.ellipsoid({0.37 * side, 7.42, 0.79}, {0.14, 0.21, 0.1}, 12, 8);
        m.color = {1.0, 1.0, 1.0};
        m.ellipsoid({0.33 * side + 0.05, 7.5, 0.88}, {0.045, 0.055, 0.03}, 8, 6);
        m.color = kHair * 0.6;
        m.ellipsoid({0.38 * side, 7.74, 0.78}, {0.2, 0.035, 0.06}, 8, 5);
    }
    m.color = {0.62, 0.08, 0.08};
    m.ellipsoid({0.0, 6.94, 0.79}, {0.14, 0.05, 0.05}, 8, 5);
    return m.take(material);
}

/// One wing along +x with its leading edge up, `length` long. The outline swells towards the tip.
Primitive wing(double length, double width, double droop, Index material) {
    MeshBuilder m;
    const Surface p = [=](double u, double v) {
        const double swell = std::sin(3.14159265 * std::pow(v, 0.75)) * (0.42 + 0.72 * v) + 0.06 * (1.0 - v);
        const double scallop = 1.0 + 0.05 * std::sin(25.0 * v) * u;
        const double y =
            width * swell * scallop * (0.42 - u) - droop * v * v * length + 0.12 * length * std::sin(2.6 * v);
        const double camber = 0.1 * width * std::sin(3.14159265 * u) * std::sin(3.14159265 * v);
        return glm::dvec3(length * v, y, -camber);
    };
    m.surface(8, 20, p);
    return m.take(material);
}

}  // namespace

void add_fairy(Assembly& assembly, Index parent, double beats) {
    const Index skin = assembly.add(painted("fairy skin", 0.55));
    const Index hair_material = assembly.add(painted("fairy hair", 0.4));
    Material silk = painted("fairy petals", 0.5);
    silk.double_sided = true;
    silk.emissive = {0.03f, 0.008f, 0.012f};
    const Index petals = assembly.add(silk);

    Material membrane = painted("fairy wing", 0.2);
    membrane.base_color_texture =
        texture(assembly.add(wing_texture("fairy wing", {0.62, 0.85, 0.95}, {0.95, 0.72, 0.42}, 0.32)));
    membrane.base_color_texture.wrap_s = membrane.base_color_texture.wrap_t = Wrap::kClampToEdge;
    membrane.emissive = {0.30f, 0.30f, 0.28f};
    membrane.emissive_texture = membrane.base_color_texture;
    membrane.alpha_mode = AlphaMode::kBlend;
    membrane.double_sided = true;
    const Index wing_material = assembly.add(membrane);

    std::vector<Primitive> parts;
    parts.push_back(body(skin));
    parts.push_back(hair(hair_material));
    parts.push_back(ornaments(petals));
    assembly.add_node("fairy body", parent, {}, assembly.add_mesh("fairy", std::move(parts)));

    struct Wing {
        const char* name;
        Index mesh;
        double height, rise, opening, amplitude, lag;
    };
    const Index upper = assembly.add_mesh("upper wing", wing(6.6, 3.0, -0.12, wing_material));
    const Index lower = assembly.add_mesh("lower wing", wing(4.6, 2.6, 0.12, wing_material));
    for (const Wing& w : {Wing{"upper wing", upper, 5.45, 0.55, 0.62, 0.62, 0.0},
                          Wing{"lower wing", lower, 4.9, -0.28, 0.5, 0.5, 0.5}}) {
        for (const double side : {1.0, -1.0}) {
            Transform hinge;
            hinge.translation = {0.18 * side, w.height, -0.5};
            const Index node =
                assembly.add_node(std::string(side > 0.0 ? "left " : "right ") + w.name, parent, hinge, w.mesh);
            // Half a turn about y makes the right wing out of the left one, with the leading edge still in front.
            assembly.animate_rotation(node, 1 + static_cast<int>(12.0 * beats * assembly.duration()), [=](double t) {
                const double stroke = w.opening + w.amplitude * std::sin(6.283185307179586 * beats * t + 0.7 - w.lag);
                const glm::dquat open = turn({0.0, 1.0, 0.0}, side > 0.0 ? stroke : 3.141592653589793 - stroke);
                return open * turn({0.0, 0.0, 1.0}, w.rise);
            });
        }
    }
}

}  // namespace pentaprism::builtin
