// conan: a barbarian on a windy hill at dusk cuts the air with his sword, fire and sparks behind him. One implicit
// body, muscle by muscle, gives the mesh and its skin weights; its rest pose is the middle of the stroke, which the
// animation swings about. Fur, cape and boots follow the same bones.

#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/matrix.hpp>

#include "scene/builtin/assembly.h"
#include "scene/builtin/implicit.h"
#include "scene/builtin/mesh_builder.h"
#include "scene/builtin/plants.h"
#include "scene/builtin/random.h"
#include "scene/builtin/recipes.h"
#include "scene/builtin/textures.h"

namespace pentaprism::builtin {
namespace {

constexpr double kDuration = 3.0;
constexpr double kTwoPi = 6.283185307179586;

const glm::dvec3 kSkin{0.46, 0.215, 0.125};
const glm::dvec3 kRuddy{0.50, 0.185, 0.105};
const glm::dvec3 kHair{0.035, 0.018, 0.012};
const glm::dvec3 kLeather{0.13, 0.055, 0.024};
const glm::dvec3 kSteel{0.42, 0.43, 0.46};

// ---------------------------------------------------------------- bones; his right is -x, he looks along +z

enum Bone {
    kPelvis,
    kSpine,
    kChest,
    kNeck,
    kHead,
    kRightArm,
    kRightForearm,
    kRightHand,
    kLeftArm,
    kLeftForearm,
    kLeftHand,
    kRightThigh,
    kRightShin,
    kRightFoot,
    kLeftThigh,
    kLeftShin,
    kLeftFoot,
    kCape1,
    kCape2,
    kCape3,
    kCape4,
    kTail1,
    kTail2,
    kSkirt,
    kBones
};

struct Joint {
    const char* name;
    int parent;
    glm::dvec3 place;
};

const std::array<Joint, kBones> kJoints{{
    {"pelvis", -1, {0.0, 0.95, 0.0}},
    {"spine", kPelvis, {0.0, 1.10, 0.0}},
    {"chest", kSpine, {0.0, 1.28, -0.01}},
    {"neck", kChest, {0.0, 1.53, -0.02}},
    {"head", kNeck, {0.0, 1.64, 0.0}},
    {"right arm", kChest, {-0.25, 1.47, -0.03}},
    {"right forearm", kRightArm, {-0.52, 1.57, 0.06}},
    {"right hand", kRightForearm, {-0.72, 1.74, 0.18}},
    {"left arm", kChest, {0.25, 1.46, -0.03}},
    {"left forearm", kLeftArm, {0.46, 1.24, -0.06}},
    {"left hand", kLeftForearm, {0.58, 1.10, 0.16}},
    {"right thigh", kPelvis, {-0.12, 0.93, -0.02}},
    {"right shin", kRightThigh, {-0.30, 0.54, 0.02}},
    {"right foot", kRightShin, {-0.40, 0.10, -0.16}},
    {"left thigh", kPelvis, {0.12, 0.93, 0.02}},
    {"left shin", kLeftThigh, {0.27, 0.56, 0.23}},
    {"left foot", kLeftShin, {0.33, 0.10, 0.16}},
    {"cape 1", kChest, {0.02, 1.50, -0.13}},
    {"cape 2", kCape1, {0.22, 1.24, -0.30}},
    {"cape 3", kCape2, {0.48, 1.02, -0.42}},
    {"cape 4", kCape3, {0.76, 0.86, -0.50}},
    {"hair 1", kHead, {0.03, 1.72, -0.09}},
    {"hair 2", kTail1, {0.16, 1.66, -0.16}},
    {"skirt", kPelvis, {0.0, 0.93, 0.08}},
}};

glm::dvec3 at(int bone) {
    return kJoints[std::size_t(bone)].place;
}

const glm::dvec3 kGrip{-0.765, 1.785, 0.215};                                 // middle of the sword's hilt
const glm::dvec3 kBladeAxis = glm::normalize(glm::dvec3(-0.90, 0.30, 0.22));  // from grip to point

/// A bone as a frame for the muscles on it: t from one end to the other, `front` and `side` across.
struct Shaft {
    glm::dvec3 a, b, front, side;
    Shaft(glm::dvec3 from, glm::dvec3 to, glm::dvec3 forward) : a(from), b(to) {
        const glm::dvec3 axis = glm::normalize(b - a);
        front = glm::normalize(forward - glm::dot(forward, axis) * axis);
        side = glm::cross(axis, front);
    }
    glm::dvec3 operator()(double t, double f, double s) const { return glm::mix(a, b, t) + f * front + s * side; }
};

class Anatomy {
  public:
    std::vector<Limb> limbs;
    int group = 0, bone = 0;
    glm::dvec3 color = kSkin;

    void add(glm::dvec3 a, glm::dvec3 b, double ra, double rb) { limbs.push_back({a, b, ra, rb, color, group, bone}); }

