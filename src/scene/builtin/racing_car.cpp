// The body is one parametric surface whose cross-sections are superellipses; engine, suspension and driver are tubes
// and ellipsoids around it.

#include "scene/builtin/racing_car.h"

#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include "scene/builtin/mesh_builder.h"
#include "scene/builtin/textures.h"

namespace pentaprism::builtin {
namespace {

constexpr double kTwoPi = 6.283185307179586;
constexpr double kTrack = 0.72, kFront = 1.22, kRear = -1.12;  // half width between wheels; axles
constexpr double kFrontRadius = 0.29, kRearRadius = 0.34;

/// Half width and top and bottom of the body at v = 0 (tail) to 1 (nose).
struct Section {
    double x, half, bottom, top;
};

Section section(double v) {
    const double x = -1.78 + 3.72 * v;
    const double nose = glm::smoothstep(0.55, 1.0, v), tail = glm::smoothstep(0.22, 0.0, v);
    const double closing =
        std::sqrt(std::max(0.0, 1.0 - std::pow(v, 26.0))) * std::sqrt(std::max(0.0, 1.0 - std::pow(1.0 - v, 30.0)));
    Section s;
    s.x = x;
    s.half = (0.37 - 0.19 * nose - 0.12 * tail) * closing;
    const double middle = 0.40 - 0.06 * nose + 0.05 * tail;
    s.bottom = middle - (0.27 - 0.14 * nose - 0.10 * tail) * closing;
    const double cowl = 0.10 * std::exp(-std::pow((v - 0.585) / 0.07, 2.0)),
                 engine = 0.05 * std::exp(-std::pow((v - 0.28) / 0.10, 2.0));
    s.top = middle + (0.30 - 0.17 * nose - 0.10 * tail + cowl + engine) * closing;
    return s;
}

glm::dvec3 body_point(double u, double v) {
    const Section s = section(v);
    const double a = kTwoPi * u;  // 0 at the right side (+z, towards the camera), a quarter at the bottom
    const double c = std::cos(a), d = std::sin(a);
    // A superellipse: fuller than an ellipse.
    const double k = std::pow(std::pow(std::abs(c), 2.6) + std::pow(std::abs(d), 2.6), -1.0 / 2.6);
    const double middle = 0.5 * (s.top + s.bottom), rise = 0.5 * (s.top - s.bottom);
    return {s.x, middle - rise * k * d, s.half * k * c};
}

/// Paint: base colour, a stripe along the top, a ring about the nose, roundels with a number on both sides.
Image livery(std::string name, glm::dvec3 base, glm::dvec3 stripe, int number) {
    // Seven segments: top, upper left, upper right, middle, lower left, lower right, bottom.
    static constexpr int kDigits[] = {0b1110111, 0b0100100, 0b1011101, 0b1101101, 0b0101110,
                                      0b1101011, 0b1111011, 0b0100101, 0b1111111, 0b1101111};
    const auto digit = [number](double x, double y) {  // within [-1, 1] x [-1.6, 1.6], y up
        const auto stroke = [&](double x0, double y0, double x1, double y1) {
            return x > x0 - 0.22 && x < x1 + 0.22 && y > y0 - 0.22 && y < y1 + 0.22;
        };
        const bool segments[] = {stroke(-0.7, 1.3, 0.7, 1.3),   stroke(-0.7, 0.0, -0.7, 1.3),
                                 stroke(0.7, 0.0, 0.7, 1.3),    stroke(-0.7, 0.0, 0.7, 0.0),
                                 stroke(-0.7, -1.3, -0.7, 0.0), stroke(0.7, -1.3, 0.7, 0.0),
                                 stroke(-0.7, -1.3, 0.7, -1.3)};
        for (int i = 0; i < 7; ++i)
            if (segments[i] && (kDigits[number] >> i & 1) != 0) return true;
        return false;
    };
    const Section side = section(0.40);
    const double per_u = kTwoPi * 0.5 * (side.top - side.bottom), per_v = section(1.0).x - section(0.0).x;
    // Where the roundels' middles lie, and which way is up and right there. The right side is cut by the texture's
    // edge.
    struct Roundel {
        double u, v, up, right;
    };
    constexpr double kRadius = 0.19;
    constexpr Roundel kRoundels[] = {{0.5, 0.40, 1.0, -1.0}, {1.0, 0.40, -1.0, 1.0}, {0.0, 0.40, -1.0, 1.0}};
    return paint(std::move(name), 512, 512, 3, [&](double u, double v) {
        glm::dvec3 color = std::abs(u - 0.75) < 0.035 || v > 0.955 ? stripe : base;
        for (const Roundel& r : kRoundels) {
            const double dy = (u - r.u) * per_u * r.up / kRadius, dx = (v - r.v) * per_v * r.right / kRadius;
            if (dx * dx + dy * dy < 1.0)
                color = digit(2.5 * dx, 2.5 * dy) ? glm::dvec3(0.01) : glm::dvec3(0.85, 0.84, 0.80);
        }
        return glm::dvec4(color, 1.0);
    });
}

Primitive body(Index material) {
    MeshBuilder m;
    m.surface(30, 44, body_point);
    return m.take(material);
}

/// Cockpit, driver, windscreen frame, engine, exhausts, suspension: everything that does not turn.
Primitive fittings(Index material, glm::dvec3 helmet) {
    MeshBuilder m;
    const glm::dvec3 black{0.015, 0.015, 0.017}, steel{0.26, 0.26, 0.28}, chrome{0.40, 0.40, 0.43};
    m.color = black;
    m.ellipsoid({0.06, 0.665, 0.0}, {0.40, 0.07, 0.255}, 22, 8);  // the cockpit's opening
    m.color = {0.10, 0.04, 0.02};
    m.tube({{{-0.32, 0.68, -0.2}, 0.03}, {{-0.42, 0.72, 0.0}, 0.035}, {{-0.32, 0.68, 0.2}, 0.03}}, 8, 12);
    // The driver: shoulders, helmet with peak, goggles, arms to the wheel.
    m.color = {0.55, 0.53, 0.48};
    m.ellipsoid({-0.16, 0.66, 0.0}, {0.14, 0.15, 0.185}, 16, 10);
    m.color = helmet;
    m.ellipsoid({-0.12, 0.905, 0.0}, {0.140, 0.14, 0.125}, 24, 14);
    m.color = {0.62, 0.36, 0.26};
    m.ellipsoid({-0.055, 0.855, 0.0}, {0.100, 0.11, 0.1}, 14, 8);
    m.color = black;
    m.ellipsoid({-0.005, 0.885, 0.0}, {0.07, 0.036, 0.095}, 12, 6);
    m.color = 0.7 * helmet;
    m.ellipsoid({0.03, 0.935, 0.0}, {0.08, 0.012, 0.085}, 14, 4);
    for (const double side : {1.0, -1.0}) {
        m.color = {0.55, 0.53, 0.48};
        m.tube({{{-0.14, 0.73, 0.16 * side}, 0.05},
                {{0.06, 0.68, 0.18 * side}, 0.045},
                {{0.26, 0.70, 0.12 * side}, 0.035}},
               8, 6);
    }
    m.color = black;
    std::vector<TubePoint> rim;
    for (int k = 0; k <= 12; ++k)
        rim.push_back({{0.28 + 0.04 * std::sin(kTwoPi * k / 12.0), 0.68 + 0.12 * std::sin(kTwoPi * k / 12.0),
                        0.13 * std::cos(kTwoPi * k / 12.0)},
                       0.013});
    m.tube(rim, 5, 20);

    // Engine: two rows of trumpets, cam covers, long exhausts.
    for (const double side : {1.0, -1.0}) {
        m.color = steel;
        m.tube({{{-1.10, 0.66, 0.1 * side}, 0.02},
                {{-1.06, 0.66, 0.1 * side}, 0.055},
                {{-0.62, 0.68, 0.11 * side}, 0.055},
                {{-0.58, 0.68, 0.11 * side}, 0.02}},
               10, 10);
        for (int k = 0; k < 4; ++k) {
            const double x = -1.02 + 0.125 * k;
            m.color = chrome;
            m.tube(
                {{{x, 0.64, 0.045 * side}, 0.026}, {{x, 0.78, 0.05 * side}, 0.028}, {{x, 0.815, 0.05 * side}, 0.045}},
                8, 4);
            m.color = {0.30, 0.22, 0.15};
            m.tube({{{x, 0.60, 0.15 * side}, 0.024},
                    {{x - 0.03, 0.56, 0.29 * side}, 0.024},
                    {{x - 0.25, 0.50, 0.30 * side}, 0.024},
                    {{-1.45, 0.47, 0.26 * side}, 0.026}},
                   5, 7);
        }
        m.color = {0.42, 0.34, 0.26};
        m.tube({{{-1.38, 0.47, 0.26 * side}, 0.05},
                {{-1.6, 0.47, 0.25 * side}, 0.055},
                {{-2.0, 0.48, 0.24 * side}, 0.06},
                {{-2.12, 0.485, 0.24 * side}, 0.07}},
               14, 10);
        m.color = {0.02, 0.02, 0.02};
        m.ellipsoid({-2.1, 0.485, 0.24 * side}, {0.025, 0.058, 0.058}, 12, 6);
        // Wishbones and a spring and damper at each wheel, and a mirror.
        m.color = steel;
        for (const double axle : {kFront, kRear}) {
            const double hub = axle > 0.0 ? kFrontRadius : kRearRadius;
            const glm::dvec3 upper{axle, hub + 0.11, (kTrack - 0.1) * side},
                lower{axle, hub - 0.12, (kTrack - 0.1) * side};
            const double inner = axle > 0.0 ? 0.14 : 0.16;
            for (const double reach : {0.22, -0.22}) {
                m.tube({{upper, 0.014}, {{axle + reach, hub + 0.13, inner * side}, 0.014}}, 7, 2);
                m.tube({{lower, 0.016}, {{axle + reach, hub - 0.09, inner * side}, 0.016}}, 7, 2);
            }
            m.tube({{upper, 0.026}, {lower, 0.026}}, 8, 2);
            m.color = {0.6, 0.05, 0.03};
            m.tube({{glm::mix(upper, lower, 0.6) - glm::dvec3(0.0, 0.0, 0.08 * side), 0.03},
                    {{axle, hub + 0.24, (inner + 0.05) * side}, 0.03}},
                   10, 4);
            m.color = steel;
            m.tube({{{axle, hub, inner * side}, 0.02}, {{axle, hub, (kTrack - 0.06) * side}, 0.02}}, 8, 2);
        }
        m.color = chrome;
        m.ellipsoid({0.52, 0.77, 0.33 * side}, {0.03, 0.035, 0.055}, 12, 8);
        m.tube({{{0.5, 0.66, 0.22 * side}, 0.008}, {{0.52, 0.76, 0.31 * side}, 0.008}}, 5, 2);
    }
    // Roll bar, nose intake, fuel cap.
    m.color = chrome;
    m.tube({{{-0.5, 0.62, -0.18}, 0.02},
            {{-0.48, 0.95, -0.12}, 0.02},
            {{-0.48, 1.0, 0.0}, 0.02},
            {{-0.48, 0.95, 0.12}, 0.02},
            {{-0.5, 0.62, 0.18}, 0.02}},
           9, 20);
    m.color = black;
    m.ellipsoid({1.925, 0.343, 0.0}, {0.022, 0.062, 0.105}, 18, 8);
    m.color = chrome;
    m.ellipsoid({0.78, 0.62, 0.09}, {0.045, 0.018, 0.045}, 14, 6);
    return m.take(material);
}

Primitive windscreen(Index material) {
    MeshBuilder m;
    m.color = {0.75, 0.85, 0.9};
    m.surface(20, 6, [](double u, double v) {
        const double a = degrees(-80.0 + 160.0 * u);
        return glm::dvec3(0.26 + 0.24 * std::cos(a) - 0.10 * v, 0.66 + 0.17 * v * (0.55 + 0.45 * std::cos(a)),
                          -(0.265 - 0.03 * v) * std::sin(a));
    });
    return m.take(material);
}

/// A wire wheel about the z axis, outer side towards +z.
std::vector<Primitive> wheel(double radius, double width, Index rubber, Index metal) {
    MeshBuilder m;
    m.transform = glm::rotate(glm::dmat4(1.0), degrees(90.0), glm::dvec3(1.0, 0.0, 0.0));  // lathes turn about y
    const double rim = 0.68 * radius, h = 0.5 * width;
    m.lathe({{rim, -0.8 * h},
             {0.86 * radius, -1.02 * h},
             {0.97 * radius, -0.9 * h},
             {radius, -0.5 * h},
             {radius, 0.5 * h},
             {0.97 * radius, 0.9 * h},
             {0.86 * radius, 1.02 * h},
             {rim, 0.8 * h}},
            28, 11, [](double u, double v, glm::dvec3) {
                const bool letters =
                    v > 0.80 && v < 0.87 && std::sin(kTwoPi * 3.0 * u) > 0.2 && std::sin(kTwoPi * 22.0 * u) > -0.3;
                const double tread = v > 0.33 && v < 0.67 ? 0.8 + 0.2 * std::sin(60.0 * v) : 1.0;
                return letters ? glm::dvec3(0.65, 0.62, 0.5) : glm::dvec3(0.022) * tread;
            });
    std::vector<Primitive> parts;
    parts.push_back(m.take(rubber));
    m.color = {0.55, 0.55, 0.57};
    m.lathe({{0.92 * rim, -0.75 * h},
             {1.02 * rim, -0.85 * h},
             {1.03 * rim, 0.0},
             {1.02 * rim, 0.85 * h},
             {0.92 * rim, 0.72 * h},
             {0.9 * rim, 0.0},
             {0.92 * rim, -0.75 * h}},
            24, 7);
    m.lathe(
        {{0.17 * rim, -0.8 * h}, {0.2 * rim, -0.2 * h}, {0.17 * rim, 0.5 * h}, {0.12 * rim, 0.95 * h}, {0.0, 1.0 * h}},
        12, 6);
    m.color = {0.7, 0.6, 0.25};
    m.transform = glm::dmat4(1.0);
    m.tube({{{-0.24 * rim, 0.0, 0.93 * h}, 0.012}, {{0.0, 0.0, 0.99 * h}, 0.026}, {{0.24 * rim, 0.0, 0.93 * h}, 0.012}},
           6, 6);  // knock-off
    m.color = {0.50, 0.50, 0.52};
    constexpr int kSpokes = 36;
    for (int k = 0; k < kSpokes; ++k) {
        // Crossed pairs from both flanges of the hub.
        const double a = kTwoPi * k / kSpokes, lead = (k % 2 == 0 ? 1.0 : -1.0) * degrees(26.0);
        const double flange = (k % 4 < 2 ? 0.55 : -0.3) * h;
        const glm::dvec3 hub{0.17 * rim * std::cos(a + lead), 0.17 * rim * std::sin(a + lead), flange};
        const glm::dvec3 end{0.93 * rim * std::cos(a), 0.93 * rim * std::sin(a), 0.1 * h};
        m.tube({{hub, 0.0042}, {end, 0.0042}}, 4, 1);
    }
    parts.push_back(m.take(metal));
    return parts;
}

/// What the car's belly takes from the sky's light: darkness on the road, drawn.
Index add_soft_shadow(Assembly& scene) {
    Material dark = painted("soft shadow", 1.0);
    dark.base_color_texture = texture(scene.add(soft_spot_texture("soft shadow", {0.012, 0.012, 0.016}, 0.92)));
    dark.base_color_texture.wrap_s = dark.base_color_texture.wrap_t = Wrap::kClampToEdge;
    dark.alpha_mode = AlphaMode::kBlend;
    MeshBuilder m;
    m.surface(1, 1, [](double u, double v) { return glm::dvec3(-2.3 + 4.5 * u, 0.0, 1.15 - 2.3 * v); });
    return scene.add_mesh("soft shadow", m.take(scene.add(dark)));
}

}  // namespace

RacingCars::RacingCars(Assembly& scene) : scene_(scene) {
    Material rubber = painted("tyre", 0.85), metal = painted("wheel", 0.3), fittings = painted("fittings", 0.35);
    metal.metallic = 0.4f;
    Material glass = painted("windscreen", 0.05);
    glass.base_color = {1.0f, 1.0f, 1.0f, 0.25f};
    glass.alpha_mode = AlphaMode::kBlend;
    glass.double_sided = true;
    const Index rubber_index = scene.add(rubber), metal_index = scene.add(metal);
    fittings_ = scene.add(fittings);
    glass_ = scene.add(glass);
    shadow_ = add_soft_shadow(scene);
    front_wheel_ = scene.add_mesh("front wheel", wheel(kFrontRadius, 0.19, rubber_index, metal_index));
    rear_wheel_ = scene.add_mesh("rear wheel", wheel(kRearRadius, 0.26, rubber_index, metal_index));
}

Index RacingCars::add(const RacingCarLook& look, const RacingCarMotion& motion) {
    const std::string& name = look.name;
    const double phase = motion.phase;
    Material lacquer = painted(name + " lacquer", 0.22);
    lacquer.base_color_texture = texture(scene_.add(livery(look.livery, look.paint, look.stripe, look.number)));
    lacquer.base_color_texture.wrap_t = Wrap::kClampToEdge;
    std::vector<Primitive> parts;
    parts.push_back(body(scene_.add(lacquer)));
    parts.push_back(fittings(fittings_, look.helmet));
    parts.push_back(windscreen(glass_));
    const Index car = scene_.add_node(name, kNone, {});
    scene_.animate_translation(car, 25, motion.place);
    if (motion.heading) scene_.animate_rotation(car, 25, motion.heading);
    const Index chassis = scene_.add_node(name + " body", car, {}, scene_.add_mesh(name, std::move(parts)));
    // It shivers on its springs, and leans out of a bend.
    const double lean = 1.1 + motion.lean_deg;
    scene_.animate_rotation(chassis, 49, [=](double t) {
        return turn({0.0, 0.0, 1.0}, degrees(0.35 * std::sin(17.0 * t + phase))) *
               turn({1.0, 0.0, 0.0}, degrees(lean + 0.4 * std::sin(13.0 * t + phase)));
    });
    scene_.add_node(name + " shadow", car, {{0.0, 0.01, 0.0}, {1.0, 0.0, 0.0, 0.0}, glm::dvec3(1.0)}, shadow_);
    for (const double axle : {kFront, kRear})
        for (const double side : {1.0, -1.0}) {
            const double radius = axle > 0.0 ? kFrontRadius : kRearRadius;
            Transform hub;
            hub.translation = {axle, radius, kTrack * side};
            // The far wheels are turned about, so that their outer side looks out.
            const glm::dquat outwards = turn({0.0, 1.0, 0.0}, side > 0.0 ? 0.0 : degrees(180.0));
            const glm::dquat steered = turn({0.0, 1.0, 0.0}, axle > 0.0 ? motion.steer : 0.0);
            const Index node =
                scene_.add_node(name + (axle > 0.0 ? " front" : " rear") + (side > 0.0 ? " right" : " left") + " wheel",
                                car, hub, axle > 0.0 ? front_wheel_ : rear_wheel_);
            const double rate = motion.speed / radius;
            const int keys = 1 + static_cast<int>(std::ceil(3.0 * rate * scene_.duration()));
            scene_.animate_rotation(node, keys, [=](double t) {
                return steered * turn({0.0, 0.0, 1.0}, -rate * t + phase) * outwards;
            });
        }
    return car;
}

}  // namespace pentaprism::builtin
