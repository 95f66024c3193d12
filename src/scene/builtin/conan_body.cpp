// Torso, head, arms and legs, muscle by muscle, and the colours of the skin.

#include "scene/builtin/conan_body.h"

#include <algorithm>
#include <cmath>

#include "scene/builtin/random.h"

namespace pentaprism::builtin::barbarian {
namespace {

const glm::dvec3 kSkin{0.46, 0.215, 0.125};
const glm::dvec3 kRuddy{0.50, 0.185, 0.105};

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

}  // namespace

std::vector<Limb> anatomy() {
    Anatomy m;
    m.color = kSkin;
    add_torso(m);
    add_head(m);
    add_arm(m, -1.0, kRightArm, kRightForearm, kRightHand, 1, kGrip, kBladeAxis);
    add_arm(m, 1.0, kLeftArm, kLeftForearm, kLeftHand, 2, {0.60, 1.06, 0.24}, {-0.45, 0.75, 0.35});
    add_leg(m, -1.0, kRightThigh, kRightShin, kRightFoot, 3);
    add_leg(m, 1.0, kLeftThigh, kLeftShin, kLeftFoot, 4);
    return m.limbs;
}

Primitive skin(const ImplicitBody& body, double cell, Index material) {
    Primitive mesh = body.polygonize(cell, material, true);
    paint_skin(mesh);
    darken_hollows(mesh, body, 0.42);
    return mesh;
}

}  // namespace pentaprism::builtin::barbarian
