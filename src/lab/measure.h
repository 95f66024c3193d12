#pragma once
// Every method on one frame: counted once, timed in turn.

#include "lab/walk.h"
#include "peer/posed_picture.h"

namespace pentaprism {

struct MeasureOptions {
    std::vector<std::string> methods;
    MethodSettings method;  ///< visibility and culling are set for each method
    std::int64_t most_tests = 0;
    int runs = 5;
    double seconds = 4.0;
};

/// Rows in the order of `methods`. Whole but for scene and effect.
struct Measurements {
    std::vector<BenchRow> rows;
    BenchCell cell;
};

Measurements measure_methods(const PosedPicture& picture, const MeasureOptions& options, const KeepGoing& keep_going);

}  // namespace pentaprism
