#pragma once
// The independent tracer of whole pictures, if this build has one.

#include <string>

#include "peer/compare_tracers.h"

namespace pentaprism {

struct Reference {
    std::string name;   ///< "embree VERSION"; empty without one
    TileTracer tracer;  ///< empty without one
};

/// The frame and the table must outlive it. Without Embree in this build, or for a frame that Embree cannot take, both
/// are empty: brute force remains.
Reference make_reference(const Frame& frame, const SampleTable& table);

}  // namespace pentaprism
