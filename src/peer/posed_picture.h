#pragma once
// What a reference and the renderer are both given: one frame, posed, and its samples.

#include <pentaprism/scene.h>
#include <pentaprism/settings.h>

#include "frame/frame.h"
#include "sample/sample_table.h"

namespace pentaprism {

struct PosedPicture {
    Frame frame;
    SampleTable samples;
};

/// As render_frame poses it. `scene` must outlive the picture.
PosedPicture pose_picture(const Scene& scene, const RenderSettings& settings, double frame);
PosedPicture pose_picture(const Scene&& scene, const RenderSettings& settings, double frame) = delete;  // would be gone

}  // namespace pentaprism
