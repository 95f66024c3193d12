#pragma once
// A triangle that may lie in shadow, in the view of one light.

#include <cstddef>
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
    /// The corners in the light's view, [knot][corner][x, y, z].
    const float* knots() const { return knots_.data(); }
    /// Of a path in pieces: coordinate 3 * corner + axis at all knots, and at the borders of the quarters of the
    /// shutter. kReadable floats may be read of each.
    static constexpr int kReadable = 16;
    const float* at_knots(int coordinate) const { return &at_knots_[coordinate * knots_stride_]; }
    const float* at_borders(int coordinate) const { return at_borders_[coordinate]; }

    /// Cell (key % 65536, key / 65536) of a level, with what casts up to a limit.
    struct Cell {
        const float* depths = nullptr;
        const std::int32_t* samples = nullptr;  ///< ShadowSamples::words()
    };
    const Cell& cell(int exponent, int limit, std::int32_t key) {
        if (key != key_ || exponent != exponent_ || limit != limit_) {
            const int x = key & 0xffff, y = key >> 16;
            cell_ = {map_->depths(exponent, limit, x, y), map_->samples().words(x, y)};
            key_ = key, exponent_ = exponent, limit_ = limit;
        }
        return cell_;
    }

  private:
    const ShadowMap* map_ = nullptr;
    Path path_ = Path::kStill;
    int segments_ = 1;
    std::vector<float> knots_, at_knots_;  // the same, by knot and by coordinate
    std::size_t knots_stride_ = 0;
    float at_borders_[9][kReadable] = {};
    int exponent_ = 0, limit_ = 0;
    std::int32_t key_ = -1;
    Cell cell_;
};

}  // namespace pentaprism
