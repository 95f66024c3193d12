#pragma once
// The default sample pattern: nets over pixels and blocks of 4 x 4 (sample/net.h), whose vectors are close in lens and
// time.

#include <cstdint>
#include <vector>

namespace pentaprism {

inline constexpr int kBlockSize = 4;                    ///< pixels a side of a block
inline constexpr int kLanes = kBlockSize * kBlockSize;  ///< samples in a vector: one for each pixel of a block

/// 32-bit coordinates of one sample before the map to the lens.
struct RawSample {
    std::uint32_t x, y, u, v;
    std::uint32_t stratum_t;  ///< one of equal intervals of the shutter
    std::uint32_t jitter_t;   ///< within it, 24 bits
};

/// All samples of one block: pure functions of the block's place, the seed, the lane and the index.
class BlockPattern {
  public:
    BlockPattern(int spp, std::uint32_t seed, int bx, int by);

    /// The first base-4 digits of u and v, in the top bits: the same for all lanes.
    std::uint32_t base_u(std::uint32_t index) const;
    std::uint32_t base_v(std::uint32_t index) const;

    /// stratum_t is one of spp.
    RawSample sample(int lane, std::uint32_t index) const;

    /// Slot of each index in lens order: groups of sixteen consecutive indices hold each of the 4x4 lens cells once, so
    /// a whole group is laid out by cell; the remainder of spp / 16 in ascending order of its cells.
    std::vector<std::uint16_t> lens_order() const;

  private:
    int spp_;
    std::uint32_t block_;
};

}  // namespace pentaprism
