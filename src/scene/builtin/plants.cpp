#include "scene/builtin/plants.h"

#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include "scene/builtin/assembly.h"

namespace pentaprism::builtin {

glm::dvec3 Palette::pick(Random& random) const {
    const double t = random.uniform();
    const bool other = random.chance(accent_share);
    return other ? accent * (0.8 + 0.4 * t) : glm::mix(dark, light, t);
}

void add_trunk(MeshBuilder& bark, Random& random, double height, double radius) {
    std::vector<TubePoint> line;
    glm::dvec3 p{0.0, -0.05 * height, 0.0};
    glm::dvec2 lean{0.0};
    constexpr int kPoints = 9;
    for (int i = 0; i < kPoints; ++i) {
        const double t = double(i) / (kPoints - 1);
        const double flare = 1.1 * std::exp(-t * 16.0);
        line.push_back({p, radius * (1.0 - 0.82 * t + flare)});
        lean += 0.35 * random.in_disk();
        lean *= 0.8;
        p += height / (kPoints - 1) * glm::dvec3(0.28 * lean.x, 1.05, 0.28 * lean.y);
    }
    const glm::dvec3 wood = bark.color;
    bark.uv_scale = {2.0, 5.0};
    bark.tube(line, 12, 20, [&](double u, double v, glm::dvec3) {
        const double moss =
            glm::smoothstep(0.45, 0.8, fractal_noise({5.0 * u, 9.0 * v}, 2) + 0.35 * std::exp(-6.0 * v));
        const double dark_foot = 0.55 + 0.45 * glm::smoothstep(0.0, 0.2, v);
        return dark_foot * glm::mix(wood, glm::dvec3(0.09, 0.13, 0.03), 0.75 * moss);
    });
    bark.uv_scale = glm::dvec2(1.0);
}

void add_branch(MeshBuilder& bark, MeshBuilder& foliage, Random& random, const BranchStyle& style,
                const Palette& palette) {
    std::vector<TubePoint> stem;
    for (int i = 0; i < 5; ++i) {
        const double t = i / 4.0;
        const glm::dvec2 crook = 0.09 * t * random.in_disk();
        stem.push_back({{crook.x, t, crook.y - 0.12 * t * t}, style.thickness * (1.0 - 0.9 * t)});
    }
    bark.tube(stem, 6, 8);

    std::vector<std::vector<TubePoint>> twigs{stem};
    for (int k = 0; k < style.twigs; ++k) {
        const double start = random.range(0.25, 0.92);
        const TubePoint from = along(stem, start);
        const double a = 2.4 * k + random.around(0.0, 0.5);
        const glm::dvec3 out = glm::normalize(glm::dvec3(std::cos(a), random.range(0.4, 0.9), std::sin(a)));
        const double length = random.range(0.3, 0.5) * (1.15 - 0.4 * start);
        const glm::dvec2 crook = 0.08 * random.in_disk();
        const glm::dvec3 sag{crook.x, 0.0, crook.y};
        twigs.push_back({{from.p, 0.6 * from.radius},
                         {from.p + 0.5 * length * out + sag, 0.4 * from.radius},
                         {from.p + length * out - glm::dvec3(0.0, 0.04, 0.0), 0.1 * from.radius}});
        bark.tube(twigs.back(), 4, 3);
    }

    for (int k = 0; k < style.leaves; ++k) {
        const auto& twig = twigs[k % 5 == 0 ? 0 : std::size_t(1 + random.below(style.twigs))];
        const double t = (k % 5 == 0 ? 0.35 : 0.2) + (k % 5 == 0 ? 0.65 : 0.8) * std::sqrt(random.uniform());
        const TubePoint from = along(twig, t);
        const glm::dvec3 away = random.direction();
        const glm::dvec3 tip = random.direction();
        Blade leaf;
        leaf.base = from.p + 0.03 * away;
        leaf.axis = away + glm::dvec3(0.0, 0.15, 0.0);
        leaf.face = glm::dvec3(0.0, 1.0, 0.0) + 0.8 * tip;
        leaf.length = style.leaf_length * random.range(0.7, 1.2);
        leaf.width = style.leaf_width * random.range(0.8, 1.2);
        leaf.bend = random.range(0.2, 0.9);
        leaf.fold = random.range(0.15, 0.45);
        leaf.segments = 2;
        // Leaves deep in the crown get less sky: darker there. This stands in for ambient occlusion.
        const double open = glm::smoothstep(0.0, 0.45, glm::length(leaf.base - glm::dvec3(0.0, 0.55, 0.0)));
        const glm::dvec3 color = palette.pick(random) * (0.45 + 0.55 * open);
        foliage.blade(leaf, [&](double, double v, glm::dvec3) { return color * (0.75 + 0.35 * v); });
    }
}

void add_distant_tree(MeshBuilder& bark, MeshBuilder& foliage, Random& random, const DistantTreeStyle& style,
                      const Palette& palette) {
    bark.color = {0.12, 0.085, 0.06};
    bark.tube(style.trunk, style.trunk_around, style.trunk_along);
    const double middle_light = 0.5 * (1.0 + style.low_light);
    for (int k = 0; k < style.leaves; ++k) {
        const glm::dvec3 d = random.direction();
        const double r = std::cbrt(random.uniform());
        Blade leaf;
        leaf.base = glm::dvec3(0.0, style.crown_height, 0.0) + r * d * style.crown_radii;
        leaf.axis = random.direction() + 0.5 * d;
        leaf.face = glm::dvec3(0.0, 0.8, 0.0) + d;
        leaf.length = random.range(style.shortest_leaf, style.longest_leaf);
        leaf.width = style.leaf_width * leaf.length;
        leaf.bend = 0.6;
        leaf.fold = 0.3;
        const glm::dvec3 color = palette.pick(random) * (style.inner_light + (1.0 - style.inner_light) * r) *
                                 (middle_light + (1.0 - middle_light) * d.y);
        foliage.blade(leaf, [&](double, double v, glm::dvec3) { return color * (0.8 + 0.3 * v); });
    }
}

void add_grass_tuft(MeshBuilder& grass, Random& random, int blades, double height, const Palette& palette) {
    for (int k = 0; k < blades; ++k) {
        const glm::dvec2 foot = 0.28 * height * random.in_disk();
        const double a = random.angle();
        Blade blade;
        blade.base = {foot.x, -0.02 * height, foot.y};
        blade.axis = glm::dvec3(0.35 * std::cos(a), 1.0, 0.35 * std::sin(a));
        blade.face = glm::dvec3(-std::cos(a), 0.3, -std::sin(a));
        blade.length = height * random.range(0.55, 1.15);
        blade.width = height * random.range(0.028, 0.05);
        blade.bend = random.range(0.3, 1.5);
        blade.fold = 0.3;
        blade.widest = 0.25;
        blade.segments = 3;
        const glm::dvec3 color = palette.pick(random);
        grass.blade(blade, [&](double, double v, glm::dvec3) { return color * (0.25 + 0.9 * v); });
    }
}

void add_mushroom(MeshBuilder& mushroom, Random& random, const MushroomStyle& s) {
    const glm::dvec2 lean = 0.12 * s.height * random.in_disk();
    const double top = s.height - 0.4 * s.cap_height;
    const std::vector<TubePoint> stem{{{0.0, -0.1 * s.height, 0.0}, 1.5 * s.stem_radius},
                                      {{0.3 * lean.x, 0.15 * s.height, 0.3 * lean.y}, 1.25 * s.stem_radius},
                                      {{0.8 * lean.x, 0.55 * s.height, 0.8 * lean.y}, 0.9 * s.stem_radius},
                                      {{lean.x, top + 0.3 * s.cap_height, lean.y}, 0.95 * s.stem_radius}};
    mushroom.tube(stem, s.detail / 2 + 4, s.detail / 2,
                  [&](double, double v, glm::dvec3) { return s.stem * (0.4 + 0.6 * glm::smoothstep(0.0, 0.5, v)); });

    const glm::dmat4 before = mushroom.transform;
    const double tilt = 1.4 * glm::length(lean) / s.height;
    mushroom.transform = before * glm::translate(glm::dmat4(1.0), glm::dvec3(lean.x, top, lean.y)) *
                         glm::mat4_cast(turn({lean.y + 1e-9, 0.0, -lean.x}, tilt));
    const double r = s.cap_radius, h = s.cap_height;
    const std::vector<glm::dvec2> dome{{0.9 * r, -0.1 * h}, {1.0 * r, 0.02 * h},  {0.93 * r, 0.3 * h},
                                       {0.7 * r, 0.66 * h}, {0.38 * r, 0.92 * h}, {0.0, 1.0 * h}};
    mushroom.lathe(dome, 2 * s.detail, s.detail, [&](double, double v, glm::dvec3) {
        return s.cap * (0.55 + 0.45 * glm::smoothstep(0.0, 0.6, v)) + 0.12 * s.cap * glm::smoothstep(0.75, 1.0, v);
    });
    const std::vector<glm::dvec2> under{{0.7 * s.stem_radius, 0.25 * h}, {0.5 * r, 0.12 * h}, {0.9 * r, -0.1 * h}};
    mushroom.lathe(under, 2 * s.detail, 4, [&](double u, double v, glm::dvec3) {
        const double gill = 0.75 + 0.25 * std::cos(6.283185307179586 * s.detail * u);
        return s.gills * gill * (0.35 + 0.65 * v);
    });
    for (int k = 0; k < s.dots; ++k) {
        const double a = 2.399963 * k, t = 0.12 + 0.8 * std::sqrt((k + 0.5) / s.dots);
        std::vector<TubePoint> line;
        for (const glm::dvec2& q : dome) line.push_back({{q.x, q.y, 0.0}, 0.0});
        const glm::dvec3 q = along(line, 1.0 - 0.8 * t).p;
        const double size = r * random.range(0.06, 0.12);
        const glm::dvec3 at{q.x * std::sin(a), q.y, q.x * std::cos(a)};
        mushroom.ellipsoid(at, {size, 0.55 * size, size}, 8, 5,
                           [](double, double, glm::dvec3) { return glm::dvec3(0.8, 0.74, 0.62); });
    }
    mushroom.transform = before;
}

void add_flower(MeshBuilder& flower, Random& random, const FlowerStyle& s) {
    const glm::dvec2 lean = 0.25 * s.height * random.in_disk();
    const glm::dvec3 head{lean.x, s.height, lean.y};
    const std::vector<TubePoint> stem{{{0.0, -0.05 * s.height, 0.0}, 0.012 * s.height},
                                      {{0.25 * lean.x, 0.5 * s.height, 0.25 * lean.y}, 0.011 * s.height},
                                      {head, 0.009 * s.height}};
    flower.tube(stem, 5, 7, [&](double, double v, glm::dvec3) { return s.stem * (0.4 + 0.7 * v); });
    for (int k = 0; k < 2; ++k) {
        const double a = random.angle();
        const glm::dvec3 out{std::cos(a), 0.0, std::sin(a)};
        const Blade leaf{along(stem, 0.12 + 0.15 * k).p,
                         out + glm::dvec3(0.0, 0.9, 0.0),
                         glm::dvec3(0.0, 1.0, 0.0) - 0.5 * out,
                         0.42 * s.height,
                         0.09 * s.height,
                         0.9,
                         0.35,
                         0.5,
                         4};
        flower.blade(leaf, [&](double, double v, glm::dvec3) { return s.stem * (0.6 + 0.7 * v); });
    }
    const glm::dvec3 up = glm::normalize(glm::dvec3(2.0 * lean.x, s.height, 2.0 * lean.y));
    const Frame frame = frame_around(up);
    const double turn_by = random.angle();
    for (int k = 0; k < s.petals; ++k) {
        const double a = turn_by + 6.283185307179586 * k / s.petals;
        const glm::dvec3 out = std::cos(a) * frame.side + std::sin(a) * frame.up;
        const double cup = s.cup + random.around(0.0, 0.12);
        const Blade petal{head + 0.12 * s.petal_length * out,
                          std::cos(cup) * out + std::sin(cup) * up,
                          std::cos(cup) * up - std::sin(cup) * out,
                          s.petal_length,
                          s.petal_width,
                          0.5,
                          0.15,
                          0.6,
                          4};
        flower.blade(petal, [&](double, double v, glm::dvec3) { return glm::mix(s.petal, s.petal_tip, v); });
    }
    flower.ellipsoid(head + 0.05 * s.petal_length * up, glm::dvec3(0.24 * s.petal_length), 9, 6,
                     [&](double, double v, glm::dvec3) { return s.centre * (0.6 + 0.5 * v); });
}

void add_fern(MeshBuilder& fern, Random& random, int fronds, double length, const Palette& palette) {
    for (int k = 0; k < fronds; ++k) {
        const double a = 6.283185307179586 * (k + random.uniform()) / fronds;
        const glm::dvec3 out{std::cos(a), 0.0, std::sin(a)};
        const glm::dvec3 across{-out.z, 0.0, out.x};
        const double size = length * random.range(0.75, 1.1);
        const std::vector<TubePoint> rib{{glm::dvec3(0.0), 0.009 * size},
                                         {size * (0.25 * out + glm::dvec3(0.0, 0.42, 0.0)), 0.008 * size},
                                         {size * (0.62 * out + glm::dvec3(0.0, 0.6, 0.0)), 0.006 * size},
                                         {size * (0.98 * out + glm::dvec3(0.0, 0.48, 0.0)), 0.002 * size}};
        const glm::dvec3 color = palette.pick(random);
        fern.tube(rib, 4, 8, [&](double, double v, glm::dvec3) { return color * (0.3 + 0.5 * v); });
        constexpr int kPairs = 15;
        for (int i = 0; i < kPairs; ++i) {
            const double t = 0.16 + 0.83 * i / (kPairs - 1.0);
            const glm::dvec3 forward = glm::normalize(along(rib, t + 0.01).p - along(rib, t - 0.01).p);
            for (const double sign : {1.0, -1.0}) {
                const glm::dvec3 up =
                    glm::normalize(glm::cross(across, forward) * (glm::cross(across, forward).y < 0.0 ? -1.0 : 1.0));
                const Blade leaflet{
                    along(rib, t).p,
                    sign * across + 0.55 * forward,
                    up,
                    0.3 * size * std::sin(2.6 * (1.06 - t)) * (0.35 + 0.65 * glm::smoothstep(0.0, 0.4, t)),
                    0.055 * size,
                    0.5,
                    0.25,
                    0.35,
                    3};
                const double shade = random.range(0.75, 1.1);
                fern.blade(leaflet, [&](double, double v, glm::dvec3) { return color * shade * (0.7 + 0.45 * v); });
            }
        }
    }
}

}  // namespace pentaprism::builtin