    /// A belly between thin ends.
    void muscle(glm::dvec3 a, glm::dvec3 b, double thick, double belly = 0.45, double ends = 0.55) {
        const glm::dvec3 middle = glm::mix(a, b, belly);
        add(a, middle, ends * thick, thick);
        add(middle, b, thick, ends * thick);
    }
};

void add_torso(Anatomy& m) {
    m.group = 0;
    m.bone = kChest;
    m.add({-0.075, 1.40, -0.03}, {-0.06, 1.24, -0.01}, 0.125, 0.115);  // rib cage
    m.add({0.075, 1.40, -0.03}, {0.06, 1.24, -0.01}, 0.125, 0.115);
    m.add({-0.14, 1.475, -0.045}, {0.14, 1.475, -0.045}, 0.075, 0.075);  // shoulder girdle
    m.bone = kSpine;
    m.add({-0.05, 1.17, 0.0}, {-0.055, 1.02, 0.0}, 0.105, 0.108);
    m.add({0.05, 1.17, 0.0}, {0.055, 1.02, 0.0}, 0.105, 0.108);
    m.bone = kPelvis;
    m.add({-0.07, 0.95, -0.005}, {0.07, 0.95, -0.005}, 0.13, 0.13);
    m.bone = kNeck;
    m.add({0.0, 1.50, -0.03}, {0.0, 1.66, 0.005}, 0.078, 0.068);
    for (const double s : {-1.0, 1.0}) {
        // What must stay apart from its mirror image has a group of its own.
        m.group = s < 0.0 ? 5 : 6;
        m.bone = kChest;
        m.add({0.060 * s, 1.392, 0.088}, {0.155 * s, 1.425, 0.060}, 0.066, 0.058);  // pectoral
        m.add({0.075 * s, 1.35, 0.085}, {0.15 * s, 1.38, 0.065}, 0.052, 0.05);
        m.bone = kSpine;
        for (int row = 0; row < 4; ++row) {
            const double y = 1.265 - 0.072 * row;
            if (row < 2) m.bone = kChest;
            if (row >= 2) m.bone = kSpine;
            m.add({0.030 * s, y, 0.092 - 0.004 * row}, {0.050 * s, y + 0.004, 0.086 - 0.004 * row}, 0.034, 0.031);
        }
        m.group = 0;
        m.bone = kChest;
        m.muscle({0.195 * s, 1.40, -0.075}, {0.105 * s, 1.12, -0.045}, 0.072, 0.35);  // latissimus
        for (int rib = 0; rib < 4; ++rib)                                             // serratus
            m.add({(0.172 - 0.010 * rib) * s, 1.315 - 0.046 * rib, 0.03 + 0.004 * rib},
                  {(0.135 - 0.008 * rib) * s, 1.285 - 0.046 * rib, 0.072}, 0.020, 0.014);
        m.muscle({0.045 * s, 1.62, -0.045}, {0.20 * s, 1.50, -0.045}, 0.056, 0.4, 0.7);  // trapezius
        m.add({0.03 * s, 1.515, 0.045}, {0.19 * s, 1.525, 0.0}, 0.016, 0.02);            // collar bone
        m.bone = kNeck;
        m.add({0.062 * s, 1.665, -0.01}, {0.02 * s, 1.53, 0.045}, 0.022, 0.018);
        m.bone = kSpine;
        m.muscle({0.125 * s, 1.20, 0.02}, {0.125 * s, 1.02, 0.02}, 0.052, 0.6, 0.7);  // oblique
        m.bone = kPelvis;
        m.add({0.085 * s, 0.93, -0.085}, {0.085 * s, 0.90, -0.08}, 0.105, 0.10);
    }
}

void add_head(Anatomy& m) {
    m.group = 0;
    m.bone = kHead;
    m.add({0.0, 1.785, -0.015}, {0.0, 1.765, 0.02}, 0.098, 0.088);
    m.color = glm::mix(kSkin, kRuddy, 0.5);
    m.add({0.0, 1.715, 0.045}, {0.0, 1.685, 0.05}, 0.070, 0.062);
    m.add({-0.028, 1.655, 0.062}, {0.028, 1.655, 0.062}, 0.040, 0.040);  // jaw and chin
    m.add({-0.014, 1.638, 0.094}, {0.014, 1.638, 0.094}, 0.022, 0.022);
    m.add({-0.05, 1.766, 0.088}, {0.05, 1.766, 0.088}, 0.018, 0.018);  // brow
    m.color = kRuddy;
    m.add({0.0, 1.745, 0.112}, {0.0, 1.708, 0.132}, 0.011, 0.016);  // nose
    m.add({-0.014, 1.702, 0.120}, {0.014, 1.702, 0.120}, 0.012, 0.012);
    for (const double s : {-1.0, 1.0}) {
        m.color = kRuddy;
        m.add({0.058 * s, 1.715, 0.078}, {0.062 * s, 1.722, 0.05}, 0.022, 0.022);
        m.color = glm::mix(kSkin, kRuddy, 0.6);
        m.add({0.075 * s, 1.665, 0.02}, {0.035 * s, 1.645, 0.08}, 0.026, 0.024);   // corner of the jaw
        m.add({0.098 * s, 1.735, 0.0}, {0.102 * s, 1.705, -0.003}, 0.018, 0.012);  // ear
    }
    m.color = kRuddy * 0.75;
    m.add({-0.020, 1.672, 0.109}, {0.020, 1.672, 0.109}, 0.011, 0.011);  // lips
    m.color = kSkin;
}

void add_arm(Anatomy& m, double s, int upper, int lower, int hand, int group, glm::dvec3 knuckles,
             glm::dvec3 grip_axis) {
    m.group = group;
    m.bone = upper;
    const glm::dvec3 shoulder = at(upper), elbow = at(lower), wrist = at(hand);
    // The biceps lies where the arm bends to.
    const glm::dvec3 bend = glm::normalize(wrist - elbow) + glm::dvec3(0.0, 0.0, 0.35);
    const Shaft a(shoulder, elbow, bend);
    m.add(a(0.0, 0.0, 0.0), a(1.0, 0.0, 0.0), 0.062, 0.050);
    m.muscle(a(0.10, 0.022, 0.018), a(0.93, 0.026, 0.0), 0.068, 0.55, 0.5);   // biceps
    m.muscle(a(0.05, -0.030, 0.02), a(0.90, -0.022, 0.0), 0.066, 0.42, 0.5);  // triceps
    m.muscle(a(0.10, -0.030, -0.024), a(0.80, -0.018, -0.01), 0.056, 0.40, 0.5);
    // Three heads of the deltoid over the shoulder.
    const glm::dvec3 out = glm::normalize(glm::dvec3(s, 0.65, 0.0));
    const glm::dvec3 insert = a(0.52, 0.0, 0.0) + 0.026 * out;
    for (const double z : {-0.06, 0.0, 0.06})
        m.muscle(shoulder + 0.022 * out + glm::dvec3(-0.025 * s, 0.015, z), insert, 0.077, 0.32, 0.6);

    m.bone = lower;
    const Shaft f(elbow, wrist, -bend);
    m.add(f(0.0, 0.0, 0.0), f(1.0, 0.0, 0.0), 0.052, 0.034);
    m.muscle(f(-0.10, 0.0, 0.022), f(0.78, 0.0, 0.012), 0.055, 0.38, 0.5);
    m.muscle(f(-0.08, 0.0, -0.024), f(0.80, 0.0, -0.012), 0.053, 0.36, 0.5);
    m.muscle(f(-0.02, 0.018, 0.0), f(0.85, 0.008, 0.0), 0.049, 0.34, 0.5);

    // The hand: a palm, and four fingers and a thumb around the grip.
    m.bone = hand;
    m.color = glm::mix(kSkin, kRuddy, 0.7);
    const glm::dvec3 ahead = glm::normalize(knuckles - wrist);
    const glm::dvec3 across = glm::normalize(grip_axis - glm::dot(grip_axis, ahead) * ahead);
    const glm::dvec3 back = glm::cross(across, ahead) * s;
    m.add(wrist, wrist + 0.055 * ahead, 0.032, 0.036);
    for (int k = 0; k < 4; ++k) {
        const double c = 0.030 - 0.021 * k;
        const glm::dvec3 p = wrist + 0.075 * ahead + c * across + 0.018 * back;
        m.add(wrist + 0.03 * ahead + 0.8 * c * across + 0.012 * back, p, 0.017, 0.016);
        m.add(p, p + 0.028 * ahead - 0.028 * back, 0.016, 0.0145);
        m.add(p + 0.028 * ahead - 0.028 * back, p - 0.004 * ahead - 0.052 * back, 0.0145, 0.0135);
    }
    m.add(wrist + 0.025 * ahead + 0.03 * across - 0.015 * back, wrist + 0.07 * ahead + 0.045 * across - 0.035 * back,
          0.018, 0.015);
    m.color = kSkin;
}

void add_leg(Anatomy& m, double s, int upper, int lower, int foot, int group) {
    m.group = group;
    m.bone = upper;
    const glm::dvec3 hip = at(upper), knee = at(lower), ankle = at(foot);
    const Shaft t(hip, knee, {0.15 * s, 0.0, 1.0});
    m.add(t(0.0, 0.0, 0.0), t(1.0, 0.0, 0.0), 0.085, 0.052);
    m.muscle(t(0.05, 0.035, 0.0), t(0.96, 0.025, 0.0), 0.076, 0.45, 0.55);               // rectus femoris
    m.muscle(t(0.10, 0.02, 0.045 * s), t(0.95, 0.02, 0.026 * s), 0.068, 0.5, 0.5);       // vastus, outside
    m.muscle(t(0.30, 0.025, -0.038 * s), t(0.98, 0.026, -0.028 * s), 0.058, 0.75, 0.5);  // and its drop above the knee
    m.muscle(t(0.0, -0.035, 0.0), t(0.98, -0.03, 0.0), 0.076, 0.45, 0.5);
    m.muscle(t(-0.05, 0.0, -0.045 * s), t(0.6, 0.0, -0.02 * s), 0.07, 0.3, 0.5);
    m.bone = lower;
    const Shaft c(knee, ankle, {0.1 * s, 0.0, 1.0});
    m.add(c(-0.02, 0.026, 0.0), c(0.06, 0.026, 0.0), 0.040, 0.036);  // kneecap
    m.add(c(0.0, 0.0, 0.0), c(1.0, 0.0, 0.0), 0.050, 0.038);
    m.muscle(c(0.02, -0.034, 0.025), c(0.75, -0.02, 0.01), 0.058, 0.35, 0.45);
    m.muscle(c(0.02, -0.034, -0.025), c(0.70, -0.02, -0.01), 0.056, 0.40, 0.45);
    m.muscle(c(0.05, 0.016, 0.016 * s), c(0.8, 0.01, 0.0), 0.036, 0.35, 0.6);
}

std::vector<Limb> anatomy() {
    Anatomy m;
    add_torso(m);
    add_head(m);
    add_arm(m, -1.0, kRightArm, kRightForearm, kRightHand, 1, kGrip, kBladeAxis);
    add_arm(m, 1.0, kLeftArm, kLeftForearm, kLeftHand, 2, {0.60, 1.06, 0.24}, {-0.45, 0.75, 0.35});
    add_leg(m, -1.0, kRightThigh, kRightShin, kRightFoot, 3);
    add_leg(m, 1.0, kLeftThigh, kLeftShin, kLeftFoot, 4);
    return m.limbs;
}

// ---------------------------------------------------------------- dress

void follow(Primitive& mesh, std::size_t first, int bone) {
    mesh.influences = 4;
    for (std::size_t i = first; i < mesh.positions.size(); ++i) {
        mesh.joints.insert(mesh.joints.end(), {static_cast<std::uint16_t>(bone), 0, 0, 0});
        mesh.weights.insert(mesh.weights.end(), {1.0f, 0.0f, 0.0f, 0.0f});
    }
}

/// What ambient light a concave place misses, read off the distance field: how far the body is along the normal.
void darken_hollows(Primitive& mesh, const ImplicitBody& body, double strength) {
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        const glm::dvec3 p(mesh.positions[i]), n(mesh.normals[i]);
        double missing = 0.0, weight = 1.0;
        for (const double step : {0.012, 0.03, 0.07, 0.14}) {
            missing += weight * std::max(0.0, 1.0 - body.distance(p + step * n) / step);
            weight *= 0.75;
        }
        const float keep = static_cast<float>(std::exp(-strength * missing));
        mesh.colors[i] *= glm::vec4(keep, keep * std::sqrt(keep), keep * std::sqrt(keep), 1.0f);
    }
}

/// Blue war paint across the eyes and down the chest, dirt on the legs.
void paint_skin(Primitive& mesh) {
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        const glm::dvec3 p(mesh.positions[i]);
        glm::dvec3 c(glm::vec3(mesh.colors[i]));
        const double grain = fractal_noise({60.0 * p.x + 13.0 * p.z, 60.0 * p.y}, 3);
        c *= 0.86 + 0.28 * grain;
        const double ragged = 0.5 + 0.8 * (fractal_noise({45.0 * p.x, 45.0 * p.y + 20.0 * p.z}, 3) - 0.5);
        const auto stripe = [&](double distance, double half) {
            return 1.0 - glm::smoothstep(0.65, 1.0, std::abs(distance) / half + ragged - 0.5);
        };
        double paint = 0.0;
        if (p.y > 1.6 && p.z > 0.04) paint = stripe(p.y - 1.742, 0.021);
        if (p.y > 1.3 && p.y < 1.52 && p.z > 0.0 && p.x > -0.16 && p.x < 0.2)
            for (const double k : {-0.035, 0.0, 0.035})
                paint = std::max(paint, stripe(p.x - 0.11 + 0.6 * (p.y - 1.41) - k, 0.010));
        if (p.x > 0.28 && p.y < 1.45 && p.y > 1.20)
            for (const double k : {1.30, 1.335}) paint = std::max(paint, stripe(p.y - k + 0.25 * (p.z + 0.05), 0.011));
        if (p.x < -0.30 && p.x > -0.46)
            for (const double k : {-0.36, -0.40}) paint = std::max(paint, stripe(p.x - k, 0.011));
        c = glm::mix(c, glm::dvec3(0.035, 0.10, 0.21), 0.85 * paint);
        const double dirt = glm::smoothstep(0.75, 0.2, p.y) * (0.3 + 0.7 * grain);
        c = glm::mix(c, glm::dvec3(0.10, 0.065, 0.04), 0.55 * dirt);
        mesh.colors[i] = glm::vec4(glm::vec3(c), 1.0f);
    }
}

