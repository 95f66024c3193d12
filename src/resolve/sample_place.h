#pragma once
// Where a sample lies in its pixel.

#include "sample/sample_table.h"

namespace pentaprism {

/// From the top left corner of the pixel, 1/256 pixel: exact.
struct PlaceInPixel {
    int x, y;
};

inline PlaceInPixel place_in_pixel(const SampleVector& vector, int lane) {
    // Pixels lie at whole numbers from the middle of their cell.
    return {static_cast<int>(vector.x[lane] * 256.0f) & 255, static_cast<int>(-vector.y[lane] * 256.0f) & 255};
}

}  // namespace pentaprism
