// conan: a barbarian on a windy hill at dusk cuts the air with his sword, fire and sparks behind him. One implicit
// body, muscle by muscle, gives the mesh and its skin weights; its rest pose is the middle of the stroke, which the
// animation swings about. Fur, cape and boots follow the same bones.

#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include "scene/builtin/assembly.h"
#include "scene/builtin/conan_body.h"
#include "scene/builtin/conan_dress.h"
#include "scene/builtin/implicit.h"
#include "scene/builtin/mesh_builder.h"
#include "scene/builtin/plants.h"
#include "scene/builtin/random.h"
#include "scene/builtin/recipes.h"
#include "scene/builtin/textures.h"

namespace pentaprism::builtin {
namespace {

using namespace barbarian;

constexpr double kTwoPi = 6.283185307179586;
constexpr double kDuration = 3.0;

// ---------------------------------------------------------------- how he moves

/// The stroke: -1 (sword back and high) to +1 (low before him); fastest, and 0, at one second.
double stroke(double t) {
    return std::sin(3.1 * (t - 1.0));
}

Index add_skeleton(Assembly& scene, Index root) {
    Skin rig;
    rig.name = "barbarian";
    for (const Joint& joint : kJoints) {
        Transform local;
        local.translation = joint.place - (joint.parent < 0 ? glm::dvec3(0.0) : at(joint.parent));
        const Index parent = joint.parent < 0 ? root : rig.joints[std::size_t(joint.parent)];
        rig.joints.push_back(scene.add_node(joint.name, parent, local));
        rig.inverse_bind_matrices.push_back(glm::mat4(glm::translate(glm::dmat4(1.0), -joint.place)));
    }
    const auto move = [&](int bone, const std::function<glm::dquat(double)>& f) {
        scene.animate_rotation(rig.joints[std::size_t(bone)], 43, f);
    };
    const glm::dvec3 x{1.0, 0.0, 0.0}, y{0.0, 1.0, 0.0}, z{0.0, 0.0, 1.0};
    move(kSpine, [=](double t) { return turn(y, degrees(10.0 * stroke(t))) * turn(x, degrees(5.0 * stroke(t))); });
    move(kChest, [=](double t) { return turn(y, degrees(12.0 * stroke(t))) * turn(z, degrees(4.0 * stroke(t))); });
    move(kNeck, [=](double t) { return turn(y, degrees(-9.0 * stroke(t))); });
    move(kHead, [=](double t) { return turn(y, degrees(-8.0 * stroke(t) - 10.0)) * turn(x, degrees(4.0)); });
    const glm::dvec3 chop = glm::normalize(glm::dvec3(0.30, 0.25, 0.92));
    move(kRightArm, [=](double t) { return turn(chop, degrees(34.0 * stroke(t))); });
    move(kRightForearm, [=](double t) { return turn(chop, degrees(20.0 * stroke(t - 0.02))); });
    move(kRightHand, [=](double t) { return turn(chop, degrees(26.0 * stroke(t - 0.04))); });
    move(kLeftArm, [=](double t) { return turn(x, degrees(-12.0 * stroke(t))) * turn(z, degrees(-6.0 * stroke(t))); });
    move(kLeftForearm, [=](double t) { return turn({1.0, 0.6, 0.0}, degrees(-12.0 * stroke(t))); });
    for (int k = 0; k < 4; ++k)
        move(kCape1 + k, [=](double t) {
            const double phase = 7.0 * t - 1.1 * k;
            return turn(z, degrees((4.0 + 4.0 * k) * std::sin(phase))) *
                   turn({0.5, 1.0, 0.0}, degrees(5.0 * std::sin(0.8 * phase + 0.5)));
        });
    for (int k = 0; k < 2; ++k)
        move(kTail1 + k, [=](double t) {
            return turn({0.3, 1.0, 0.5}, degrees((6.0 + 7.0 * k) * std::sin(8.0 * t - 0.9 * k)));
        });
    move(kSkirt, [=](double t) { return turn({1.0, 0.0, 0.4}, degrees(-4.0 + 7.0 * std::sin(6.0 * t + 0.6))); });
    scene.scene().skins.push_back(std::move(rig));
    return static_cast<Index>(scene.scene().skins.size() - 1);
}

void add_barbarian(Assembly& scene) {
    const Index root = scene.add_node("barbarian", kNone, {});
    const Index rig = add_skeleton(scene, root);
    const Index skin_material = scene.add(painted("skin", 0.5));
    const Index hair_material = scene.add(painted("hair", 0.38));
    const Index gear_material = scene.add(painted("gear", 0.36));
    Material furry = painted("fur", 0.75), red = painted("cloth", 0.85);
    furry.double_sided = red.double_sided = true;
    const Index fur_material = scene.add(furry), cloth_material = scene.add(red);

    const ImplicitBody body(anatomy(), 0.034);
    std::vector<Primitive> parts;
    parts.push_back(skin(body, 0.0122, skin_material));
    parts.push_back(hair(body, hair_material, 0.0105));
    parts.push_back(gear(body, gear_material));
    parts.push_back(furs(body, fur_material, {1850, 1850, 360}));
    parts.push_back(cloth(body, cloth_material));
    for (Primitive& part : parts) part.texcoords[0].clear();
    const Index node = scene.add_node("body", kNone, {}, scene.add_mesh("barbarian", std::move(parts)));
    scene.node(node).skin = rig;

    Material steel = painted("blade", 0.22), fittings = painted("hilt", 0.4);
    steel.metallic = 0.55f;
    const Index hand = scene.scene().skins[std::size_t(rig)].joints[kRightHand];
    const glm::dmat4 held = frame_at(kGrip, kBladeAxis, {0.55, 0.25, 0.8});
    Transform grip;
    grip.translation = kGrip - at(kRightHand);
    grip.rotation = glm::normalize(glm::quat_cast(glm::dmat3(held)));
    scene.add_node("sword", hand, grip, scene.add_mesh("sword", sword(scene.add(steel), scene.add(fittings))));
}

// ---------------------------------------------------------------- the hill

double hill(double x, double z) {
    const double r = std::hypot(x, z + 0.1);
    const double rough =
        0.16 * (fractal_noise({1.6 * x + 40.0, 1.6 * z + 40.0}, 4) - 0.5) * glm::smoothstep(0.25, 1.2, r);
    return rough - 0.10 * glm::smoothstep(0.7, 4.0, r) - 0.9 * glm::smoothstep(2.0, 9.0, r);
}

void add_hill(Assembly& scene) {
    Random random(37);
    Material ground = painted("ground", 0.95);
    ground.base_color_texture = texture(scene.add(litter_texture()));
    const Index ground_material = scene.add(ground), rock_material = scene.add(painted("rock", 0.9));
    MeshBuilder m;
    m.uv_scale = {14.0, 14.0};
    m.surface(
        52, 52,
        [](double u, double v) {
            // Fine near him, coarse far away.
            const double a = 2.0 * u - 1.0, b = 1.0 - 2.0 * v;
            const double x = 11.0 * a * (0.25 + 0.75 * a * a), z = -2.0 + 9.0 * b * (0.25 + 0.75 * b * b);
            return glm::dvec3(x, hill(x, z), z);
        },
        [](double, double, glm::dvec3 p) {
            const double n = fractal_noise({2.2 * p.x, 2.2 * p.z}, 4);
            const double contact = 0.45 + 0.55 * glm::smoothstep(0.0, 0.42,
                                                                 std::min(std::hypot(p.x + 0.42, p.z + 0.10),
                                                                          std::hypot(p.x - 0.36, p.z - 0.24)));
            return glm::mix(glm::dvec3(0.16, 0.105, 0.065), glm::dvec3(0.25, 0.20, 0.085), n) * contact;
        });
    m.uv_scale = glm::dvec2(1.0);
    scene.add_node("hill", kNone, {}, scene.add_mesh("hill", m.take(ground_material)));

    std::vector<Index> rocks;
    for (int kind = 0; kind < 3; ++kind) {
        const double seed = 10.0 * kind;
        m.surface(
            20, 12,
            [=](double u, double v) {
                const double a = kTwoPi * u, b = 3.14159265 * v, s = v <= 0.0 || v >= 1.0 ? 0.0 : std::sin(b);
                const glm::dvec3 d{s * std::sin(a), -std::cos(b), s * std::cos(a)};
                const double n = fractal_noise({1.7 * d.x + 1.3 * d.y + seed, 1.7 * d.z - 0.9 * d.y + seed}, 4);
                return d * glm::dvec3(1.0, 0.75, 0.9) * (0.72 + 0.55 * n);
            },
            [](double, double v, glm::dvec3 p) {
                const double n = fractal_noise({6.0 * p.x + 3.0 * p.y, 6.0 * p.z}, 3);
                return glm::mix(glm::dvec3(0.05, 0.043, 0.04), glm::dvec3(0.16, 0.135, 0.11), n) * (0.45 + 0.55 * v);
            });
        rocks.push_back(scene.add_mesh("rock", m.take(rock_material)));
    }
    struct Spot {
        double x, z, size;
    };
    const Spot spots[] = {{-0.95, 0.30, 0.20}, {-1.25, 0.05, 0.30},  {0.85, 0.55, 0.16}, {1.15, 0.15, 0.24},
                          {0.62, -0.55, 0.30}, {-0.60, -0.75, 0.34}, {1.9, -0.9, 0.5},   {-2.2, -1.2, 0.6},
                          {0.15, 0.72, 0.10},  {-0.2, 1.1, 0.13}};
    for (const Spot& s : spots) {
        const int kind = random.below(3);
        const double yaw = random.angle();
        scene.add_node("rock", kNone,
                       {{s.x, hill(s.x, s.z) + 0.1 * s.size, s.z}, turn({0.1, 1.0, 0.05}, yaw), glm::dvec3(s.size)},
                       rocks[std::size_t(kind)]);
    }

    Material dry = painted("dry grass", 0.7);
    dry.double_sided = true;
    MeshBuilder tuft;
    add_grass_tuft(tuft, random, 16, 1.0, {{0.16, 0.11, 0.04}, {0.42, 0.31, 0.12}, {0.30, 0.30, 0.10}, 0.2});
    const Index grass = scene.add_mesh("dry grass", tuft.take(scene.add(dry)));
    for (int k = 0; k < 44; ++k) {
        const double z = k < 8 ? random.range(3.2, 4.6) : random.range(-3.5, 2.0);
        const double x = k < 8 ? random.around(0.0, 1.0) : random.around(0.0, 2.6);
        const double yaw = random.angle(), size = random.range(0.20, 0.38);
        if (std::hypot(x, z) < 0.6) continue;
        const Index node = scene.add_node("dry grass", kNone,
                                          {{x, hill(x, z), z}, turn({0.0, 1.0, 0.0}, yaw), glm::dvec3(size)}, grass);
        scene.sway(node, {random.around(0.0, 0.4), 0.0, 1.0}, degrees(random.range(5.0, 9.0)), random.range(0.7, 1.1),
                   random.angle());
    }
    // Standing stones.
    MeshBuilder stones;
    for (const Spot& s : {Spot{-4.6, -7.5, 3.4}, Spot{-2.6, -9.5, 3.0}, Spot{3.4, -8.5, 3.6}, Spot{5.6, -6.5, 2.9},
                          Spot{1.2, -12.0, 2.6}, Spot{-6.8, -5.5, 2.6}}) {
        stones.transform = glm::translate(glm::dmat4(1.0), glm::dvec3(s.x, hill(s.x, s.z) - 0.3, s.z));
        stones.surface(
            14, 14,
            [&](double u, double v) {
                const double a = kTwoPi * u,
                             taper = (0.52 - 0.16 * v) * std::sqrt(std::max(0.0, 1.0 - std::pow(v, 7.0)));
                const double n = 0.8 + 0.4 * fractal_noise({3.0 * std::sin(a) + s.x, 4.0 * v + std::cos(a)}, 3);
                return glm::dvec3(taper * n * std::sin(a) + 0.12 * v, s.size * v, 0.6 * taper * n * std::cos(a));
            },
            [](double u, double v, glm::dvec3) {
                return glm::dvec3(0.075, 0.066, 0.062) * (0.6 + 0.8 * fractal_noise({8.0 * u, 8.0 * v}, 3));
            });
    }
    stones.transform = glm::dmat4(1.0);
    scene.add_node("standing stones", kNone, {}, scene.add_mesh("standing stones", stones.take(rock_material)));
}

/// Torches and camp fires far behind, and sparks on the wind.
void add_fire(Assembly& scene) {
    Random random(43);
    std::vector<Index> glows;
    for (const glm::vec3& color :
         {glm::vec3(6.5f, 2.1f, 0.35f), glm::vec3(5.5f, 1.1f, 0.15f), glm::vec3(7.0f, 3.6f, 1.0f)}) {
        Material light = painted("fire");
        light.base_color = {0.0f, 0.0f, 0.0f, 1.0f};
        light.emissive = color;
        MeshBuilder m;
        m.ellipsoid(glm::dvec3(0.0), glm::dvec3(1.0), 6, 4);
        glows.push_back(scene.add_mesh("fire", m.take(scene.add(light))));
    }
    for (int k = 0; k < 46; ++k) {
        const double z = random.range(-15.0, -5.5), x = random.around(0.0, 0.36 * (10.0 - z));
        const double y = (k < 34 ? random.range(0.25, 0.75) : random.range(0.75, 1.35));
        const double size = random.range(0.025, 0.055);
        const int color = random.below(3);
        const double phase = random.angle();
        const Index node = scene.add_node("torch", kNone, {{x, y, z}, {1.0, 0.0, 0.0, 0.0}, glm::dvec3(size)},
                                          glows[std::size_t(color)]);
        scene.animate_scale(node, 25,
                            [=](double t) { return size * glm::dvec3(1.0 + 0.18 * std::sin(9.0 * t + phase)); });
    }
    for (int k = 0; k < 132; ++k) {
        const double depth = k < 14 ? random.range(1.2, 4.0) : random.range(-7.0, 1.5);
        const glm::dvec3 middle{random.around(0.0, 0.20 * (11.0 - depth)),
                                1.1 + random.around(0.0, 0.13 * (11.0 - depth)), depth};
        const double speed = random.range(0.7, 1.7), rise = random.range(0.15, 0.9), swing = random.range(0.03, 0.10),
                     phase = random.angle();
        const double size = random.range(0.0028, 0.0065) * (1.0 + 0.1 * std::abs(depth));
        const int color = random.below(3);
        const Index node =
            scene.add_node("spark", kNone, {middle, {1.0, 0.0, 0.0, 0.0}, glm::dvec3(size)}, glows[std::size_t(color)]);
        scene.animate_translation(node, 25, [=](double t) {
            const double s = t - 1.0;
            return middle + glm::dvec3(speed * s + swing * std::sin(5.0 * s + phase),
                                       rise * s + swing * std::cos(6.0 * s + phase), 0.3 * s);
        });
    }
}

void add_dusk(Assembly& scene) {
    MeshBuilder m;
    m.surface(
        44, 26, [](double u, double v) { return glm::dvec3(-20.0 + 40.0 * u, -6.0 + 22.0 * v, -24.0); },
        [](double u, double v, glm::dvec3) {
            const double y = -6.0 + 22.0 * v, x = -20.0 + 40.0 * u;
            const double glow =
                std::exp(-std::pow((y + 0.3) / 2.3, 2.0)) * (0.35 + 0.65 * std::exp(-std::pow((x + 3.0) / 7.0, 2.0)));
            const double cloud = fractal_noise({7.0 * u + 0.8 * v, 11.0 * v}, 5);
            const glm::dvec3 deep{0.022, 0.038, 0.068}, slate{0.085, 0.10, 0.13}, ember{0.95, 0.32, 0.07};
            glm::dvec3 c = glm::mix(deep, slate, glm::smoothstep(0.35, 0.75, cloud));
            c += glow * ember * (0.55 + 0.6 * glm::smoothstep(0.4, 0.7, cloud));
            return c;
        });
    // Two ridges before it, the far one in the haze.
    for (int k = 0; k < 2; ++k) {
        const double z = -23.0 + 3.0 * k;
        m.surface(
            70, 2,
            [=](double u, double v) {
                const double x = -18.0 + 36.0 * u;
                const double top = (k == 0 ? 0.0 : -1.4) + 3.4 * (fractal_noise({0.22 * x + 31.0 * k, 1.5}, 5) - 0.3);
                return glm::dvec3(x, glm::mix(-7.0, top, v), z);
            },
            [=](double, double v, glm::dvec3) {
                const glm::dvec3 foot = k == 0 ? glm::dvec3(0.36, 0.15, 0.075) : glm::dvec3(0.16, 0.070, 0.045);
                const glm::dvec3 crest = k == 0 ? glm::dvec3(0.115, 0.075, 0.085) : glm::dvec3(0.050, 0.036, 0.042);
                return glm::mix(foot, crest, v);
            });
    }
    scene.add_node("dusk", kNone, {}, scene.add_mesh("dusk", m.take(scene.add(backdrop("dusk")))));
}

void add_camera_and_light(Assembly& scene) {
    const Index camera = scene.add_camera("hero", {}, {85.0, 1.1, 10.0, 0.5, 0});
    const auto eye = [](double t) { return glm::dvec3(0.30 + 0.12 * (t - 1.0), 0.85, 10.0 - 0.10 * (t - 1.0)); };
    const auto target = [](double t) { return glm::dvec3(-0.26 + 0.02 * (t - 1.0), 1.12, 0.0); };
    scene.animate_translation(camera, 9, eye);
    scene.animate_rotation(camera, 9, [=](double t) { return looking(eye(t), target(t)); });
    scene.add_sun("key", {-0.75, 0.85, 0.70}, {1.0f, 0.74f, 0.50f}, 3.4);
    scene.add_sun("fire behind", {0.80, 0.25, -0.75}, {1.0f, 0.42f, 0.12f}, 6.5);
    scene.add_sun("fire behind left", {-0.85, 0.10, -0.70}, {1.0f, 0.34f, 0.10f}, 4.0);
    scene.add_sun("sky", {0.35, 0.75, 0.55}, {0.30f, 0.45f, 0.80f}, 0.9);
}

}  // namespace

Scene conan() {
    Assembly scene("builtin:conan", kDuration);
    add_camera_and_light(scene);
    add_barbarian(scene);
    add_hill(scene);
    add_fire(scene);
    add_dusk(scene);
    return scene.take({0.02f, 0.025f, 0.04f});
}

}  // namespace pentaprism::builtin