Primitive skin(const ImplicitBody& body, double cell, Index material) {
    Primitive mesh = body.polygonize(cell, material, true);
    paint_skin(mesh);
    darken_hollows(mesh, body, 0.42);
    return mesh;
}

/// Where a ray from inside the body is `gap` outside of it. Clothes lie there.
glm::dvec3 outside(const ImplicitBody& body, glm::dvec3 from, glm::dvec3 towards, double gap, double farthest = 0.4) {
    const glm::dvec3 direction = glm::normalize(towards);
    double s = 0.0;
    for (int i = 0; i < 24 && s < farthest; ++i) {
        const double left = gap - body.distance(from + s * direction);
        s += left;
        if (std::abs(left) < 1e-5) break;
    }
    return from + std::clamp(s, 0.0, farthest) * direction;
}

/// Long hair that the wind takes to the left, a beard, brows.
Primitive hair(const ImplicitBody& head, Index material, double cell) {
    Anatomy m;
    m.color = kHair;
    m.bone = kHead;
    m.add({0.0, 1.80, -0.035}, {0.0, 1.755, -0.05}, 0.108, 0.102);
    m.add({-0.055, 1.835, 0.055}, {0.055, 1.835, 0.055}, 0.036, 0.036);
    Random random(17);
    // Locks of hair: from the crown down behind the ears, then off with the wind.
    for (int k = 0; k < 15; ++k) {
        const double a = degrees(-105.0 + 210.0 * k / 14.0);
        const glm::dvec3 root{0.1 * std::sin(a), 1.775 - 0.03 * std::cos(a * 2.0), -0.045 - 0.075 * std::cos(a)};
        const double wild = random.around(0.0, 0.03), reach = random.range(0.8, 1.15), lift = random.around(0.0, 0.035);
        const glm::dvec3 b = root + glm::dvec3(0.02 * std::sin(a) + 0.05, -0.10 + lift, -0.035 + wild);
        const glm::dvec3 c = b + reach * glm::dvec3(0.11, -0.055 + 1.5 * lift, -0.045 + wild);
        const glm::dvec3 d = c + reach * glm::dvec3(0.12, 0.005 + 2.0 * lift, -0.04);
        m.bone = kTail1;
        m.add(root, b, 0.036, 0.030);
        m.bone = kTail2;
        m.add(b, c, 0.030, 0.021);
        m.color = kHair * 1.7;
        m.add(c, d, 0.021, 0.004);
        m.color = kHair;
    }
    m.bone = kHead;
    // On the face, hair lies on the skin.
    const auto on_face = [&](double x, double y, double gap) {
        return outside(head, {0.5 * x, y, 0.0}, {x, 0.0, 0.085}, gap);
    };
    for (const double s : {-1.0, 1.0}) {
        m.add({0.092 * s, 1.725, 0.035}, on_face(0.072 * s, 1.668, 0.0), 0.014, 0.025);  // whiskers
        m.add(on_face(0.072 * s, 1.662, -0.002), on_face(0.022 * s, 1.622, 0.0), 0.026, 0.028);
        m.add(on_face(0.006 * s, 1.6885, 0.003), on_face(0.034 * s, 1.680, 0.003), 0.0085, 0.0085);  // moustache
        m.add(on_face(0.034 * s, 1.680, 0.003), on_face(0.048 * s, 1.655, 0.003), 0.0085, 0.008);
        m.add(on_face(0.012 * s, 1.764, 0.000), on_face(0.040 * s, 1.773, 0.002), 0.0085, 0.0085);  // brows
        m.add(on_face(0.040 * s, 1.773, 0.002), on_face(0.066 * s, 1.766, 0.000), 0.0085, 0.006);
    }
    m.add(on_face(0.0, 1.632, 0.006), {0.0, 1.575, 0.125}, 0.034, 0.012);
    const ImplicitBody body(m.limbs, 0.02);
    Primitive mesh = body.polygonize(cell, material, true);
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        const glm::dvec3 p(mesh.positions[i]);
        const double strand = 0.35 + 1.5 * noise({190.0 * (p.y + 0.35 * p.x), 70.0 * (p.z + 0.4 * p.x)});
        mesh.colors[i] *= glm::vec4(glm::vec3(static_cast<float>(strand)), 1.0f);
    }
    return mesh;
}

