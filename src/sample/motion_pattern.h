#pragma once
// The sample pattern where only motion blurs: place and time of the samples of a block of 4 x 4 pixels are one net.
//
// In the order of time they are the points of Sobol's sequence of two dimensions, spread over the block: each run of
// sixteen has one point in each pixel. For 2^m samples a pixel, point and place in the order are a (0, m + 4, 3)-net in
// base 2 (Niederreiter 1992, lemma 4.22): every box of a 2^-(m + 4)th of the block's area times the shutter, cut to
// powers of two in x, y and t, holds one sample. So do, with 2^-m, those of each pixel.

#include <array>
#include <cstdint>

#include "sample/block_pattern.h"

namespace pentaprism {

class MotionPattern {
  public:
    MotionPattern(int spp, std::uint32_t seed, int bx, int by);

    struct Place {
        std::uint32_t x, y;  ///< as RawSample has them
        std::uint32_t jitter_t;
    };
    /// Of the samples in one of the equal intervals of the shutter, by lane.
    std::array<Place, kLanes> in_stratum(std::uint32_t stratum) const;

  private:
    int bits_;  // of a coordinate, that the net sets
    std::uint32_t block_;
};

}  // namespace pentaprism
