#pragma once
// How far away the samples of a cell see anything so far, by square and part of the shutter: the hierarchical depth of
// tests that refuse what is hidden (Greene, Kass, Miller 1993, Hierarchical Z-Buffer Visibility; in parts of the
// shutter after Akenine-Moller, Munkberg, Hasselgren 2007, Stochastic Rasterization using Time-Continuous Triangles).

#include <algorithm>
#include <cmath>
#include <limits>

#include "sample/sample_table.h"

namespace pentaprism {

class Occluders {
  public:
    static constexpr int kTimes = 4;  ///< equal parts of the shutter

    static int time_of(float t) { return std::clamp(static_cast<int>(t * kTimes), 0, kTimes - 1); }

    Occluders() { std::fill(&depth_[0][0], &depth_[0][0] + kTimes * kSquares, std::numeric_limits<float>::infinity()); }

    /// No sample of the square of blocks [bx, bx + size) x [by, by + size), counted from the cell's lower left corner,
    /// with t in [t0, t1] sees anything farther away. `size` is a power of two, bx and by multiples of it.
    float farthest(int bx, int by, int size, float t0, float t1) const {
        float depth = 0.0f;
        for (int time = time_of(t0); time <= time_of(t1); ++time)
            depth = std::max(depth, depth_[time][at(bx, by, size)]);
        return depth;
    }

    /// Of one block; 0 where no sample counts. Then finish().
    void set(int bx, int by, int time, float depth) { depth_[time][at(bx, by, 1)] = depth; }

    /// From the blocks to the larger squares.
    void finish() {
        for (auto& depth : depth_)
            for (int size = 2; size <= kCellBlocks; size *= 2)
                for (int by = 0; by < kCellBlocks; by += size)
                    for (int bx = 0; bx < kCellBlocks; bx += size) {
                        const int half = size / 2;
                        depth[at(bx, by, size)] =
                            std::max({depth[at(bx, by, half)], depth[at(bx + half, by, half)],
                                      depth[at(bx, by + half, half)], depth[at(bx + half, by + half, half)]});
                    }
    }

  private:
    static constexpr int kSquares = 64 + 16 + 4 + 1;  // blocks first, the cell last
    static int at(int bx, int by, int size) {
        int first = 0;
        for (int smaller = 1; smaller < size; smaller *= 2) first += kBlocksPerCell / (smaller * smaller);
        return first + by / size * (kCellBlocks / size) + bx / size;
    }

    float depth_[kTimes][kSquares];
};

}  // namespace pentaprism
