#include "peer/posed_picture.h"

#include "render/visibility.h"
#include "scene/texture.h"

namespace pentaprism {

PosedPicture pose_picture(const Scene& scene, const RenderSettings& settings, double frame) {
    const View view = make_view(scene, settings, frame);
    Frame posed = pose_frame(scene, view, choose_animations(scene, settings.animation.animation), settings.shutter);
    posed.textures = make_textures(scene);
    SampleTable samples = make_samples(posed, settings.image.spp, settings.method);
    return {std::move(posed), std::move(samples)};
}

}  // namespace pentaprism
