#pragma once
// What the device keeps of a frame, and the passes over it. All of it needs a Device::Current.

#include "gl/device.h"
#include "gl/opacity_upload.h"
#include "gl/program.h"
#include "gl/region.h"
#include "gl/upload.h"

namespace pentaprism::gl {

/// What a region's samples see, and what that cost.
struct RegionHits {
    std::vector<float> depth;  ///< [cell][as in Hits]
    std::vector<std::uint32_t> triangle;
    std::vector<std::uint32_t> tested, covered;  ///< of each pixel of the region, row by row
    std::int64_t pixels_left = 0;                ///< not yet asked for
};

class Pipeline {
  public:
    /// `largest`: no region has more columns or rows of cells. Frame and table must outlive it.
    Pipeline(Device& device, const Frame& frame, const SampleTable& table, const std::string& culling,
             const Region& largest);

    RegionHits render(const Region& region);

  private:
    void set_uniforms(const Region& region, int pass_slots) const;
    void draw() const;
    void collect(const Region& region, int first_slot, int pass_slots, RegionHits& hits);

    const Frame& frame_;
    const SampleTable& table_;
    int slots_, width_, height_;
    FrameUpload geometry_;
    OpacityUpload opacity_;
    SampleUpload samples_;
    const Program &raster_, &collector_;
    Buffer collected_;
    Object<TextureKind> seen_, tested_, covered_;
    Object<RenderbufferKind> depth_;
    Object<FramebufferKind> framebuffer_;
    std::vector<glm::uvec2> received_;
};

}  // namespace pentaprism::gl
