#pragma once
// Visibility by tracing rays: the same frame and the same samples as the coverage stage, another way to the same Hits.
// Embree does the work (trace/embree_tracer.h); a build may be without it.

#include <memory>
#include <string>

#include "cover/hits.h"
#include "frame/frame.h"
#include "sample/sample_table.h"

namespace pentaprism {

class Tracer {
  public:
    virtual ~Tracer() = default;

    /// The nearest triangle and the depth of every sample of the tile. `hits` has been reset. Thread-safe.
    virtual void trace(const Tile& tile, Hits& hits) const = 0;
};

/// The frame and the table must outlive it. Throws Error(kBackend) in a build without Embree, and for a frame that
/// Embree cannot take.
std::unique_ptr<const Tracer> make_tracer(const Frame& frame, const SampleTable& table);

/// "embree VERSION"; empty in a build without it.
std::string tracer_name();

}  // namespace pentaprism