glm::dmat4 frame_at(glm::dvec3 origin, glm::dvec3 y, glm::dvec3 z_hint) {
    const glm::dvec3 up = glm::normalize(y), x = glm::normalize(glm::cross(up, z_hint)), z = glm::cross(x, up);
    return {glm::dvec4(x, 0.0), glm::dvec4(up, 0.0), glm::dvec4(z, 0.0), glm::dvec4(origin, 1.0)};
}

/// Boots, bracers, belt, straps, the plate on the left shoulder, eyes and a headband: hard parts, each on one bone.
Primitive gear(const ImplicitBody& body, Index material) {
    MeshBuilder m;
    Primitive all;
    const auto on = [&](int bone) {
        Primitive piece = m.take(kNone);
        const auto first = static_cast<std::uint32_t>(all.positions.size());
        for (const std::uint32_t index : piece.indices) all.indices.push_back(first + index);
        all.positions.insert(all.positions.end(), piece.positions.begin(), piece.positions.end());
        all.normals.insert(all.normals.end(), piece.normals.begin(), piece.normals.end());
        all.colors.insert(all.colors.end(), piece.colors.begin(), piece.colors.end());
        follow(all, first, bone);
        m.transform = glm::dmat4(1.0);
    };
    const Tint worn = [](double u, double v, glm::dvec3) {
        return kLeather * (0.7 + 0.6 * fractal_noise({9.0 * u, 9.0 * v}, 3));
    };
    const Tint iron = [](double u, double v, glm::dvec3) {
        return kSteel * (0.55 + 0.5 * fractal_noise({12.0 * u, 12.0 * v}, 3));
    };
    const Tint bronze = [](double u, double v, glm::dvec3) {
        return glm::dvec3(0.46, 0.27, 0.10) * (0.65 + 0.5 * fractal_noise({12.0 * u, 12.0 * v}, 2));
    };
    // Bracers with bands and studs.
    struct Cuff {
        int from, to;
    };
    for (const Cuff& c : {Cuff{kRightForearm, kRightHand}, Cuff{kLeftForearm, kLeftHand}}) {
        m.transform = frame_at(at(c.from), at(c.to) - at(c.from), {0.0, 0.3, 1.0});
        const double length = glm::length(at(c.to) - at(c.from));
        m.lathe({{0.060, 0.42 * length},
                 {0.059, 0.46 * length},
                 {0.053, 0.65 * length},
                 {0.044, 0.88 * length},
                 {0.042, 0.95 * length},
                 {0.034, 0.95 * length}},
                28, 12, worn);
        for (const double t : {0.47, 0.90}) {
            const double r = glm::mix(0.063, 0.047, (t - 0.47) / 0.43);
            m.lathe({{r - 0.004, (t - 0.035) * length},
                     {r + 0.003, (t - 0.02) * length},
                     {r + 0.003, (t + 0.02) * length},
                     {r - 0.005, (t + 0.035) * length}},
                    28, 5, bronze);
        }
        for (int k = 0; k < 8; ++k) {
            const double a = kTwoPi * k / 8.0;
            m.ellipsoid({0.053 * std::sin(a), 0.68 * length, 0.053 * std::cos(a)}, glm::dvec3(0.0085), 8, 6, bronze);
        }
        on(c.from);
    }
    // Boots: a foot and a shaft.
    for (const Cuff& c : {Cuff{kRightShin, kRightFoot}, Cuff{kLeftShin, kLeftFoot}}) {
        const glm::dvec3 ankle = at(c.to);
        const bool right = c.from == kRightShin;
        const glm::dvec3 ahead = glm::normalize(right ? glm::dvec3(-0.55, 0.0, 0.85) : glm::dvec3(0.30, 0.0, 1.0));
        const glm::dvec3 heel = glm::dvec3(ankle.x, 0.045, ankle.z) - 0.045 * ahead;
        m.tube({{heel - 0.02 * ahead, 0.012},
                {heel, 0.052},
                {heel + 0.09 * ahead + glm::dvec3(0.0, 0.012, 0.0), 0.060},
                {heel + 0.19 * ahead - glm::dvec3(0.0, 0.002, 0.0), 0.056},
                {heel + 0.255 * ahead - glm::dvec3(0.0, 0.008, 0.0), 0.036},
                {heel + 0.275 * ahead - glm::dvec3(0.0, 0.01, 0.0), 0.006}},
               22, 22, worn);
        on(c.to);
        m.transform = frame_at(ankle - glm::dvec3(0.0, 0.05, 0.0), at(c.from) - ankle, {0.0, 0.0, 1.0});
        m.lathe({{0.062, -0.03}, {0.062, 0.03}, {0.066, 0.12}, {0.080, 0.22}, {0.086, 0.29}, {0.074, 0.30}}, 28, 14,
                worn);
        // Thongs wound about the shaft.
        for (int k = 0; k < 5; ++k) {
            const double y = 0.045 + 0.048 * k, r = 0.067 + 0.019 * glm::smoothstep(0.05, 0.28, y);
            m.color = glm::dvec3(0.20, 0.13, 0.07);
            const double lean = k % 2 == 0 ? 0.022 : -0.022;
            std::vector<TubePoint> thong;
            for (int i = 0; i <= 16; ++i) {
                const double a = kTwoPi * i / 16.0;
                thong.push_back({{r * std::sin(a), y + lean * std::cos(a), r * std::cos(a)}, 0.0055});
            }
            for (std::size_t i = 0; i + 1 < thong.size(); ++i) m.tube({thong[i], thong[i + 1]}, 5, 1);
        }
        on(c.from);
    }
    // Belt and buckle.
    const Surface belt = [&](double u, double v) {
        const double a = -kTwoPi * u, y = 1.005 - 0.075 * v + 0.008 * std::cos(a);
        return outside(body, {0.0, y, -0.01}, {1.25 * std::sin(a), 0.0, std::cos(a)},
                       0.010 + 0.008 * std::sin(3.14159265 * v));
    };
    m.surface(56, 6, belt, worn);
    m.transform = glm::translate(glm::dmat4(1.0), outside(body, {0.0, 0.975, 0.0}, {0.0, 0.0, 1.0}, 0.020));
    m.ellipsoid(glm::dvec3(0.0), {0.062, 0.052, 0.018}, 30, 14, bronze);
    m.ellipsoid({0.0, 0.0, 0.012}, {0.034, 0.028, 0.014}, 20, 10, iron);
    for (int k = 0; k < 8; ++k) {
        const double a = kTwoPi * k / 8.0;
        m.ellipsoid({0.049 * std::cos(a), 0.040 * std::sin(a), 0.012}, glm::dvec3(0.007), 8, 6, iron);
    }
    on(kPelvis);
    // A strap from the left shoulder to the right hip.
    const auto strap_at = [&](double v, double gap) {
        // Walks a slanting plane through the chest, from over the shoulder to the hip.
        const double a = degrees(glm::mix(66.0, -84.0, v));
        const glm::dvec3 centre{0.06 - 0.08 * v, glm::mix(1.42, 1.03, v), -0.02};
        return outside(body, centre, {0.85 * std::sin(a), glm::mix(0.75, -0.25, v), std::cos(a)}, gap);
    };
    const Surface strap = [&](double u, double v) {
        const glm::dvec3 p = strap_at(v, 0.006);
        const glm::dvec3 tangent =
            glm::normalize(strap_at(std::min(1.0, v + 0.02), 0.006) - strap_at(std::max(0.0, v - 0.02), 0.006));
        const glm::dvec3 out = body.normal(p), across = glm::normalize(glm::cross(tangent, out));
        const double s = 2.0 * u - 1.0;
        const glm::dvec3 q = p + 0.028 * s * across;
        return q - (body.distance(q) - 0.006 - 0.006 * (1.0 - std::pow(s, 4.0))) * out;
    };
    m.surface(6, 34, strap, worn);
    for (int k = 0; k < 9; ++k) m.ellipsoid(strap_at(0.08 + 0.105 * k, 0.013), glm::dvec3(0.0095), 9, 6, bronze);
    on(kChest);
    // Plates on the left shoulder, with spikes.
    for (int plate = 0; plate < 3; ++plate) {
        const glm::dvec3 out = glm::normalize(glm::dvec3(0.75, 0.9 - 0.45 * plate, 0.05));
        m.transform = frame_at(at(kLeftArm) + glm::dvec3(0.012 + 0.016 * plate, 0.004 - 0.026 * plate, 0.0), out,
                               {0.0, 0.0, 1.0});
        const double r = 0.118 - 0.006 * plate;
        m.lathe({{r * 1.02, 0.015},
                 {r * 1.03, 0.028},
                 {r * 0.97, 0.055},
                 {r * 0.72, 0.094},
                 {r * 0.35, 0.116},
                 {0.0, 0.122}},
                36, 14, iron);
        m.lathe({{r * 1.00, 0.012}, {r * 1.05, 0.016}, {r * 1.05, 0.026}, {r * 1.0, 0.032}}, 36, 5, bronze);
        if (plate < 2)
            for (int k = 0; k < 5; ++k) {
                const double a = degrees(-70.0 + 35.0 * k);
                m.tube({{{0.6 * r * std::sin(a), 0.085, 0.6 * r * std::cos(a)}, 0.014},
                        {{0.72 * r * std::sin(a), 0.125, 0.72 * r * std::cos(a)}, 0.008},
                        {{0.85 * r * std::sin(a), 0.165, 0.85 * r * std::cos(a)}, 0.0008}},
                       9, 6, iron);
            }
    }
    on(kLeftArm);
    // Eyes and a headband.
    for (const double s : {-1.0, 1.0}) {
        m.color = {0.80, 0.76, 0.70};
        const glm::dvec3 eye = outside(body, {0.034 * s, 1.739, 0.0}, {0.0, 0.0, 1.0}, -0.007);
        m.ellipsoid(eye, {0.0175, 0.0115, 0.012}, 14, 10);
        m.color = {0.06, 0.17, 0.22};
        m.ellipsoid(eye + glm::dvec3(0.0, 0.0, 0.0062), {0.0080, 0.0090, 0.0070}, 10, 8);
        m.color = {0.003, 0.003, 0.003};
        m.ellipsoid(eye + glm::dvec3(0.0, 0.0, 0.0100), {0.0040, 0.0044, 0.0042}, 8, 6);
    }
    m.surface(
        48, 4,
        [](double u, double v) {
            const double a = -kTwoPi * u, bulge = 0.004 * std::sin(3.14159265 * v);
            return glm::dvec3((0.112 + bulge) * std::sin(a), 1.822 - 0.026 * v, (0.122 + bulge) * std::cos(a) - 0.022);
        },
        worn);
    m.ellipsoid({0.0, 1.809, 0.102}, {0.016, 0.014, 0.006}, 14, 8, bronze);
    on(kHead);
    all.material = material;
    return all;
}

