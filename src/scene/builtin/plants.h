#pragma once
// What grows in the built-in scenes. Each function appends one plant that stands at the origin and grows along +y.

#include "scene/builtin/mesh_builder.h"
#include "scene/builtin/random.h"

namespace pentaprism::builtin {

/// Colours from one end to the other; plants take random ones in between.
struct Palette {
    glm::dvec3 dark, light;
    glm::dvec3 accent;  ///< now and then instead
    double accent_share = 0.0;
    glm::dvec3 pick(Random& random) const;
};

/// A tapering, crooked trunk with flared roots.
void add_trunk(MeshBuilder& bark, Random& random, double height, double radius);

/// A branch about 1 long, with twigs into `bark` and `leaves` blades of four triangles into `foliage`.
struct BranchStyle {
    int twigs = 6, leaves = 160;
    double leaf_length = 0.11, leaf_width = 0.05;
    double thickness = 0.035;
};
void add_branch(MeshBuilder& bark, MeshBuilder& foliage, Random& random, const BranchStyle& style,
                const Palette& palette);

/// A tree to be seen from afar: a trunk into `bark`, an egg-shaped crown of large leaves into `foliage`, whose inner
/// and lower leaves are darker.
struct DistantTreeStyle {
    std::vector<TubePoint> trunk;
    int trunk_around = 8, trunk_along = 8;
    int leaves = 120;
    double crown_height = 4.3;  ///< of the crown's middle
    glm::dvec3 crown_radii{1.9, 2.2, 1.9};
    double shortest_leaf = 0.6, longest_leaf = 1.0;
    double leaf_width = 0.45;  ///< of a leaf's length
    double inner_light = 0.4;  ///< at the crown's middle; 1 at its surface
    double low_light = 0.5;    ///< at the crown's foot; 1 at its top
};
void add_distant_tree(MeshBuilder& bark, MeshBuilder& foliage, Random& random, const DistantTreeStyle& style,
                      const Palette& palette);

void add_grass_tuft(MeshBuilder& grass, Random& random, int blades, double height, const Palette& palette);

struct MushroomStyle {
    double height = 0.08, cap_radius = 0.045, cap_height = 0.03, stem_radius = 0.011;
    glm::dvec3 cap{0.55, 0.03, 0.02}, stem{0.75, 0.68, 0.55}, gills{0.6, 0.5, 0.38};
    int dots = 14;
    int detail = 14;
};
void add_mushroom(MeshBuilder& mushroom, Random& random, const MushroomStyle& style);

struct FlowerStyle {
    double height = 0.1, petal_length = 0.018, petal_width = 0.009;
    int petals = 9;
    double cup = 0.3;  ///< radians that the petals are raised
    glm::dvec3 petal{0.8, 0.75, 0.7}, petal_tip{0.8, 0.8, 0.8}, centre{0.8, 0.45, 0.03}, stem{0.08, 0.2, 0.03};
};
void add_flower(MeshBuilder& flower, Random& random, const FlowerStyle& style);

/// Arching fronds with paired leaflets.
void add_fern(MeshBuilder& fern, Random& random, int fronds, double length, const Palette& palette);

}  // namespace pentaprism::builtin
