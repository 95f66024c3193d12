// car: two racing cars of the sixties on a country road, seen from a car that drives beside them. The camera pans
// along, so the cars stay sharp while road, hedge and trees run to streaks, and the wheels, of which every spoke is
// modelled, spin.

#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include "scene/builtin/assembly.h"
#include "scene/builtin/plants.h"
#include "scene/builtin/recipes.h"
#include "scene/builtin/textures.h"

namespace pentaprism::builtin {
namespace {

constexpr double kDuration = 2.0;
constexpr double kSpeed = 18.0;  // metres per second along +x
constexpr double kTwoPi = 6.283185307179586;
constexpr double kTrack = 0.72, kFront = 1.22, kRear = -1.12;  // half width between wheels; axles
constexpr double kFrontRadius = 0.29, kRearRadius = 0.34;

// ---------------------------------------------------------------- one car, in metres, nose towards +x, y up

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

/// Paint: base colour, a stripe along the top, roundels with a number on both sides and on the nose.
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
    constexpr int kWidth = 512, kHeight = 512;
    Image image{std::move(name), kWidth, kHeight, {}};
    const Section side = section(0.40);
    const double per_u = kTwoPi * 0.5 * (side.top - side.bottom);
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            const double u = (x + 0.5) / kWidth, v = (y + 0.5) / kHeight;
            glm::dvec3 color = base;
            if (std::abs(u - 0.75) < 0.035) color = stripe;
            if (v > 0.955) color = stripe;
            // Roundels: on the sides the height is along u, on the nose the width is.
            struct Roundel {
                double u, v, up, right, radius;
            };
            for (const Roundel& r : {Roundel{0.5, 0.40, 1.0, -1.0, 0.19}, Roundel{1.0, 0.40, -1.0, 1.0, 0.19},
                                     Roundel{0.0, 0.40, -1.0, 1.0, 0.19}}) {
                const double dy = (u - r.u) * per_u * r.up / r.radius, dx = (v - r.v) * 3.72 * r.right / r.radius;
                if (dx * dx + dy * dy < 1.0)
                    color = digit(2.5 * dx, 2.5 * dy) ? glm::dvec3(0.01) : glm::dvec3(0.85, 0.84, 0.80);
            }
            for (int k = 0; k < 3; ++k) image.texels.push_back(srgb_code(color[k]));
            image.texels.push_back(255);
        }
    return image;
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
    m.ellipsoid({1.915, 0.345, 0.0}, {0.05, 0.075, 0.125}, 20, 10);
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

struct CarKind {
    Index front_wheel, rear_wheel, shadow;
};

struct CarMaterials {
    Index rubber, metal, fittings, glass;
};

Index add_car(Assembly& scene, const std::string& name, const CarMaterials& materials, const CarKind& wheels,
              Image paint, glm::dvec3 helmet, const std::function<glm::dvec3(double)>& path, double phase) {
    Material lacquer = painted(name + " lacquer", 0.22);
    lacquer.base_color_texture = texture(scene.add(std::move(paint)));
    lacquer.base_color_texture.wrap_t = Wrap::kClampToEdge;
    std::vector<Primitive> parts;
    parts.push_back(body(scene.add(lacquer)));
    parts.push_back(fittings(materials.fittings, helmet));
    parts.push_back(windscreen(materials.glass));
    const Index car = scene.add_node(name, kNone, {});
    scene.animate_translation(car, 25, path);
    const Index chassis = scene.add_node(name + " body", car, {}, scene.add_mesh(name, std::move(parts)));
    // It shivers on its springs.
    scene.animate_rotation(chassis, 49, [=](double t) {
        return turn({0.0, 0.0, 1.0}, degrees(0.35 * std::sin(17.0 * t + phase))) *
               turn({1.0, 0.0, 0.0}, degrees(1.1 + 0.4 * std::sin(13.0 * t + phase)));
    });
    scene.add_node(name + " shadow", car, {{0.0, 0.01, 0.0}, {1.0, 0.0, 0.0, 0.0}, glm::dvec3(1.0)}, wheels.shadow);
    for (const double axle : {kFront, kRear})
        for (const double side : {1.0, -1.0}) {
            const double radius = axle > 0.0 ? kFrontRadius : kRearRadius;
            Transform hub;
            hub.translation = {axle, radius, kTrack * side};
            // The far wheels are turned about, so that their outer side looks out.
            const glm::dquat outwards = turn({0.0, 1.0, 0.0}, side > 0.0 ? 0.0 : degrees(180.0));
            const Index node =
                scene.add_node(name + (axle > 0.0 ? " front" : " rear") + (side > 0.0 ? " right" : " left") + " wheel",
                               car, hub, axle > 0.0 ? wheels.front_wheel : wheels.rear_wheel);
            const double rate = kSpeed / radius;
            scene.animate_rotation(node, 1 + static_cast<int>(std::ceil(3.0 * rate * kDuration)), [=](double t) {
                return turn({0.0, 0.0, 1.0}, -rate * t + phase) * outwards;
            });
        }
    return car;
}

void add_cars(Assembly& scene) {
    Material rubber = painted("tyre", 0.85), metal = painted("wheel", 0.3), fittings = painted("fittings", 0.35);
    metal.metallic = 0.4f;
    Material glass = painted("windscreen", 0.05);
    glass.base_color = {1.0f, 1.0f, 1.0f, 0.25f};
    glass.alpha_mode = AlphaMode::kBlend;
    glass.double_sided = true;
    const CarMaterials materials{scene.add(rubber), scene.add(metal), scene.add(fittings), scene.add(glass)};
    CarKind wheels{};
    wheels.shadow = add_soft_shadow(scene);
    wheels.front_wheel = scene.add_mesh("front wheel", wheel(kFrontRadius, 0.19, materials.rubber, materials.metal));
    wheels.rear_wheel = scene.add_mesh("rear wheel", wheel(kRearRadius, 0.26, materials.rubber, materials.metal));
    add_car(
        scene, "green car", materials, wheels, livery("green livery", {0.008, 0.10, 0.045}, {0.85, 0.60, 0.02}, 7),
        {0.85, 0.82, 0.75}, [](double t) { return glm::dvec3(kSpeed * t + 0.10 * std::sin(2.0 * t), 0.0, 0.0); }, 0.4);
    add_car(
        scene, "red car", materials, wheels, livery("red livery", {0.52, 0.012, 0.010}, {0.85, 0.83, 0.78}, 2),
        {0.05, 0.12, 0.5}, [](double t) { return glm::dvec3(kSpeed * t - 4.1 + 0.9 * (t - 1.0), 0.0, -2.5); }, 1.9);
}

// ---------------------------------------------------------------- the road and what stands beside it

constexpr double kFrom = -34.0, kTo = 84.0;  // metres along x

void add_road(Assembly& scene) {
    Material asphalt = painted("asphalt", 0.85), grass = painted("verge", 0.95);
    asphalt.base_color_texture = texture(scene.add(litter_texture()), glm::dvec2(0.5));
    grass.base_color_texture = texture(0, glm::dvec2(0.35));
    const Index asphalt_index = scene.add(asphalt), grass_index = scene.add(grass);
    const auto strip = [](MeshBuilder& m, double z0, double z1, double height0, double height1, int along_count,
                          const Tint& tint) {
        m.surface(
            along_count, 2,
            [=](double u, double v) {
                return glm::dvec3(glm::mix(kFrom, kTo, u), glm::mix(height0, height1, v), glm::mix(z0, z1, v));
            },
            tint);
    };
    const auto in_metres = [](Primitive p) {
        for (std::size_t i = 0; i < p.positions.size(); ++i) p.texcoords[0][i] = {p.positions[i].x, p.positions[i].z};
        return p;
    };
    MeshBuilder m;
    strip(m, 2.6, -4.6, 0.0, 0.0, 110,
          [](double, double v, glm::dvec3) { return glm::dvec3(0.17, 0.165, 0.17) * (0.9 + 0.2 * v); });
    std::vector<Primitive> ground;
    ground.push_back(in_metres(m.take(asphalt_index)));
    const Tint meadow = [](double, double, glm::dvec3 p) {
        const double n = fractal_noise({0.5 * p.x, 0.9 * p.z}, 3);
        return glm::mix(glm::dvec3(0.10, 0.21, 0.04), glm::dvec3(0.34, 0.36, 0.09), n);
    };
    strip(m, 9.0, 2.6, -0.1, -0.005, 110, meadow);
    strip(m, -4.6, -13.0, -0.005, 0.15, 110, meadow);
    strip(m, -13.0, -60.0, 0.15, 3.0, 110, meadow);
    ground.push_back(in_metres(m.take(grass_index)));
    scene.add_node("ground", kNone, {}, scene.add_mesh("ground", std::move(ground)));

    // White dashes along the middle, a red and white kerb on the far side.
    MeshBuilder paint;
    paint.color = {0.75, 0.74, 0.70};
    for (double x = kFrom; x < kTo; x += 3.0)
        paint.surface(1, 1, [=](double u, double v) { return glm::dvec3(x + 1.5 * u, 0.006, -1.20 - 0.12 * v); });
    for (double x = kFrom; x < kTo; x += 1.0) {
        paint.color =
            static_cast<int>(std::floor(x)) % 2 == 0 ? glm::dvec3(0.62, 0.03, 0.02) : glm::dvec3(0.78, 0.76, 0.72);
        paint.surface(1, 2, [=](double u, double v) { return glm::dvec3(x + u, 0.008 + 0.07 * v, -4.4 - 0.5 * v); });
    }
    scene.add_node("road paint", kNone, {},
                   scene.add_mesh("road paint", paint.take(scene.add(painted("road paint", 0.6)))));
}

/// Straw bales, a fence, boards, flags, trees: what streaks past.
void add_roadside(Assembly& scene) {
    Random random(3);
    const Index material = scene.add(painted("roadside", 0.8));
    Material cloth = painted("foliage", 0.7);
    cloth.double_sided = true;
    const Index leafy = scene.add(cloth);

    MeshBuilder m;
    m.color = {0.55, 0.38, 0.13};
    m.box({-0.5, 0.0, -0.22}, {0.5, 0.42, 0.22});
    const Index bale = scene.add_node("straw bales", kNone, {}, scene.add_mesh("straw bale", m.take(material)));
    for (double x = kFrom; x < kTo; x += 1.12) {
        const double skew = random.around(0.0, 0.05), shift = random.around(0.0, 0.06);
        scene.node(bale).instances.push_back({{x, 0.03, -6.4 + shift}, turn({0.0, 1.0, 0.0}, skew), glm::dvec3(1.0)});
    }
    m.color = {0.62, 0.60, 0.56};
    m.box({-0.05, 0.0, -0.05}, {0.05, 1.15, 0.05});
    m.box({-1.25, 0.90, -0.02}, {1.25, 1.02, 0.02});
    m.box({-1.25, 0.50, -0.02}, {1.25, 0.62, 0.02});
    const Index fence = scene.add_node("fence", kNone, {}, scene.add_mesh("fence", m.take(material)));
    for (double x = kFrom; x < kTo; x += 2.5)
        scene.node(fence).instances.push_back({{x, 0.1, -10.5}, {1.0, 0.0, 0.0, 0.0}, glm::dvec3(1.0)});

    const glm::dvec3 colors[] = {
        {0.70, 0.50, 0.04}, {0.04, 0.14, 0.42}, {0.60, 0.04, 0.03}, {0.75, 0.73, 0.68}, {0.03, 0.30, 0.20}};
    std::vector<Index> boards;
    for (int k = 0; k < 5; ++k) {
        m.color = colors[k];
        m.box({-2.4, 0.25, -0.04}, {2.4, 1.25, 0.04});
        m.color = colors[(k + 3) % 5];
        m.box({-1.8, 0.55, 0.04}, {1.8, 0.95, 0.06});
        boards.push_back(scene.add_mesh("board", m.take(material)));
    }
    for (int k = 0; k < 14; ++k)
        scene.add_node("board", kNone, {{kFrom + 4.0 + 7.6 * k, 0.1, -8.4}, {1.0, 0.0, 0.0, 0.0}, glm::dvec3(1.0)},
                       boards[std::size_t(k * 2 % 5)]);

    // Trees: a trunk and a crown of large leaves.
    std::vector<Index> crowns;
    for (int kind = 0; kind < 2; ++kind) {
        MeshBuilder trunk, crown;
        trunk.color = {0.12, 0.085, 0.06};
        trunk.tube(
            {{{0.0, -0.2, 0.0}, 0.32}, {{0.05, 1.4, 0.0}, 0.2}, {{0.0, 3.2, 0.1}, 0.13}, {{0.1, 5.6, 0.0}, 0.04}}, 8,
            8);
        const Palette palette = kind == 0 ? Palette{{0.05, 0.16, 0.03}, {0.20, 0.34, 0.06}, {0.45, 0.40, 0.08}, 0.1}
                                          : Palette{{0.20, 0.20, 0.03}, {0.48, 0.36, 0.06}, {0.50, 0.22, 0.04}, 0.2};
        for (int k = 0; k < 140; ++k) {
            const glm::dvec3 d = random.direction();
            const double r = std::cbrt(random.uniform());
            Blade leaf;
            leaf.base = glm::dvec3(0.0, 4.3, 0.0) + r * d * glm::dvec3(1.9, 2.2, 1.9);
            leaf.axis = random.direction() + 0.5 * d;
            leaf.face = glm::dvec3(0.0, 0.8, 0.0) + d;
            leaf.length = random.range(0.6, 1.0);
            leaf.width = 0.45 * leaf.length;
            leaf.bend = 0.6;
            leaf.fold = 0.3;
            const glm::dvec3 color = palette.pick(random) * (0.4 + 0.6 * r) * (0.75 + 0.25 * d.y);
            crown.blade(leaf, [&](double, double v, glm::dvec3) { return color * (0.8 + 0.3 * v); });
        }
        std::vector<Primitive> parts;
        parts.push_back(trunk.take(material));
        parts.push_back(crown.take(leafy));
        crowns.push_back(scene.add_mesh("tree", std::move(parts)));
    }
    for (int k = 0; k < 16; ++k) {
        const double x = kFrom + 6.8 * k + random.around(0.0, 1.6), z = -15.0 - 11.0 * random.uniform();
        const double yaw = random.angle();
        const Index node = scene.add_node(
            "tree", kNone,
            {{x, 0.1 - 0.06 * (z + 13.0), z}, turn({0.0, 1.0, 0.0}, yaw), glm::dvec3(random.range(0.85, 1.35))},
            crowns[std::size_t(k % 2)]);
        scene.sway(node, {1.0, 0.0, 0.4}, degrees(1.2), random.range(1.6, 2.4), random.angle());
    }
    // Grass between the camera and the road, close to the lens.
    MeshBuilder tuft;
    add_grass_tuft(tuft, random, 12, 1.0, {{0.10, 0.20, 0.03}, {0.35, 0.42, 0.10}, {0.6, 0.5, 0.2}, 0.15});
    const Index grass = scene.add_node("tall grass", kNone, {}, scene.add_mesh("tall grass", tuft.take(leafy)));
    for (int k = 0; k < 45; ++k) {
        const double x = glm::mix(-10.0, 56.0, (k + random.uniform()) / 45.0), z = random.range(3.3, 4.9),
                     yaw = random.angle();
        scene.node(grass).instances.push_back(
            {{x, -0.06, z}, turn({0.0, 1.0, 0.0}, yaw), glm::dvec3(random.range(0.45, 0.75))});
    }
}

void add_sky(Assembly& scene) {
    Material sky;
    sky.name = "sky";
    sky.unlit = true;
    sky.double_sided = true;
    MeshBuilder m;
    m.surface(
        30, 24, [](double u, double v) { return glm::dvec3(glm::mix(-90.0, 130.0, u), -2.0 + 46.0 * v, -62.0); },
        [](double u, double v, glm::dvec3) {
            const double cloud = fractal_noise({16.0 * u, 30.0 * v}, 4);
            const double hills = fractal_noise({9.0 * u, 3.0}, 3);
            const glm::dvec3 clear =
                glm::mix(glm::dvec3(0.82, 0.72, 0.56), glm::dvec3(0.10, 0.27, 0.58), glm::smoothstep(0.06, 0.30, v));
            const glm::dvec3 above =
                glm::mix(clear, glm::dvec3(0.95, 0.88, 0.78), 0.8 * glm::smoothstep(0.5, 0.72, cloud));
            return glm::mix(glm::dvec3(0.20, 0.27, 0.26), above, glm::smoothstep(0.0, 0.03, v - 0.055 - 0.07 * hills));
        });
    scene.add_node("sky", kNone, {}, scene.add_mesh("sky", m.take(scene.add(sky))));
}

void add_camera_and_light(Assembly& scene) {
    const Index camera = scene.add_camera("panning", {}, {60.0, 0.95, 8.0, 0.5, 0});
    // The camera's car is a little slower, so the picture pans.
    const auto eye = [](double t) { return glm::dvec3(kSpeed * t + 3.3 - 1.1 * (t - 1.0), 0.80, 7.5); };
    const auto target = [](double t) { return glm::dvec3(kSpeed * t + 0.05 - 0.25 * (t - 1.0), 0.70, 0.0); };
    scene.animate_translation(camera, 13, eye);
    scene.animate_rotation(camera, 13, [=](double t) { return looking(eye(t), target(t)); });
    scene.add_sun("afternoon sun", {0.55, 0.62, 0.65}, {1.0f, 0.83f, 0.60f}, 4.2);
    scene.add_sun("sky light", {-0.2, 1.0, -0.25}, {0.55f, 0.72f, 1.0f}, 1.6);
    scene.add_sun("bounce", {-0.5, -0.3, 1.0}, {1.0f, 0.9f, 0.75f}, 0.5);
}

}  // namespace

Scene car() {
    Assembly scene("builtin:car", kDuration);
    add_camera_and_light(scene);
    add_road(scene);
    add_roadside(scene);
    add_sky(scene);
    add_cars(scene);
    return scene.take({0.45f, 0.58f, 0.75f});
}

}  // namespace pentaprism::builtin