/// The point, or where the body pushes it out to.
glm::dvec3 lifted(const ImplicitBody& body, glm::dvec3 p, double gap) {
    for (int i = 0; i < 3; ++i) p += std::max(0.0, gap - body.distance(p)) * body.normal(p);
    return p;
}

/// Fur: hairs as blades, on the surface p(u, v), pointing down its v.
void add_fur(MeshBuilder& m, Random& random, int hairs, const Surface& p, double length, double width, glm::dvec3 dark,
             glm::dvec3 light) {
    for (int k = 0; k < hairs; ++k) {
        const double u = random.range(0.01, 0.99), v = random.range(0.0, 0.98), h = 1e-3;
        const glm::dvec3 here = p(u, v), down = glm::normalize(p(u, v + h) - here),
                         out = glm::normalize(glm::cross(p(u + h, v) - here, p(u, v + h) - here));
        const double shade = random.uniform();
        Blade hair;
        hair.base = here;
        hair.axis = down + random.range(0.25, 0.75) * out + 0.35 * random.direction();
        hair.face = out;
        hair.length = length * random.range(0.6, 1.25);
        hair.width = width * random.range(0.7, 1.2);
        hair.bend = random.range(0.3, 1.0);
        hair.fold = 0.35;
        hair.widest = 0.25;
        hair.segments = 2;
        const glm::dvec3 color = glm::mix(dark, light, shade * shade);
        m.blade(hair, [&](double, double t, glm::dvec3) { return color * (0.35 + 0.9 * t); });
    }
}

