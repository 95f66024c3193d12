#pragma once
// Sixteen samples side by side, and the strata of lens and shutter that vectors of them lie in.

#include <algorithm>
#include <cstdint>

#include "sample/block_pattern.h"

namespace pentaprism {

inline constexpr int kCellSize = 32;                        ///< pixels a side of a cell of the exact test's grid
inline constexpr int kCellBlocks = kCellSize / kBlockSize;  ///< blocks a side of a cell
inline constexpr int kBlocksPerCell = kCellBlocks * kCellBlocks;

/// Sixteen samples, lane = 4 * (row in the block) + column unless an arrangement says otherwise. (x, y) is the offset
/// in pixels from the middle of the sample's cell, y UP, both in [-16, 16]: what the exact test calls (hx, hy).
struct alignas(64) SampleVector {
    float x[kLanes], y[kLanes], u[kLanes], v[kLanes], t[kLanes];
};

/// Closed ranges of the lens and the shutter.
struct Domain {
    float u0, u1, v0, v1, t0, t1;
    static constexpr Domain empty() { return {2, -2, 1e30f, -1e30f, 2, -2}; }
    void extend(const Domain& other) {
        u0 = std::min(u0, other.u0);
        u1 = std::max(u1, other.u1);
        v0 = std::min(v0, other.v0);
        v1 = std::max(v1, other.v1);
        t0 = std::min(t0, other.t0);
        t1 = std::max(t1, other.t1);
    }
};

/// The vectors of a cell by stratum of (u, v, t): slot `slot` of the blocks in `blocks` (bit 8 * row + column) lies in
/// `stratum`.
struct Stratum {
    std::uint16_t slot, stratum;
    std::uint64_t blocks;
};

inline constexpr int kMaxStrata = 64;

}  // namespace pentaprism
