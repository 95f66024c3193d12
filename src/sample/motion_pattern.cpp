#include "sample/motion_pattern.h"

#include <bit>

#include "sample/net.h"
#include "sample/pixel_pattern.h"

namespace pentaprism {
namespace {

constexpr int kBlockBits = 2;  // of a coordinate: which column or row of the block
constexpr int kLaneBits = 2 * kBlockBits;
static_assert(kBlockSize == 1 << kBlockBits);

}  // namespace

MotionPattern::MotionPattern(int spp, std::uint32_t seed, int bx, int by)
    : bits_(std::bit_width(static_cast<unsigned>(spp) * kLanes - 1)),
      block_(mix(mix(mix(seed + 17u) + static_cast<std::uint32_t>(bx)) + static_cast<std::uint32_t>(by))) {}

// Places are shifted digitally, the same for the whole block, which leaves the points as even among themselves as they
// are; scrambling them (Owen) costs some of that (docs/develop/sample-layout.md). What the net leaves open is random.
// Times are scrambled within the interval.
std::array<MotionPattern::Place, kLanes> MotionPattern::in_stratum(std::uint32_t stratum) const {
    std::array<Place, kLanes> places{};
    const std::uint32_t order = mix(block_ + 5u + 0x9e3779b9u * stratum);
    for (std::uint32_t i = 0; i < kLanes; ++i) {
        const std::uint32_t number = stratum << kLaneBits | i;
        const std::uint32_t random = mix(block_ + 9u + 0x85ebca6bu * number);
        const std::uint32_t x = sobol(number, 0) ^ mix(block_ + 1u) ^ mix(random + 1u) >> bits_;
        const std::uint32_t y = sobol(number, 1) ^ mix(block_ + 2u) ^ mix(random + 2u) >> bits_;
        const std::uint32_t lane = y >> (32 - kBlockBits) << kBlockBits | x >> (32 - kBlockBits);
        const std::uint32_t sixteenth = owen_scramble(i << (32 - kLaneBits), order) >> (32 - kLaneBits);
        places[lane] = {x << kBlockBits, y << kBlockBits, sixteenth << (24 - kLaneBits) | random >> (8 + kLaneBits)};
    }
    return places;
}

}  // namespace pentaprism