struct FurBudget {
    int mantle, skirt, boot;
};

Primitive furs(const ImplicitBody& body, Index material, const FurBudget& budget) {
    MeshBuilder m;
    Random random(29);
    Primitive all;
    const auto on = [&](int bone) {
        Primitive piece = m.take(kNone);
        const auto first = static_cast<std::uint32_t>(all.positions.size());
        for (const std::uint32_t index : piece.indices) all.indices.push_back(first + index);
        all.positions.insert(all.positions.end(), piece.positions.begin(), piece.positions.end());
        all.normals.insert(all.normals.end(), piece.normals.begin(), piece.normals.end());
        all.colors.insert(all.colors.end(), piece.colors.begin(), piece.colors.end());
        follow(all, first, bone);
    };
    const glm::dvec3 dark{0.045, 0.026, 0.015}, light{0.34, 0.22, 0.12};
    // A mantle about neck and shoulders, open in front.
    const Surface mantle = [&](double u, double v) {
        const double a = degrees(42.0 + 276.0 * u), rise = degrees(42.0 - 36.0 * v);
        return outside(body, {0.0, 1.530 - 0.06 * v, -0.035},
                       {std::sin(a) * std::cos(rise), std::sin(rise), std::cos(a) * std::cos(rise)}, 0.008, 0.24);
    };
    add_fur(m, random, budget.mantle, mantle, 0.080, 0.016, dark, light);
    on(kChest);
    // A kilt of fur below the belt.
    const Surface kilt = [&](double u, double v) {
        const double a = kTwoPi * u;
        const glm::dvec3 waist = outside(body, {0.0, 0.95, -0.01}, {1.25 * std::sin(a), 0.0, std::cos(a)}, 0.006);
        const glm::dvec3 hem{0.10 * std::sin(a), -0.22, (std::cos(a) > 0.0 ? 0.15 : 0.08) * std::cos(a)};
        return lifted(body, waist + v * hem, 0.008);
    };
    add_fur(m, random, budget.skirt, kilt, 0.10, 0.017, 0.9 * dark, 0.8 * light);
    on(kPelvis);
    for (const bool right : {true, false}) {
        const int shin = right ? kRightShin : kLeftShin, foot = right ? kRightFoot : kLeftFoot;
        const glm::dmat4 frame = frame_at(at(foot), at(shin) - at(foot), {0.0, 0.0, 1.0});
        const Surface cuff = [&](double u, double v) {
            const double a = kTwoPi * u;
            return glm::dvec3(frame * glm::dvec4(0.088 * std::sin(a), 0.255 - 0.055 * v, 0.088 * std::cos(a), 1.0));
        };
        add_fur(m, random, budget.boot, cuff, 0.075, 0.015, dark, light);
        on(shin);
    }
    all.material = material;
    return all;
}

