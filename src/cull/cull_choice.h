#pragma once
// `--culling` as the user says it: tests and the footprints they are asked at.
//
//     CHOICE    = STEP { "+" STEP }                      improved-dual-space@tile+hyperplane
//     STEP      = TEST [ "@" FOOTPRINT ]                 without a footprint: the test's own
//     FOOTPRINT = "tile" | "pixel" | "bucket"

#include <string>
#include <vector>

#include "cull/cull_test.h"

namespace pentaprism {

/// One test asked at one kind of footprint.
struct CullStep {
    const CullTest* test;
    Grain grain;
};

/// A sample is tested exactly only if every step keeps it. Tiles come first, then pixels, then buckets.
using Culling = std::vector<CullStep>;

/// Throws Error(kUsage) and lists the names there are, for all but `auto`, which is no test (cover/cover_vectors.cpp).
Culling parse_culling(const std::string& choice);

/// "tile", "pixel" or "bucket".
const char* name_of(Grain grain);

/// Never loses a sample: so are all of its tests.
bool is_conservative(const Culling& culling);

}  // namespace pentaprism
