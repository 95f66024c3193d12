#pragma once
// Whether the points of a frame's surfaces are still seen one frame later, and were one frame earlier: what makes
// optical flow valid there.

#include <vector>

#include "frame/frame.h"
#include "resolve/flow.h"
#include "resolve/surface_samples.h"

namespace pentaprism {

/// What a pinhole sees of a frame at mid-shutter: the depth at one point in each of a grid of squares, twice as many a
/// side as the picture has pixels.
class DepthPicture {
  public:
    DepthPicture(const Scene& scene, const RenderSettings& settings, double number,
                 const std::shared_ptr<const Textures>& textures);

    enum class Fate : std::uint8_t { kSeen, kHidden, kOutside };
    /// A point is hidden where all of the nine points around its place are nearer by over a thousandth: never for a
    /// flat surface behind itself, whatever its slope.
    Fate of(const SurfaceSample& sample) const;

  private:
    Frame frame_;
    std::vector<float> depth_;
};

class FlowOcclusion {
  public:
    using Fate = DepthPicture::Fate;

    /// `settings` and `number` are those of the frame that is rendered.
    FlowOcclusion(const Frame& frame, const RenderSettings& settings, double number)
        : previous_(*frame.scene, frame_before(settings), number - settings.image.flow_step, frame.textures),
          next_(*frame.scene, frame_after(settings), number + settings.image.flow_step, frame.textures) {}

    Fate forward(const SurfaceSample& sample) const { return next_.of(sample); }
    Fate backward(const SurfaceSample& sample) const { return previous_.of(sample); }

  private:
    DepthPicture previous_, next_;
};

}  // namespace pentaprism
