#pragma once
// What the device keeps of a frame, and the passes over it. All of it needs a Device::Current.

#include <memory>
#include <pentaprism/settings.h>

#include "gl/pass.h"

namespace pentaprism::gl {

/// What a region's samples see, and what that cost.
struct RegionHits {
    std::vector<float> depth;  ///< [cell][as in Hits]
    std::vector<std::uint32_t> triangle;
    std::vector<std::uint32_t> tested, covered;  ///< of each pixel of the region, row by row
};

class Pipeline {
  public:
    /// `largest`: no region has more columns or rows of cells. Frame and table must outlive it.
    Pipeline(Device& device, const Frame& frame, const SampleTable& table, const MethodSettings& method,
             const Region& largest);

    RegionHits render(const Region& region);
    bool takes_compute() const { return compute_; }

  private:
    void receive(const Region& region, int first_slot, int count, RegionHits& hits);

    const SampleTable& table_;
    Culling culling_;
    bool compute_;
    int slots_, width_, height_;
    FrameUpload geometry_;
    OpacityUpload opacity_;
    SampleUpload samples_;
    Buffer collected_;
    Object<TextureKind> tested_, covered_;
    std::unique_ptr<Pass> pass_;
    std::vector<glm::uvec2> received_;
};

}  // namespace pentaprism::gl