/// The loincloth's front and the cape: cloth over a chain of bones.
Primitive cloth(const ImplicitBody& body, Index material) {
    MeshBuilder m;
    const std::array<int, 4> chain{kCape1, kCape2, kCape3, kCape4};
    std::vector<TubePoint> spine;
    for (const int bone : chain) spine.push_back({at(bone), 0.0});
    spine.push_back({{1.02, 0.74, -0.54}, 0.0});
    constexpr int kAcross = 30, kAlong = 44;
    const Surface cape = [&](double u, double v) {
        const glm::dvec3 p = along(spine, v).p;
        const double half = glm::mix(0.17, 0.36, std::pow(v, 0.8)), s = 2.0 * u - 1.0;
        const double fold = (0.012 + 0.035 * v) * std::sin(11.0 * u + 2.5 * v) + 0.03 * v * std::sin(5.0 * v + 2.0 * u);
        const glm::dvec3 across = glm::normalize(
            glm::mix(glm::dvec3(1.0, 0.05, 0.12), glm::dvec3(0.42, 0.80, -0.25), glm::smoothstep(0.0, 0.75, v)));
        return p + half * s * across + fold * glm::dvec3(-0.35, 0.25, 0.9) -
               glm::dvec3(0.0, 0.0, 0.05 * s * s * (1.0 - v));
    };
    m.surface(kAcross, kAlong, cape, [](double u, double v, glm::dvec3) {
        const double fray = fractal_noise({7.0 * u, 9.0 * v}, 3);
        const double hem = u < 0.05 || u > 0.95 || v > 0.95 ? 0.45 : 1.0;
        return glm::dvec3(0.34, 0.018, 0.014) * (0.55 + 0.75 * fray) * hem;
    });
    Primitive mesh = m.take(material);
    mesh.influences = 4;
    for (int j = 0; j <= kAlong; ++j)
        for (int i = 0; i <= kAcross; ++i) {
            const double x = 4.0 * j / kAlong - 0.5;  // between the middles of the bones
            const int lower = std::clamp(static_cast<int>(std::floor(x)), 0, 2);
            const float upper_weight = static_cast<float>(std::clamp(x - lower, 0.0, 1.0));
            mesh.joints.insert(mesh.joints.end(), {static_cast<std::uint16_t>(chain[std::size_t(lower)]),
                                                   static_cast<std::uint16_t>(chain[std::size_t(lower + 1)]), 0, 0});
            mesh.weights.insert(mesh.weights.end(), {1.0f - upper_weight, upper_weight, 0.0f, 0.0f});
        }
    // The flap of leather in front.
    const double front = outside(body, {0.0, 0.955, 0.0}, {0.0, 0.0, 1.0}, 0.022).z;
    const std::size_t first = mesh.positions.size();
    m.surface(
        12, 18,
        [&](double u, double v) {
            const double s = 2.0 * u - 1.0;
            return glm::dvec3(0.085 * s * (1.0 - 0.25 * v) + 0.03 * v, 0.955 - 0.36 * v - 0.03 * v * (1.0 - s * s),
                              front + 0.15 * v - 0.02 * s * s + 0.012 * std::sin(6.0 * v + 2.0 * u));
        },
        [](double u, double v, glm::dvec3) {
            const double rim = u < 0.08 || u > 0.92 || v > 0.94 ? 1.9 : 1.0;
            return kLeather * rim * (0.6 + 0.6 * fractal_noise({6.0 * u, 9.0 * v}, 3));
        });
    Primitive flap = m.take(material);
    for (const std::uint32_t index : flap.indices) mesh.indices.push_back(static_cast<std::uint32_t>(first) + index);
    mesh.positions.insert(mesh.positions.end(), flap.positions.begin(), flap.positions.end());
    mesh.normals.insert(mesh.normals.end(), flap.normals.begin(), flap.normals.end());
    mesh.colors.insert(mesh.colors.end(), flap.colors.begin(), flap.colors.end());
    mesh.texcoords[0].clear();
    follow(mesh, first, kSkirt);
    return mesh;
}

