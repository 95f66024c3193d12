#pragma once
// Where a sample lies: in its pixel, and in a tile's Hits.

#include "cover/hits.h"

namespace pentaprism {

/// From the top left corner of the pixel, 1/256 pixel: exact.
struct PlaceInPixel {
    int x, y;
};

inline PlaceInPixel place_in_pixel(const SampleVector& vector, int lane) {
    // Pixels lie at whole numbers from the middle of their cell.
    return {static_cast<int>(vector.x[lane] * 256.0f) & 255, static_cast<int>(-vector.y[lane] * 256.0f) & 255};
}

/// Of a sample of block (bx, by) of the picture.
inline std::size_t place_in_hits(int bx, int by, int slot, int lane, int slots) {
    const int block = by % kCellBlocks * kCellBlocks + bx % kCellBlocks;
    return (static_cast<std::size_t>(block) * slots + slot) * kLanes + lane;
}

}  // namespace pentaprism
