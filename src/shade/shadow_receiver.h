#pragma once
// A triangle that may lie in shadow, in the view of one light.

#include <array>
#include <cstdint>
#include <vector>

#include "shade/shadow_map.h"
#include "shade/world_motion.h"

namespace pentaprism {

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
        const std::int32_t* samples = nullptr;  ///< ShadowSamples::words()
    };
    const Cell& cell(int exponent, int limit, std::int32_t key) {
        if (key != key_ || exponent != exponent_ || limit != limit_) {
            const int x = key & 0xffff, y = key >> 16;
            cell_ = {map_->depths(exponent, limit, x, y), map_->samples(x, y)};
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

}  // namespace pentaprism
