#pragma once
// What stands and moves around the suspension bridge of bridge.cpp, and the measures that all of it shares.

#include <vector>

#include "scene/builtin/assembly.h"
#include "scene/builtin/mesh_builder.h"
#include "scene/builtin/recipes.h"

namespace pentaprism::builtin {

constexpr double kTwoPi = 6.283185307179586;

// Lengths are those of the big original, in metres.
constexpr double kDeck = 60.0;    ///< height of the road over the water; the bridge runs along x
constexpr double kPlace = 105.0;  ///< where the bus is after a second
constexpr double kBus = 42.0;     ///< metres per second; models are always a little fast

inline Transform placed(glm::dvec3 p, double yaw = 0.0, double scale = 1.0) {
    return {p, turn({0.0, 1.0, 0.0}, yaw), glm::dvec3(scale)};
}

/// A body between cross-sections, superellipses of the given fullness; x forward, y up (bridge_traffic.cpp).
struct Section {
    double x, half, bottom, top;
};
void loft(MeshBuilder& m, const std::vector<Section>& sections, double fullness, int around, int along_count);

/// Cars and trucks in six lanes, the bus among them, two trains below (bridge_traffic.cpp).
void add_traffic(Assembly& scene, Index root);

/// Land with its shores and an island, water, boats, trees and a city (bridge_shore.cpp).
void add_shore(Assembly& scene, Index root);

}  // namespace pentaprism::builtin