/// The sword along +y, its grip around the origin.
std::vector<Primitive> sword(Index steel, Index fittings) {
    MeshBuilder m;
    std::vector<Primitive> parts;
    // A diamond with a fuller, tapering to the point.
    m.surface(
        16, 40,
        [](double u, double v) {
            const double y = 0.105 + 0.93 * v;
            const double taper = (1.0 - 0.35 * v) * std::sqrt(std::max(0.0, 1.0 - std::pow(v, 9.0)));
            const double a = kTwoPi * u, c = std::cos(a), s = std::sin(a);
            const double fuller = v < 0.72 ? 0.0026 * std::exp(-std::pow(c / 0.28, 2.0)) : 0.0;
            const double thick = 0.0085 * (1.0 - std::abs(c)) + 0.0012 - fuller;
            return glm::dvec3(0.043 * taper * c, y, -taper * thick * (s >= 0.0 ? 1.0 : -1.0));
        },
        [](double u, double v, glm::dvec3) {
            const double scratch = noise({80.0 * u, 240.0 * v});
            return glm::dvec3(0.62, 0.65, 0.70) * (0.75 + 0.3 * scratch);
        });
    parts.push_back(m.take(steel));
    const Tint bronze = [](double u, double v, glm::dvec3) {
        return glm::dvec3(0.62, 0.38, 0.12) * (0.65 + 0.5 * fractal_noise({12.0 * u, 12.0 * v}, 2));
    };
    m.tube({{{-0.125, 0.125, 0.0}, 0.006},
            {{-0.105, 0.112, 0.0}, 0.017},
            {{-0.05, 0.095, 0.0}, 0.013},
            {{0.0, 0.094, 0.0}, 0.020},
            {{0.05, 0.095, 0.0}, 0.013},
            {{0.105, 0.112, 0.0}, 0.017},
            {{0.125, 0.125, 0.0}, 0.006}},
           14, 32, bronze);
    m.lathe({{0.0, -0.165}, {0.020, -0.158}, {0.030, -0.135}, {0.022, -0.112}, {0.012, -0.105}}, 20, 14, bronze);
    m.lathe(
        {{0.014, -0.11}, {0.0175, -0.05}, {0.0165, 0.02}, {0.0155, 0.09}}, 16, 24,
        [](double u, double v, glm::dvec3) { return kLeather * (std::sin(60.0 * v + kTwoPi * u) > 0.0 ? 1.5 : 0.5); });
    parts.push_back(m.take(fittings));
    return parts;
}

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
    Material sky;
    sky.name = "dusk";
    sky.unlit = true;
    sky.double_sided = true;
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
    scene.add_node("dusk", kNone, {}, scene.add_mesh("dusk", m.take(scene.add(sky))));
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
