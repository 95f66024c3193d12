#pragma once
// How much of a light reaches points of a triangle: sixteen samples of the light's shadow map for each, four in each
// quarter of the shutter.
//
// The point is put where it is at the map sample's own time, and its depth is taken on its own plane at the map
// sample's own place, so that a surface does not shadow itself and no bias has to hide that.

#include <cstdint>
#include <glm/vec3.hpp>

#include "shade/shadow_receiver.h"

namespace pentaprism {

/// A shaded point that asks for light. Lane 4 * q + i: the i-th of its map samples in quarter q of the shutter.
struct ShadowPoint {
    static constexpr int kLanes = 4 * ShadowMap::kSamples;
    alignas(64) float barycentrics[3][kLanes];  ///< of the material point that each map sample stands for
    std::uint32_t quarters = 0;                 ///< bit q: quarter q is asked for
    glm::vec3 position{0.0f};                   ///< at mid-shutter, in the world motion's space
    glm::vec3 offset{0.0f};                     ///< added to where the triangle is, metres
    float texel = 0.0f;                         ///< the size that a texel of the map should have there, metres
};

/// Bit for each lane of the point: light arrives, or its quarter is not asked for. `seed` moves the map samples within
/// their quarters of a texel's square around the point. A pure function of its arguments.
using ShadowLookup = std::uint32_t (*)(ShadowReceiver& receiver, const ShadowPoint& point, std::uint32_t seed);

/// For the CPU target in use (base/cpu.h); the same bits on all.
ShadowLookup shadow_lookup();

}  // namespace pentaprism
