#pragma once
// Embree's ray tracer on the frame and its samples: what `--visibility raytrace` renders with, and the independent
// answer that `verify` compares with.
//
// A sample's line of sight is straight in raster clip space (x, y, w), and motion there is linear between knots, which
// is what Embree's motion blur interpolates: so Embree is given the frame's own points, and its ray parameter is the
// depth.

#include <cstdint>
#include <memory>
#include <string>

#include "trace/tracer.h"

namespace pentaprism {

/// How Embree is set up. The defaults are those of make_tracer(), for pictures and for verification.
struct EmbreeOptions {
    /// Embree's fastest: no robust mode, back faces of one-sided surfaces are hit, too (refusing them would cost Embree
    /// a callback for each hit), and masks are asked at Embree's own barycentrics.
    bool for_speed = false;
    bool fast_build = false;  ///< Embree's low build quality
    std::string device;       ///< configuration string, such as "tri_accel_mb=bvh8.triangle4vmb"
};

class EmbreeTracer : public Tracer {
  public:
    /// Builds Embree's scene from the frame; the frame and the table must outlive this. Throws Error(kBackend) when
    /// Embree refuses, such as beyond 128 motion segments.
    EmbreeTracer(const Frame& frame, const SampleTable& table, const EmbreeOptions& options);
    ~EmbreeTracer() override;
    EmbreeTracer(const EmbreeTracer&) = delete;
    EmbreeTracer& operator=(const EmbreeTracer&) = delete;

    /// A packet of 16 rays for each vector of the sample table.
    void trace(const Tile& tile, Hits& hits) const override;

  private:
    class Impl;
    std::unique_ptr<Impl> impl_;
};

/// "embree 3.13.5".
std::string embree_version();

}  // namespace pentaprism
