// Hair, leather, steel, fur and cloth, each laid on the implicit body and bound to its bones.

#include "scene/builtin/conan_dress.h"

#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include "scene/builtin/assembly.h"
#include "scene/builtin/conan_body.h"
#include "scene/builtin/mesh_builder.h"
#include "scene/builtin/random.h"

namespace pentaprism::builtin::barbarian {
namespace {

constexpr double kTwoPi = 6.283185307179586;
const glm::dvec3 kHair{0.035, 0.018, 0.012};
const glm::dvec3 kLeather{0.13, 0.055, 0.024};
const glm::dvec3 kSteel{0.42, 0.43, 0.46};

void follow(Primitive& mesh, std::size_t first, int bone) {
    mesh.influences = 4;
    for (std::size_t i = first; i < mesh.positions.size(); ++i) {
        mesh.joints.insert(mesh.joints.end(), {static_cast<std::uint16_t>(bone), 0, 0, 0});
        mesh.weights.insert(mesh.weights.end(), {1.0f, 0.0f, 0.0f, 0.0f});
    }
}

/// Moves what `m` has built to the end of `all`, fixed to one bone; the next piece starts without a transform.
void append(Primitive& all, MeshBuilder& m, int bone) {
    Primitive piece = m.take(kNone);
    const auto first = static_cast<std::uint32_t>(all.positions.size());
    for (const std::uint32_t index : piece.indices) all.indices.push_back(first + index);
    all.positions.insert(all.positions.end(), piece.positions.begin(), piece.positions.end());
    all.normals.insert(all.normals.end(), piece.normals.begin(), piece.normals.end());
    all.colors.insert(all.colors.end(), piece.colors.begin(), piece.colors.end());
    follow(all, first, bone);
    m.transform = glm::dmat4(1.0);
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

}  // namespace

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

Primitive gear(const ImplicitBody& body, Index material) {
    MeshBuilder m;
    Primitive all;
    const auto on = [&](int bone) { append(all, m, bone); };
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

Primitive furs(const ImplicitBody& body, Index material, const FurBudget& budget) {
    MeshBuilder m;
    Random random(29);
    Primitive all;
    const auto on = [&](int bone) { append(all, m, bone); };
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

}  // namespace pentaprism::builtin::barbarian
