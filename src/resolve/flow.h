#pragma once
// Where the points of a frame's surfaces are on the screen one frame (ImageSettings::flow_step) earlier and later. The
// scene is posed at mid-shutter of the neighbouring frames, each through its own camera: displacement between frames,
// whatever the shutter.

#include <glm/vec2.hpp>
#include <optional>

#include "frame/frame.h"
#include "resolve/surface_samples.h"

namespace pentaprism {

/// The scene at mid-shutter of a frame through a pinhole: all at one instant.
Frame pose_instant(const Scene& scene, RenderSettings settings, double number);

/// Settings of the neighbouring frames, as far as flow needs them.
RenderSettings frame_before(RenderSettings settings);
RenderSettings frame_after(RenderSettings settings);

/// Where a frame of pose_instant() shows the point that a sample of another frame of the scene sees.
struct Placed {
    double x = 0, y = 0;  ///< pixels from the middle of the picture, y up; no number unless w > 0
    double w = 0;         ///< in front of the camera if View::w_near() or more
    double depth = 0;     ///< metres along the optical axis
};
Placed place_of(const Frame& frame, const SurfaceSample& sample);

class Flow {
  public:
    /// `settings` and `number` are those of the frame that is rendered. The scene must outlive this.
    Flow(const Scene& scene, const RenderSettings& settings, double number);

    /// From the point's place now to its place a frame later and earlier: pixels, x right, y DOWN. Nothing where one of
    /// the places is not in front of the camera.
    std::optional<glm::vec2> forward(const SurfaceSample& sample) const { return between(now_, next_, sample); }
    std::optional<glm::vec2> backward(const SurfaceSample& sample) const { return between(now_, previous_, sample); }

  private:
    static std::optional<glm::vec2> between(const Frame& from, const Frame& to, const SurfaceSample& sample);

    Frame previous_, now_, next_;
};

}  // namespace pentaprism
