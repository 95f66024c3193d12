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

/// How rays are handed to Embree.
enum class EmbreeRays : std::uint8_t {
    kPacket16,  ///< a vector of the sample table
    kPacket8,
    kPacket4,
    kSingle,
    kStream,         ///< all rays of a block of 4x4 pixels, one by one in memory
    kPacketStream16  ///< the same in packets of sixteen
};

/// What becomes one geometry of Embree.
enum class EmbreeLayout : std::uint8_t {
    kByMotion,  ///< parts with the same number of knots: what stands still stays out of the motion-blur hierarchy
    kTogether,  ///< what stands still joins the largest geometry that moves
    kParts      ///< each part by itself
};

enum class EmbreeBuild : std::uint8_t { kLow, kMedium, kHigh };  ///< Embree's build qualities

/// How Embree is set up. The defaults are those of make_tracer(), for pictures and for verification.
struct EmbreeOptions {
    /// Embree's fastest: no robust mode, back faces of one-sided surfaces are hit, too (refusing them would cost Embree
    /// a callback for each hit), and masks are asked at Embree's own barycentrics.
    bool for_speed = false;
    std::string device;  ///< configuration string, such as "tri_accel_mb=bvh8.triangle4vmb"
    EmbreeBuild build = EmbreeBuild::kMedium;
    EmbreeRays rays = EmbreeRays::kPacket16;
    EmbreeLayout layout = EmbreeLayout::kByMotion;
    bool coherent = true;       ///< tells Embree that rays of a call lie close
    bool dynamic = false;       ///< scene whose geometry is meant to change: refit() works
    bool robust_speed = false;  ///< with `for_speed`: robust mode all the same
};

class EmbreeTracer : public Tracer {
  public:
    /// Builds Embree's scene from the frame; the frame and the table must outlive this. Throws Error(kBackend) when
    /// Embree refuses, such as beyond 128 motion segments.
    EmbreeTracer(const Frame& frame, const SampleTable& table, const EmbreeOptions& options);
    ~EmbreeTracer() override;
    EmbreeTracer(const EmbreeTracer&) = delete;
    EmbreeTracer& operator=(const EmbreeTracer&) = delete;

    /// With `dynamic`: gives Embree all vertices again and has it refit the hierarchy it has instead of building one.
    void refit();

    /// The rays of each vector of the sample table, as EmbreeOptions::rays says.
    void trace(const Tile& tile, Hits& hits) const override;

  private:
    class Impl;
    std::unique_ptr<Impl> impl_;
};

/// "embree 3.13.5".
std::string embree_version();

}  // namespace pentaprism
