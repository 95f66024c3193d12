// fairy-forest: a glade at fairy scale (trees about a metre high) at dusk. A fairy flies through the plane of focus, 62
// cm from the lens; leaves and flowers in front of it and a wood full of glowing lights behind it are out of focus.
// Depth comes from three layers of colour: warm and saturated near, green in the middle, blue haze far away.

#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "scene/builtin/assembly.h"
#include "scene/builtin/fairy.h"
#include "scene/builtin/plants.h"
#include "scene/builtin/recipes.h"
#include "scene/builtin/textures.h"

namespace pentaprism::builtin {
namespace {

constexpr double kDuration = 4.0;
constexpr double kFocus = 0.62;
constexpr double kTwoPi = 6.283185307179586;

const Palette kGrass{{0.05, 0.11, 0.015}, {0.20, 0.30, 0.05}, {0.42, 0.36, 0.10}, 0.1};
const Palette kNearLeaves{{0.10, 0.22, 0.03}, {0.34, 0.42, 0.07}, {0.72, 0.42, 0.06}, 0.12};
const Palette kBlossom{{0.72, 0.30, 0.34}, {0.88, 0.58, 0.58}, {0.30, 0.40, 0.08}, 0.2};
const Palette kFarLeaves{{0.04, 0.15, 0.09}, {0.13, 0.30, 0.14}, {0.45, 0.38, 0.12}, 0.08};
const Palette kFern{{0.06, 0.17, 0.03}, {0.16, 0.32, 0.06}, {0.30, 0.30, 0.05}, 0.1};

/// The forest floor: soft bumps, rising towards the sides and the distance so that it stays in view.
double ground_height(double x, double z) {
    const double bumps = 0.085 * (fractal_noise({1.7 * x, 1.7 * z}, 4) - 0.5);
    const double fine = 0.012 * (fractal_noise({14.0 * x, 14.0 * z}, 2) - 0.5);
    const double sides = 0.035 * x * x / (1.0 + 0.12 * x * x);
    const double distance = 0.028 * z * z / (1.0 + 0.15 * z * z);
    return bumps + fine + sides + distance - 0.02;
}

glm::dvec3 on_ground(double x, double z) {
    return {x, ground_height(x, z), z};
}

Transform placed(glm::dvec3 position, double yaw = 0.0, double scale = 1.0) {
    return {position, turn({0.0, 1.0, 0.0}, yaw), glm::dvec3(scale)};
}

/// Where the fairy is: across the picture from left to right, bobbing, a little towards the camera.
glm::dvec3 fairy_path(double t) {
    return {-0.205 + 0.115 * t, 0.158 + 0.02 * std::sin(2.1 * t + 0.9), -0.03 + 0.03 * std::sin(0.9 * t + 0.6)};
}

void add_ground(Assembly& forest) {
    Material soil = painted("forest floor", 0.95);
    soil.base_color_texture = texture(forest.add(litter_texture()), glm::dvec2(4.5));  // texture coordinates are metres
    const Index index = forest.add(soil);
    MeshBuilder m;
    m.surface(
        100, 78,
        [](double u, double v) {
            // Finer near the camera: the grid's rows lie closer together there.
            const double z = 0.75 - 8.0 * std::pow(v, 1.9);
            const double x = (2.0 * u - 1.0) * (0.9 + 5.6 * std::pow(v, 1.3));
            return on_ground(x, z);
        },
        [](double, double, glm::dvec3 p) {
            const glm::dvec3 earth{0.13, 0.075, 0.035}, moss{0.13, 0.21, 0.035}, litter{0.34, 0.19, 0.06};
            const double mossy = glm::smoothstep(0.36, 0.58, fractal_noise({3.1 * p.x, 3.1 * p.z}, 4));
            const double littered = glm::smoothstep(0.5, 0.75, fractal_noise({22.0 * p.x + 5.0, 22.0 * p.z}, 3));
            const glm::dvec3 near = glm::mix(glm::mix(earth, moss, mossy), litter, 0.5 * littered);
            return glm::mix(near, glm::dvec3(0.05, 0.13, 0.10), glm::smoothstep(0.8, 5.5, -p.z));
        });
    Primitive floor = m.take(index);
    for (std::size_t i = 0; i < floor.positions.size(); ++i)
        floor.texcoords[0][i] = {floor.positions[i].x, floor.positions[i].z};
    forest.add_node("forest floor", kNone, {}, forest.add_mesh("forest floor", std::move(floor)));
}

/// The sky seen between the trunks: a curved wall that glows where the sun has just set. Only behind the trees, so that
/// it stands in no light's way.
void add_evening_sky(Assembly& forest) {
    const Index index = forest.add(backdrop("evening sky"));
    MeshBuilder m;
    m.surface(
        48, 28,
        [](double u, double v) {
            const double a = degrees(-52.0 + 104.0 * u);
            return glm::dvec3(8.6 * std::sin(a), -0.6 + 6.4 * v, 0.6 - 8.6 * std::cos(a));
        },
        [](double u, double v, glm::dvec3) {
            const glm::dvec3 high{0.008, 0.024, 0.050}, middle{0.035, 0.100, 0.120}, low{0.16, 0.15, 0.09},
                halo{0.46, 0.21, 0.07}, glow{1.0, 0.60, 0.20};
            const glm::dvec3 base =
                glm::mix(glm::mix(low, middle, glm::smoothstep(0.1, 0.3, v)), high, glm::smoothstep(0.25, 0.6, v));
            const auto spot = [&](double radius_u, double radius_v) {
                const double dx = (u - 0.585) / radius_u, dy = (v - 0.24) / radius_v;
                return std::exp(-(dx * dx + dy * dy));
            };
            return glm::mix(glm::mix(base, halo, spot(0.2, 0.2)), glow, spot(0.075, 0.1));
        });
    forest.add_node("evening sky", kNone, {}, forest.add_mesh("evening sky", m.take(index)));
}

/// Meshes of one kind of tree; trees are put together from them as nodes that sway.
struct TreeKind {
    std::vector<Index> trunks, branches;
};

TreeKind make_tree_kind(Assembly& forest, const std::string& name, Random& random, glm::dvec3 wood, glm::vec3 haze,
                        const BranchStyle& style, const Palette& palette, Index bark_image, Index leaf_image) {
    Material bark = painted(name + " bark", 0.95);
    bark.base_color_texture = texture(bark_image);
    bark.emissive = haze;
    Material leaf = painted(name + " leaf", 0.6);
    leaf.base_color_texture = texture(leaf_image);
    leaf.double_sided = true;
    leaf.emissive = haze;
    const Index bark_material = forest.add(bark), leaf_material = forest.add(leaf);

    TreeKind kind;
    for (int i = 0; i < 2; ++i) {
        MeshBuilder trunk;
        trunk.color = wood;
        add_trunk(trunk, random, 1.0, 0.042);
        kind.trunks.push_back(forest.add_mesh(name + " trunk", trunk.take(bark_material)));
    }
    for (int i = 0; i < 3; ++i) {
        MeshBuilder twigs, leaves;
        twigs.color = 0.8 * wood;
        add_branch(twigs, leaves, random, style, palette);
        std::vector<Primitive> parts;
        parts.push_back(twigs.take(bark_material));
        parts.push_back(leaves.take(leaf_material));
        kind.branches.push_back(forest.add_mesh(name + " branch", std::move(parts)));
    }
    return kind;
}

void add_tree(Assembly& forest, Random& random, const TreeKind& kind, glm::dvec3 foot, double height, int branches,
              double lowest) {
    const double yaw = random.angle();
    const Index trunk =
        forest.add_node("tree", kNone, placed(foot, yaw, height), kind.trunks[std::size_t(random.below(2))]);
    for (int k = 0; k < branches; ++k) {
        const double t = lowest + (0.97 - lowest) * (k + 0.6 * random.uniform()) / branches;
        const double a = 2.4 * k + random.around(0.0, 0.4);
        const double rise = 0.15 + 1.1 * t * t;
        const glm::dvec3 out = glm::normalize(glm::dvec3(std::cos(a), rise, std::sin(a)));
        // The branch mesh grows along +y: turn it to `out`.
        const glm::dvec3 axis = glm::normalize(glm::cross(glm::dvec3(0.0, 1.0, 0.0), out));
        Transform pose;
        pose.translation = {0.02 * (t - 0.5), t, 0.0};
        pose.rotation = turn(axis, std::acos(out.y)) * turn({0.0, 1.0, 0.0}, random.angle());
        pose.scale = glm::dvec3((0.44 - 0.2 * t) * random.range(0.85, 1.15));
        const Index branch = forest.add_node("branch", trunk, pose, kind.branches[std::size_t(random.below(3))]);
        const double period = random.range(1.3, 2.2);
        const double amplitude = degrees(random.range(3.0, 6.0));
        forest.sway(branch, axis, amplitude, period, random.angle());
    }
}

void add_trees(Assembly& forest) {
    Random random(11);
    const Index bark = forest.add(bark_texture()), leaf = forest.add(leaf_texture());
    const TreeKind near = make_tree_kind(forest, "oak", random, {0.20, 0.13, 0.08}, {0.004f, 0.006f, 0.004f},
                                         {6, 150, 0.115, 0.055, 0.035}, kNearLeaves, bark, leaf);
    const TreeKind cherry = make_tree_kind(forest, "cherry", random, {0.17, 0.10, 0.09}, {0.010f, 0.008f, 0.008f},
                                           {6, 150, 0.085, 0.06, 0.03}, kBlossom, bark, leaf);
    const TreeKind far = make_tree_kind(forest, "far tree", random, {0.09, 0.10, 0.10}, {0.006f, 0.018f, 0.022f},
                                        {4, 70, 0.18, 0.095, 0.04}, kFarLeaves, bark, leaf);

    // Two trunks frame the picture; the rest leave a clearing towards the light.
    add_tree(forest, random, near, on_ground(-0.66, -0.42), 1.55, 7, 0.42);
    add_tree(forest, random, cherry, on_ground(0.92, -1.05), 1.30, 8, 0.32);
    add_tree(forest, random, near, on_ground(-1.25, -1.55), 1.45, 8, 0.35);
    add_tree(forest, random, cherry, on_ground(-0.52, -2.25), 1.15, 8, 0.3);
    add_tree(forest, random, near, on_ground(1.75, -2.1), 1.5, 8, 0.34);
    const glm::dvec2 far_feet[] = {{-2.5, -3.1}, {-1.45, -3.7}, {1.15, -3.5}, {2.6, -3.4}, {-0.55, -4.9},
                                   {0.6, -5.4},  {-3.3, -4.9},  {2.1, -5.0},  {3.6, -4.6}};
    for (const glm::dvec2& foot : far_feet) {
        const double height = random.range(1.5, 2.3);
        add_tree(forest, random, far, on_ground(foot.x, foot.y), height, 8, 0.3);
    }

    // Twigs hang into the picture close to the lens.
    struct Twig {
        glm::dvec3 at;
        double angle, size;
        Index mesh;
    };
    for (const Twig& t : {Twig{{-0.25, 0.335, 0.26}, -104.0, 0.17, near.branches[0]},
                          Twig{{0.235, 0.305, 0.28}, 112.0, 0.15, cherry.branches[1]}}) {
        Transform pose;
        pose.translation = t.at;
        pose.rotation = turn({0.0, 0.0, 1.0}, degrees(t.angle)) * turn({0.0, 1.0, 0.0}, 1.0);
        pose.scale = glm::dvec3(t.size);
        const Index twig = forest.add_node("foreground twig", kNone, pose, t.mesh);
        forest.sway(twig, {0.0, 0.0, 1.0}, degrees(4.0), 1.7, 0.4 + t.size);
    }
}

void add_undergrowth(Assembly& forest) {
    Random random(23);
    Material leafy = painted("undergrowth", 0.6);
    leafy.double_sided = true;
    const Index material = forest.add(leafy);

    std::vector<Index> tufts;
    for (int i = 0; i < 3; ++i) {
        MeshBuilder grass;
        add_grass_tuft(grass, random, 20, 1.0, kGrass);
        tufts.push_back(forest.add_mesh("grass tuft", grass.take(material)));
    }
    // Near tufts sway one by one; those in the distance are instances of one node.
    for (int k = 0; k < 46; ++k) {
        const double z = 0.3 - 1.5 * std::pow(random.uniform(), 1.2);
        const double x = random.around(0.0, 0.30 + 0.62 * (0.62 - z));
        const double size = (std::abs(x) < 0.22 && z > -0.3 ? 0.055 : 0.10) * random.range(0.7, 1.2);
        const Index tuft =
            forest.add_node("grass", kNone, placed(on_ground(x, z), random.angle(), size), tufts[std::size_t(k % 3)]);
        forest.sway(tuft, {random.around(0.0, 0.4), 0.0, 1.0}, degrees(random.range(4.0, 8.0)), random.range(0.9, 1.5),
                    random.angle());
    }
    for (int i = 0; i < 3; ++i) {
        const Index meadow = forest.add_node("meadow", kNone, {}, tufts[std::size_t(i)]);
        for (int k = 0; k < 30; ++k) {
            const double z = -0.7 - 3.6 * std::pow(random.uniform(), 1.2);
            const double x = random.around(0.0, 0.5 - 0.75 * z);
            const double yaw = random.angle();
            forest.node(meadow).instances.push_back(placed(on_ground(x, z), yaw, random.range(0.09, 0.17)));
        }
    }
    MeshBuilder clover;
    for (int k = 0; k < 17; ++k) {
        const glm::dvec2 at = 0.5 * random.in_disk();
        const glm::dvec3 top{at.x, random.range(0.08, 0.2), at.y};
        const double a = random.angle();
        const glm::dvec3 color = kGrass.pick(random);
        for (int leaflet = 0; leaflet < 3; ++leaflet) {
            const double b = a + kTwoPi * leaflet / 3.0;
            clover.blade({top, {std::cos(b), 0.25, std::sin(b)}, {0.0, 1.0, 0.0}, 0.11, 0.1, 0.3, 0.25, 0.65, 2},
                         [&](double, double v, glm::dvec3) { return color * (0.6 + 0.7 * v); });
        }
    }
    const Index carpet = forest.add_node("clover", kNone, {}, forest.add_mesh("clover", clover.take(material)));
    for (int k = 0; k < 36; ++k) {
        const double z = 0.2 - 0.75 * random.uniform();
        const double x = random.around(0.0, 0.2 + 0.62 * (0.62 - z));
        const double yaw = random.angle();
        forest.node(carpet).instances.push_back(placed(on_ground(x, z), yaw, random.range(0.07, 0.12)));
    }

    // Two tufts right before the lens frame the picture from below.
    for (const glm::dvec3& at : {glm::dvec3(0.21, 0.0, 0.30), glm::dvec3(-0.17, -0.01, 0.33)}) {
        const Index tuft =
            forest.add_node("foreground grass", kNone, placed(on_ground(at.x, at.z), 0.7, 0.115), tufts[1]);
        forest.sway(tuft, {0.0, 0.0, 1.0}, degrees(5.0), 1.2, 6.0 * at.x);
    }

    MeshBuilder fern;
    add_fern(fern, random, 7, 1.0, kFern);
    const Index fern_mesh = forest.add_mesh("fern", fern.take(material));
    const glm::dvec3 ferns[] = {
        {-0.40, -0.22, 0.20}, {0.50, -0.42, 0.22}, {0.30, -0.95, 0.24}, {-0.85, -0.9, 0.28}, {-0.215, 0.19, 0.15}};
    for (const glm::dvec3& f : ferns) {
        const Index node = forest.add_node("fern", kNone, placed(on_ground(f.x, f.y), random.angle(), f.z), fern_mesh);
        forest.sway(node, {1.0, 0.0, 0.3}, degrees(2.5), random.range(1.5, 2.1), random.angle());
    }
}

void add_flowers(Assembly& forest) {
    Random random(31);
    Material waxy = painted("flower", 0.5);
    waxy.double_sided = true;
    const Index material = forest.add(waxy);
    FlowerStyle daisy;
    FlowerStyle violet;
    violet.petals = 6;
    violet.petal = {0.20, 0.10, 0.55};
    violet.petal_tip = {0.48, 0.34, 0.85};
    violet.petal_length = 0.02;
    violet.petal_width = 0.015;
    violet.cup = 0.75;
    FlowerStyle poppy = violet;
    poppy.petal = {0.75, 0.16, 0.03};
    poppy.petal_tip = {0.85, 0.40, 0.10};
    const FlowerStyle styles[] = {daisy, violet, poppy};
    std::vector<Index> meshes;
    for (const FlowerStyle& style : styles)
        for (int i = 0; i < 2; ++i) {
            MeshBuilder flower;
            add_flower(flower, random, style);
            meshes.push_back(forest.add_mesh("flower", flower.take(material)));
        }
    struct Spot {
        double x, z, scale;
        int kind;
    };
    const Spot spots[] = {
        {-0.255, -0.02, 0.85, 0}, {-0.30, 0.03, 0.65, 1}, {-0.215, 0.05, 0.5, 0},  {-0.34, -0.06, 0.9, 1},
        {0.05, -0.12, 0.6, 0},    {0.37, -0.06, 0.9, 0},  {0.33, 0.04, 0.55, 1},   {0.43, -0.15, 1.0, 2},
        {-0.08, -0.35, 0.8, 1},   {0.12, -0.5, 0.9, 2},   {-0.2, -0.6, 1.0, 0},    {0.62, -0.5, 1.1, 0},
        {-0.5, -0.75, 1.1, 2},    {0.245, 0.255, 1.0, 1}, {-0.235, 0.275, 0.8, 2}, {-0.2, 0.31, 0.6, 2}};
    for (const Spot& s : spots) {
        const int variant = random.below(2);
        const Index mesh = meshes[std::size_t(2 * s.kind + variant)];
        const Index node = forest.add_node("flower", kNone, placed(on_ground(s.x, s.z), random.angle(), s.scale), mesh);
        forest.sway(node, {0.3, 0.0, 1.0}, degrees(random.range(4.0, 7.0)), random.range(1.0, 1.6), random.angle());
    }
}

void add_mushrooms(Assembly& forest) {
    Random random(41);
    const Index material = forest.add(painted("mushroom", 0.35));
    MushroomStyle big;
    MushroomStyle young = big;
    young.cap_radius = 0.026;
    young.cap_height = 0.032;
    young.height = 0.055;
    young.dots = 9;
    std::vector<Index> meshes;
    for (const MushroomStyle& style : {big, young}) {
        MeshBuilder m;
        add_mushroom(m, random, style);
        meshes.push_back(forest.add_mesh("toadstool", m.take(material)));
    }
    struct Spot {
        double x, z, scale;
        int kind;
    };
    for (const Spot& s : {Spot{0.185, -0.035, 1.15, 0}, Spot{0.255, 0.005, 0.85, 1}, Spot{0.125, 0.02, 0.7, 1},
                          Spot{0.28, -0.12, 0.9, 0}, Spot{-0.62, -0.5, 1.3, 0}})
        forest.add_node("toadstool", kNone, placed(on_ground(s.x, s.z), random.angle(), s.scale),
                        meshes[std::size_t(s.kind)]);

    // Small ones that glow blue at the foot of the left trunk and light the moss around them.
    Material glowing = painted("glowing mushroom", 0.5);
    glowing.emissive = {0.006f, 0.075f, 0.11f};
    const Index glow = forest.add(glowing);
    MushroomStyle lamp;
    lamp.cap = {0.06, 0.30, 0.42};
    lamp.stem = {0.16, 0.32, 0.38};
    lamp.gills = {0.5, 0.9, 1.0};
    lamp.height = 0.035;
    lamp.cap_radius = 0.011;
    lamp.cap_height = 0.013;
    lamp.stem_radius = 0.0025;
    lamp.dots = 0;
    lamp.detail = 7;
    MeshBuilder m;
    add_mushroom(m, random, lamp);
    const Index mesh = forest.add_mesh("glowing mushroom", m.take(glow));
    const glm::dvec2 feet[] = {{-0.375, -0.10}, {-0.35, -0.06}, {-0.42, -0.13}, {-0.40, -0.05}, {0.06, -0.05},
                               {0.035, -0.02},  {0.075, -0.0},  {0.52, -0.25},  {0.55, -0.22}};
    for (const glm::dvec2& foot : feet)
        forest.add_node("glowing mushroom", kNone,
                        placed(on_ground(foot.x, foot.y), random.angle(), random.range(0.8, 1.5)), mesh);
    forest.add_point_light("blue glow left", kNone, on_ground(-0.385, -0.05) + glm::dvec3(0.0, 0.06, 0.04),
                           {0.2f, 0.75f, 1.0f}, 0.005);
    forest.add_point_light("blue glow middle", kNone, on_ground(0.06, -0.01) + glm::dvec3(0.0, 0.05, 0.03),
                           {0.2f, 0.75f, 1.0f}, 0.0025);
}

/// Fireflies hover in the wood behind: bright points that the lens turns into disks.
void add_fireflies(Assembly& forest) {
    Random random(53);
    const glm::vec3 colors[] = {{9.0f, 4.6f, 1.1f}, {7.0f, 5.6f, 1.5f}, {1.6f, 5.5f, 4.6f}};
    std::vector<Index> meshes;
    for (const glm::vec3& color : colors) {
        Material light = painted("firefly");
        light.base_color = {0.0f, 0.0f, 0.0f, 1.0f};
        light.emissive = color;
        MeshBuilder m;
        m.ellipsoid(glm::dvec3(0.0), glm::dvec3(1.0), 7, 5);
        meshes.push_back(forest.add_mesh("firefly", m.take(forest.add(light))));
    }
    for (int k = 0; k < 64; ++k) {
        const double depth = 0.9 + 4.6 * std::pow(random.uniform(), 1.1);  // metres from the lens
        const glm::dvec3 at{random.around(0.0, 0.62 * depth),
                            0.05 + 0.33 * depth * std::pow(random.uniform(), 1.3) + 0.03 * depth, 0.62 - depth};
        const glm::dvec3 swing = 0.05 * random.direction();
        const double phase = random.angle();
        const Index node = forest.add_node(
            "firefly", kNone, placed(at, 0.0, (0.0012 + 0.0048 * (depth - kFocus)) * random.range(0.75, 1.2)),
            meshes[std::size_t(k % 5 == 4 ? 2 : k % 2)]);
        forest.animate_translation(node, 9, [=](double t) {
            return at + swing * std::sin(1.9 * t + phase) +
                   glm::dvec3(0.0, 0.02 * std::sin(2.7 * t + 2.0 * phase), 0.0);
        });
    }
}

void add_falling_petals(Assembly& forest) {
    Random random(61);
    Material silk = painted("petal", 0.6);
    silk.double_sided = true;
    silk.emissive = {0.02f, 0.01f, 0.01f};
    MeshBuilder m;
    m.blade({glm::dvec3(0.0, -0.5, 0.0), {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}, 1.0, 0.75, 0.8, 0.3, 0.6, 5},
            [](double, double v, glm::dvec3) {
                return glm::mix(glm::dvec3(0.82, 0.35, 0.42), glm::dvec3(0.92, 0.72, 0.72), v);
            });
    const Index mesh = forest.add_mesh("petal", m.take(forest.add(silk)));
    for (int k = 0; k < 56; ++k) {
        const double depth = k < 5 ? random.range(0.3, 0.45) : random.range(0.5, 2.6);
        const glm::dvec3 at_one{random.around(0.0, 0.62 * depth), 0.14 + random.around(0.0, 0.36 * depth),
                                0.62 - depth};  // its place at t = 1 s
        const double fall = random.range(0.12, 0.24), drift = random.range(0.05, 0.16),
                     swing = random.range(0.015, 0.035);
        const double phase = random.angle(), spin = random.range(2.5, 5.5);
        const glm::dvec3 axis = random.direction();
        const Index node =
            forest.add_node("falling petal", kNone, placed(at_one, 0.0, 0.014 * random.range(0.7, 1.2)), mesh);
        forest.animate_translation(node, 25, [=](double t) {
            const double s = t - 1.0;
            return at_one + glm::dvec3(drift * s + swing * std::sin(4.0 * s + phase), -fall * s,
                                       swing * std::cos(3.1 * s + phase));
        });
        forest.animate_rotation(node, 33, [=](double t) {
            return turn(axis, spin * t + phase) * turn({1.0, 0.0, 0.0}, 0.8 * std::sin(3.0 * t));
        });
    }

    // Petals that lie on the ground already.
    const Index carpet = forest.add_node("fallen petals", kNone, {}, mesh);
    for (int k = 0; k < 110; ++k) {
        const double z = 0.3 - 1.9 * random.uniform();
        const double x = random.around(0.0, 0.2 + 0.62 * (0.62 - z));
        Transform t = placed(on_ground(x, z) + glm::dvec3(0.0, 0.003, 0.0), 0.0, 0.011 * random.range(0.7, 1.2));
        const double yaw = random.angle();
        t.rotation = turn({0.0, 1.0, 0.0}, yaw) * turn({1.0, 0.0, 0.0}, -1.5707963 + random.around(0.0, 0.35));
        forest.node(carpet).instances.push_back(t);
    }
}

void add_the_fairy(Assembly& forest) {
    constexpr double kScale = 0.0185;
    const Index root = forest.add_node("flight", kNone, placed(fairy_path(0.0), 0.0, kScale));
    forest.animate_translation(root, 25, fairy_path);
    forest.animate_rotation(root, 25, [](double t) {
        const glm::dquat heading = turn({0.0, 1.0, 0.0}, degrees(52.0 + 6.0 * std::sin(1.3 * t)));
        return heading * turn({1.0, 0.0, 0.0}, degrees(24.0 + 5.0 * std::sin(2.1 * t))) *
               turn({0.0, 0.0, 1.0}, degrees(4.0 * std::sin(1.7 * t)));
    });
    // Turn about the middle of the body, not about the feet.
    const Index body = forest.add_node("fairy", root, {{0.0, -5.0, 0.0}, {1.0, 0.0, 0.0, 0.0}, glm::dvec3(1.0)});
    add_fairy(forest, body, 4.5);
    forest.add_point_light("fairy light", root, {1.0, 3.0, 5.0}, {1.0f, 0.8f, 0.55f}, 0.016);

    // Sparks fall from her path.
    Random random(71);
    Material spark = painted("spark");
    spark.base_color = {0.0f, 0.0f, 0.0f, 1.0f};
    spark.emissive = {14.0f, 10.0f, 4.5f};
    MeshBuilder m;
    m.ellipsoid(glm::dvec3(0.0), glm::dvec3(1.0), 7, 5);
    const Index mesh = forest.add_mesh("spark", m.take(forest.add(spark)));
    for (int k = 0; k < 44; ++k) {
        const double born = -2.2 + 6.0 * k / 43.0;  // seconds
        const glm::dvec3 scatter = glm::dvec3(0.022, 0.035, 0.03) * random.direction();
        const double fall = random.range(0.015, 0.05), radius = random.range(0.0006, 0.0014);
        const Index node = forest.add_node("spark", kNone, placed(glm::dvec3(0.0), 0.0, radius), mesh);
        forest.animate_translation(node, 17, [=](double t) {
            const double age = t - born;
            // Before its birth a spark rides along, hidden in her dress.
            const glm::dvec3 ride = fairy_path(t) + glm::dvec3(-0.01, -0.012, 0.0);
            const glm::dvec3 free = fairy_path(born) + glm::dvec3(-0.03, -0.015, 0.0) +
                                    scatter * glm::smoothstep(0.0, 0.5, age) - glm::dvec3(0.0, fall * age, 0.0);
            return glm::mix(ride, free, glm::smoothstep(0.0, 0.25, age));
        });
    }
}

void add_camera_and_light(Assembly& forest) {
    const Lens lens{28.0, 1.8, kFocus, 0.5, 0};
    const Index camera = forest.add_camera("dolly", {}, lens);
    const auto eye = [](double t) { return glm::dvec3(-0.05 + 0.045 * t, 0.118 + 0.006 * t, 0.62 - 0.004 * t); };
    const auto target = [](double t) { return glm::dvec3(0.0 + 0.05 * t, 0.142 + 0.003 * std::sin(t), 0.0); };
    forest.animate_translation(camera, 9, eye);
    forest.animate_rotation(camera, 9, [=](double t) { return looking(eye(t), target(t)); });

    forest.add_sun("evening sun", {0.75, 0.42, -0.22}, {1.0f, 0.66f, 0.36f}, 6.5);
    forest.add_sun("sky", {-0.25, 1.0, 0.35}, {0.45f, 0.65f, 1.0f}, 1.1);
    forest.add_sun("fill", {-0.6, 0.25, 1.0}, {1.0f, 0.80f, 0.66f}, 1.1);
}

}  // namespace

Scene fairy_forest() {
    Assembly forest("builtin:fairy-forest", kDuration);
    add_camera_and_light(forest);
    add_ground(forest);
    add_evening_sky(forest);
    add_trees(forest);
    add_undergrowth(forest);
    add_flowers(forest);
    add_mushrooms(forest);
    add_the_fairy(forest);
    add_fireflies(forest);
    add_falling_petals(forest);
    return forest.take({0.03f, 0.05f, 0.08f});
}

}  // namespace pentaprism::builtin
