#pragma once
// What finds the hits of one pass of samples: one file for each way to do it. All of it needs a Device::Current.

#include "gl/culling.h"
#include "gl/device.h"
#include "gl/opacity_upload.h"
#include "gl/region.h"
#include "gl/upload.h"

namespace pentaprism::gl {

// Units and bindings that the shaders know.
inline constexpr GLuint kSampleUnit = 0, kOpacityUnits = 1, kSeenUnit = 0, kTestedImage = 0, kCoveredImage = 1,
                        kHitsBlock = 0;

/// What a pass reads and writes.
struct PassData {
    const Frame& frame;
    const SampleTable& table;
    const FrameUpload& geometry;
    const OpacityUpload& opacity;
    const SampleUpload& samples;
    const Buffer& hits;  ///< triangle, bits of its depth; by entry_of() of gl/samples.glsl
};

class Pass {
  public:
    virtual ~Pass() = default;

    /// Writes the hits of `count` samples of each pixel of the region, and adds to the counts of the images that are
    /// bound. `is_first`: of this region.
    virtual void run(const Region& region, int count, bool is_first) = 0;
};

/// The uniforms that all programs may ask for.
void set_uniforms(const Program& program, const PassData& data, const Region& region, int count);

}  // namespace pentaprism::gl
