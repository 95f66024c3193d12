#pragma once
// The shadow maps of a frame's lights: one for the sun, one for a narrow spot, six for a light that shines all around:
// of these, those on which no point lies cost nothing.

#include <memory>
#include <span>
#include <vector>

#include "shade/lights.h"
#include "shade/shadow_lookup.h"

namespace pentaprism {

class Shadows {
  public:
    /// Positions of lights are relative to `eye`. `frame` must outlive this.
    Shadows(const Frame& frame, const Lighting& lighting, const glm::dvec3& eye, ShadowMode mode);

    bool any() const { return any_; }
    bool casts(std::size_t light) const { return !maps_[light].faces.empty(); }

    /// Whether shadows or what they fall on may change while the shutter is open.
    bool move() const { return world_.moves; }

    /// For those who look them up themselves; of the second one only if any().
    const WorldMotion& world() const { return world_; }
    const ShadowSamples& samples() const { return *samples_; }
    /// Of a light: none, one map, or six: +x -x +y -y +z -z.
    std::span<const std::unique_ptr<ShadowMap>> faces(std::size_t light) const { return maps_[light].faces; }

    /// Whoever looks up shadows does so during a visit.
    ShadowCellStore& store() const { return *store_; }

    /// Cells of all maps rendered so far; a cell that two threads needed at once, or that was forgotten, counts again.
    std::int64_t cells_rendered() const;

  private:
    struct LightMaps {
        glm::dmat3 axes{1.0};
        glm::vec3 position{0.0f};
        std::vector<std::unique_ptr<ShadowMap>> faces;  // none: no shadows; 1, or 6: +x -x +y -y +z -z of the axes
        std::size_t first = 0;                          // number of the first one among all lights'
    };
    friend class ShadowsOnTriangle;
    WorldMotion world_;
    std::unique_ptr<ShadowSamples> samples_;
    std::unique_ptr<ShadowCellStore> store_;
    std::vector<LightMaps> maps_;
    std::size_t map_count_ = 0;
    ShadowLookup lookup_ = nullptr;
    bool any_ = false;
};

/// The shadows on one triangle's points. One for each thread: keeps its memory.
class ShadowsOnTriangle {
  public:
    void start(const Shadows& shadows, std::uint32_t triangle);

    /// As ShadowLookup, for a light that casts shadows.
    std::uint32_t lit(std::size_t light, const ShadowPoint& point, std::uint32_t seed);

  private:
    struct Receiver {
        std::uint64_t started = 0;
        ShadowReceiver receiver;
    };
    const Shadows* shadows_ = nullptr;
    std::uint32_t triangle_ = 0;
    std::uint64_t starts_ = 0;
    std::vector<Receiver> receivers_;  // of each map; set up when asked
};

}  // namespace pentaprism
