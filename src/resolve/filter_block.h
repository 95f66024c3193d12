#pragma once
// The filter's sums of a block's sixteen pixels at once: the innermost loop of a picture's film.

#include <cstdint>

#include "base/float4.h"
#include "sample/sample_table.h"

namespace pentaprism {

/// Of each pixel of a block: what its samples add to the up to 3x3 pixels that they reach. [row][column] of the pixel
/// reached, then red, green, blue, alpha, weight.
struct BlockSums {
    static constexpr int kSums = 5;
    alignas(64) std::int64_t fixed[3][3][kSums][kLanes];  ///< multiples of 2^-32
    alignas(64) float depth[kLanes];                      ///< the closest sample
};

/// A block's samples in the order of the table's slots, and what they show.
struct BlockSamples {
    const SampleVector* vectors;  ///< of each slot
    const std::uint32_t* points;  ///< of each slot and lane, as in TileShade
    const float* depths;          ///< the same, as in Hits
    int slots;
    const Float4* shown;       ///< of each point: red, green, blue, alpha
    std::uint32_t background;  ///< the entry of `shown` for what hits nothing; no entry lies beyond it
    const Float4* weights;     ///< of a sample at offset / 256 of a pixel, for its neighbours -1, 0 and 1
    double share;              ///< factor of all sums
};

/// The same bits on every CPU target.
using FilterBlock = void (*)(const BlockSamples& samples, BlockSums& out);
FilterBlock filter_block();

}  // namespace pentaprism
