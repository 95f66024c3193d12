// hand: a skinned right hand waves and closes, half a metre from the lens, before the lights of a city at night. One
// implicit body (its limbs follow the bones of a hand, in centimetres) gives the mesh, its colours and its skin
// weights.

#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/matrix.hpp>

#include "scene/builtin/assembly.h"
#include "scene/builtin/implicit.h"
#include "scene/builtin/mesh_builder.h"
#include "scene/builtin/random.h"
#include "scene/builtin/recipes.h"

namespace pentaprism::builtin {
namespace {

constexpr double kDuration = 3.0;

const glm::dvec3 kSkin{0.50, 0.25, 0.155};
const glm::dvec3 kTip{0.60, 0.24, 0.17};

/// Joints from the knuckle to the tip, with radii; the rest pose is the open hand, fingers along +y, palm towards +z.
struct Finger {
    const char* name;
    glm::dvec3 knuckle;
    double splay;  ///< degrees from +y towards -x
    double lengths[3];
    double radii[4];
    double lag;  ///< how much later than the first finger it closes, radians of the cycle
};

const Finger kFingers[] = {
    {"index", {2.85, 8.7, 0.0}, -5.0, {4.4, 2.6, 2.1}, {0.98, 0.86, 0.78, 0.60}, 0.55},
    {"middle", {0.95, 9.2, 0.12}, 0.0, {4.9, 3.0, 2.3}, {1.00, 0.88, 0.80, 0.62}, 0.35},
    {"ring", {-1.0, 8.8, 0.06}, 5.0, {4.5, 2.8, 2.2}, {0.95, 0.83, 0.75, 0.58}, 0.18},
    {"little", {-2.75, 7.9, -0.1}, 12.0, {3.5, 2.1, 1.9}, {0.82, 0.70, 0.64, 0.50}, 0.0},
};
const glm::dvec3 kThumb[] = {{2.4, 2.4, 0.7}, {4.7, 5.2, 1.2}, {6.1, 7.7, 1.2}, {6.9, 9.7, 1.0}};

/// Bones: 0 forearm, 1 palm, then three for each finger and three for the thumb.
int bone_of(int finger, int segment) {
    return 2 + 3 * finger + segment;
}

glm::dvec3 direction(const Finger& finger) {
    return {-std::sin(degrees(finger.splay)), std::cos(degrees(finger.splay)), 0.0};
}

glm::dvec3 joint(const Finger& finger, int segment) {
    glm::dvec3 p = finger.knuckle;
    for (int s = 0; s < segment; ++s) p += finger.lengths[s] * direction(finger);
    return p;
}

std::vector<Limb> limbs() {
    std::vector<Limb> list{
        {{1.1, -10.0, 0.0}, {1.0, -1.0, 0.0}, 2.5, 1.75, kSkin, 0, 0},
        {{-1.1, -10.0, 0.0}, {-1.0, -1.0, 0.0}, 2.5, 1.75, kSkin, 0, 0},
        {{1.0, 0.0, 0.0}, {2.6, 8.1, 0.0}, 1.5, 1.08, kSkin, 0, 1},
        {{0.4, 0.0, 0.0}, {0.95, 8.6, 0.05}, 1.5, 1.12, kSkin, 0, 1},
        {{-0.4, 0.0, 0.0}, {-0.95, 8.2, 0.05}, 1.5, 1.10, kSkin, 0, 1},
        {{-1.0, 0.0, 0.0}, {-2.5, 7.3, -0.05}, 1.5, 1.00, kSkin, 0, 1},
        {{1.9, 1.9, 0.7}, {3.2, 4.6, 1.0}, 1.35, 1.25, glm::mix(kSkin, kTip, 0.5), 0, 1},  // ball of the thumb
        {{-2.0, 1.8, 0.5}, {-2.5, 5.2, 0.35}, 1.25, 1.05, glm::mix(kSkin, kTip, 0.4), 0, 1},
        {{2.3, 7.6, 0.55}, {-2.2, 6.9, 0.5}, 0.75, 0.7, glm::mix(kSkin, kTip, 0.4), 0, 1},  // pads below the fingers
    };
    for (int f = 0; f < 4; ++f) {
        const Finger& finger = kFingers[f];
        for (int s = 0; s < 3; ++s)
            list.push_back({joint(finger, s), joint(finger, s + 1), finger.radii[s], finger.radii[s + 1],
                            glm::mix(kSkin, kTip, 0.35 * s), f + 1, bone_of(f, s)});
    }
    const double radii[] = {1.25, 1.02, 0.95, 0.68};
    for (int s = 0; s < 3; ++s)
        list.push_back(
            {kThumb[s], kThumb[s + 1], radii[s], radii[s + 1], glm::mix(kSkin, kTip, 0.35 * s), 5, bone_of(4, s)});
    return list;
}

/// Reddish creases on the palm's side of the joints.
void add_creases(Primitive& skin) {
    for (std::size_t i = 0; i < skin.positions.size(); ++i) {
        const glm::dvec3 p(skin.positions[i]);
        double crease = 0.0;
        for (const Finger& finger : kFingers)
            for (int s = 0; s < 3; ++s) {
                const glm::dvec3 d = p - joint(finger, s);
                const double along = glm::dot(d, direction(finger)),
                             across = glm::length(d - along * direction(finger));
                if (across < 1.3 && d.z > 0.2) crease = std::max(crease, std::exp(-std::pow(along / 0.16, 2.0)));
            }
        const float keep = static_cast<float>(1.0 - 0.38 * crease);
        skin.colors[i] *= glm::vec4(keep, keep * keep, keep * keep, 1.0f);
    }
}

Primitive nails(Index material) {
    MeshBuilder m;
    m.color = {0.80, 0.48, 0.42};
    Primitive all;
    std::vector<std::uint16_t> joints;
    const auto add = [&](glm::dvec3 base, glm::dvec3 tip, double radius, glm::dvec3 back, int bone) {
        const glm::dvec3 along = glm::normalize(tip - base), side = glm::cross(along, back);
        const glm::dvec3 centre = glm::mix(base, tip, 0.78) + 0.74 * radius * back;
        m.transform =
            glm::dmat4(glm::dvec4(side, 0.0), glm::dvec4(along, 0.0), glm::dvec4(back, 0.0), glm::dvec4(centre, 1.0));
        m.ellipsoid(glm::dvec3(0.0), {0.62 * radius, 0.85 * radius, 0.28 * radius}, 10, 6);
        joints.resize(joints.size() + 11 * 7, static_cast<std::uint16_t>(bone));
    };
    for (int f = 0; f < 4; ++f) {
        const Finger& finger = kFingers[f];
        add(joint(finger, 2), joint(finger, 3), finger.radii[3], {0.0, 0.0, -1.0}, bone_of(f, 2));
    }
    const glm::dvec3 along = glm::normalize(kThumb[3] - kThumb[2]);
    const glm::dvec3 outward{0.75, -0.2, -0.6};
    add(kThumb[2], kThumb[3], 0.72, glm::normalize(outward - glm::dot(outward, along) * along), bone_of(4, 2));
    Primitive mesh = m.take(material);
    mesh.influences = 4;
    for (const std::uint16_t joint_index : joints) {
        mesh.joints.insert(mesh.joints.end(), {joint_index, 0, 0, 0});
        mesh.weights.insert(mesh.weights.end(), {1.0f, 0.0f, 0.0f, 0.0f});
    }
    return mesh;
}

/// The joints' nodes, a skin over them, and how they move.
Index add_skeleton(Assembly& scene, Index root) {
    std::vector<glm::dvec3> places{{0.0, -10.0, 0.0}, {0.0, 0.0, 0.0}};
    std::vector<int> parents{-1, 0};
    std::vector<std::string> names{"forearm", "palm"};
    for (int f = 0; f < 5; ++f)
        for (int s = 0; s < 3; ++s) {
            places.push_back(f < 4 ? joint(kFingers[f], s) : kThumb[s]);
            parents.push_back(s == 0 ? 1 : bone_of(f, s - 1));
            names.push_back(std::string(f < 4 ? kFingers[f].name : "thumb") + " " + std::to_string(s + 1));
        }
    Skin skin;
    skin.name = "hand";
    for (std::size_t i = 0; i < places.size(); ++i) {
        const bool is_root = parents[i] < 0;
        Transform local;
        local.translation = places[i] - (is_root ? glm::dvec3(0.0) : places[std::size_t(parents[i])]);
        skin.joints.push_back(scene.add_node(names[i], is_root ? root : skin.joints[std::size_t(parents[i])], local));
        skin.inverse_bind_matrices.push_back(glm::mat4(glm::translate(glm::dmat4(1.0), -places[i])));
    }

    scene.animate_rotation(skin.joints[0], 37, [](double t) {
        return turn({0.0, 0.0, 1.0}, degrees(9.0 * std::sin(7.0 * t + 0.5))) *
               turn({0.0, 1.0, 0.0}, degrees(-24.0 + 7.0 * std::sin(3.0 * t)));
    });
    scene.animate_rotation(skin.joints[1], 37, [](double t) {
        return turn({0.0, 0.0, 1.0}, degrees(15.0 * std::sin(7.0 * t + 0.1))) * turn({1.0, 0.0, 0.0}, degrees(-8.0));
    });
    const auto closing = [](double t, double lag) { return 0.5 - 0.5 * std::cos(3.9 * t + 0.9 - lag); };
    for (int f = 0; f < 4; ++f)
        for (int s = 0; s < 3; ++s) {
            const double most = degrees(s == 0 ? 72.0 : s == 1 ? 88.0 : 55.0), least = degrees(s == 0 ? 4.0 : 9.0);
            const glm::dvec3 across = glm::cross(direction(kFingers[f]), glm::dvec3(0.0, 0.0, 1.0));
            scene.animate_rotation(skin.joints[std::size_t(bone_of(f, s))], 37, [=](double t) {
                return turn(across, glm::mix(least, most, closing(t, kFingers[f].lag)));
            });
        }
    for (int s = 0; s < 3; ++s)
        scene.animate_rotation(skin.joints[std::size_t(bone_of(4, s))], 37, [=](double t) {
            return turn({0.35, -0.85, 0.35}, degrees(s == 0 ? 38.0 : 30.0) * closing(t, 0.7));
        });
    scene.scene().skins.push_back(std::move(skin));
    return static_cast<Index>(scene.scene().skins.size() - 1);
}

void add_hand(Assembly& scene) {
    Transform placed;
    placed.translation = {0.012, -0.068, 0.0};
    placed.scale = glm::dvec3(0.01);
    const Index root = scene.add_node("arm", kNone, placed);
    const Index skin = add_skeleton(scene, root);

    const Index skin_material = scene.add(painted("skin", 0.48));
    const Index nail_material = scene.add(painted("nail", 0.25));
    Primitive body = ImplicitBody(limbs(), 0.75).polygonize(0.418, skin_material, true);
    add_creases(body);
    std::vector<Primitive> parts;
    parts.push_back(std::move(body));
    parts.push_back(nails(nail_material));
    const Index node = scene.add_node("hand", kNone, {}, scene.add_mesh("hand", std::move(parts)));
    scene.node(node).skin = skin;

    Material knit = painted("sleeve", 0.95);
    knit.double_sided = true;
    MeshBuilder m;
    const std::vector<TubePoint> sleeve{{{0.0, -6.0, 0.0}, 4.3},
                                        {{0.0, -2.0, 0.0}, 4.5},
                                        {{0.0, 1.0, 0.0}, 4.2},
                                        {{0.0, 6.0, 0.0}, 3.7},
                                        {{0.0, 6.6, 0.0}, 3.3}};
    m.tube(sleeve, 48, 12, [](double u, double v, glm::dvec3) {
        const double rib = 0.7 + 0.3 * std::cos(6.283185307179586 * 24.0 * u);
        return glm::dvec3(0.02, 0.05, 0.13) * rib * (v > 0.8 ? 1.6 : 1.0);
    });
    scene.add_node("sleeve", scene.scene().skins[std::size_t(skin)].joints[0], {},
                   scene.add_mesh("sleeve", m.take(scene.add(knit))));
}

/// Street lamps, windows, tail lights: bright points two to six metres away that the lens turns into disks.
void add_city_lights(Assembly& scene) {
    Random random(5);
    const glm::vec3 colors[] = {
        {6.0f, 2.8f, 0.7f}, {5.0f, 3.6f, 2.0f}, {5.5f, 0.5f, 0.25f}, {0.7f, 2.2f, 5.5f}, {0.5f, 3.6f, 2.2f}};
    std::vector<Index> meshes;
    for (const glm::vec3& color : colors) {
        Material light = painted("city light");
        light.base_color = {0.0f, 0.0f, 0.0f, 1.0f};
        light.emissive = color;
        MeshBuilder m;
        m.ellipsoid(glm::dvec3(0.0), glm::dvec3(1.0), 6, 4);
        meshes.push_back(scene.add_mesh("city light", m.take(scene.add(light))));
    }
    for (int k = 0; k < 96; ++k) {
        const double depth = random.range(2.0, 6.0);
        // Dense along a street near the horizon, sparse above it.
        const double height = k < 60 ? random.around(-0.09, 0.10) : random.range(-0.05, 0.36);
        const glm::dvec3 at{random.around(0.0, 0.58 * depth), height * depth, 0.5 - depth};
        Transform placed{at, {1.0, 0.0, 0.0, 0.0}, glm::dvec3(0.0046 * (depth - 0.5) * random.range(0.7, 1.2))};
        const int color = k < 60 ? random.below(5) : random.below(2);
        scene.add_node("city light", kNone, placed, meshes[std::size_t(color)]);
    }
}

/// Dusk over the roofs: a wall of colour far behind.
void add_dusk(Assembly& scene) {
    MeshBuilder m;
    m.surface(
        12, 20, [](double u, double v) { return glm::dvec3(-9.0 + 18.0 * u, -4.5 + 9.0 * v, -8.0); },
        [](double u, double v, glm::dvec3) {
            const glm::dvec3 street{0.020, 0.016, 0.024}, glow{0.23, 0.060, 0.062}, violet{0.045, 0.028, 0.085},
                night{0.006, 0.012, 0.034};
            const glm::dvec3 above = glm::mix(violet, night, glm::smoothstep(0.52, 0.78, v));
            const glm::dvec3 horizon = glm::mix(glow * (0.55 + 0.6 * u), above, glm::smoothstep(0.42, 0.60, v));
            return glm::mix(street, horizon, glm::smoothstep(0.30, 0.43, v));
        });
    scene.add_node("dusk", kNone, {}, scene.add_mesh("dusk", m.take(scene.add(backdrop("dusk")))));
}

void add_camera_and_light(Assembly& scene) {
    const Index camera = scene.add_camera("close", {}, {35.0, 2.6, 0.5, 0.5, 0});
    const auto eye = [](double t) { return glm::dvec3(0.012 * (t - 1.0), 0.01, 0.5); };
    scene.animate_translation(camera, 7, eye);
    scene.animate_rotation(camera, 7, [=](double t) { return looking(eye(t), {0.0, 0.012, 0.0}); });
    scene.add_sun("key", {-0.8, 0.55, 0.75}, {1.0f, 0.80f, 0.60f}, 2.9);
    scene.add_sun("rim", {0.9, 0.25, -0.55}, {0.25f, 0.55f, 1.0f}, 5.0);
    scene.add_sun("lower rim", {-0.7, -0.35, -0.6}, {1.0f, 0.25f, 0.35f}, 2.2);
    scene.add_sun("fill", {0.4, 0.1, 1.0}, {0.5f, 0.6f, 1.0f}, 0.45);
}

}  // namespace

Scene hand() {
    Assembly scene("builtin:hand", kDuration);
    add_camera_and_light(scene);
    add_hand(scene);
    add_dusk(scene);
    add_city_lights(scene);
    return scene.take({0.008f, 0.013f, 0.030f});
}

}  // namespace pentaprism::builtin
