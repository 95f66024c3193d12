#pragma once
// How much of a light reaches points of a triangle: sixteen samples of the light's shadow map for each, four in each
// quarter of the shutter.
//
// The point is put where it is at the map sample's own time, and its depth is taken on its own plane at the map
// sample's own place, so that a surface does not shadow itself and no bias has to hide that.

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "shade/shadow_map.h"
#include "shade/world_motion.h"

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

/// One triangle as one light sees it over the shutter; keeps the cell of the map that was asked last.
class ShadowReceiver {
  public:
    /// All three must outlive what is asked.
    void start(const WorldMotion& world, std::uint32_t triangle, const ShadowMap& map);

    /// Still; straight on; or in pieces, one for each motion segment.
    enum class Path : std::uint8_t { kStill, kStraight, kInPieces };
    Path path() const { return path_; }
    int segments() const { return segments_; }
    const ShadowMap& map() const { return *map_; }
    /// The corners in the light's view, [knot][corner][x, y, z]: at the knots, and at the borders of the quarters.
    const float* knots() const { return knots_.data(); }
    const float* borders() const { return borders_.data(); }

    /// Cell (key % 65536, key / 65536) of a level, with what casts up to a limit.
    struct Cell {
        const float* depths = nullptr;
        const ShadowSamples::Cell* samples = nullptr;
    };
    const Cell& cell(int exponent, int limit, std::int32_t key) {
        if (key != key_ || exponent != exponent_ || limit != limit_) {
            const int x = key & 0xffff, y = key >> 16;
            cell_ = {map_->depths(exponent, limit, x, y), &map_->samples(x, y)};
            key_ = key, exponent_ = exponent, limit_ = limit;
        }
        return cell_;
    }

  private:
    const ShadowMap* map_ = nullptr;
    Path path_ = Path::kStill;
    int segments_ = 1;
    std::vector<float> knots_;
    std::array<float, 9 * (ShadowMap::kSamples + 1)> borders_;
    int exponent_ = 0, limit_ = 0;
    std::int32_t key_ = -1;
    Cell cell_;
};

/// Bit for each lane of the point: light arrives, or its quarter is not asked for. `seed` moves the map samples within
/// their quarters of a texel's square around the point. A pure function of its arguments.
using ShadowLookup = std::uint32_t (*)(ShadowReceiver& receiver, const ShadowPoint& point, std::uint32_t seed);

/// For the CPU target in use (base/cpu.h); the same bits on all.
ShadowLookup shadow_lookup();

}  // namespace pentaprism
