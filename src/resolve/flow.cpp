#include "resolve/flow.h"

namespace pentaprism {

Frame pose_instant(const Scene& scene, RenderSettings settings, double number) {
    settings.shutter.motion_blur = false;
    settings.camera.defocus = false;
    settings.camera.fstop.reset();
    settings.camera.lens_radius.reset();
    settings.camera.focus_pixel.reset();
    settings.camera.focus_object.clear();
    const View view = make_view(scene, settings, number);
    return pose_frame(scene, view, choose_animations(scene, settings.animation.animation), settings.shutter);
}

RenderSettings frame_before(RenderSettings settings) {
    settings.camera.offset = settings.camera.offset_before;
    return settings;
}

RenderSettings frame_after(RenderSettings settings) {
    settings.camera.offset = settings.camera.offset_after;
    return settings;
}

// In double: pixels come of a quotient. The sample's triangle has another number here if its frame cut triangles.
Placed place_of(const Frame& frame, const SurfaceSample& sample) {
    const Part& part = frame.parts[sample.part_index];
    glm::dvec3 p(0.0);
    double depth = 0.0;
    for (int i = 0; i < 3; ++i) {
        const std::size_t point = part.first_point + sample.vertices[i];
        const glm::vec4& corner = frame.points[point];
        p += double(sample.barycentrics[i]) * glm::dvec3(corner.x, corner.y, corner.z);
        if (!frame.view.perspective) depth += double(sample.barycentrics[i]) * frame.depths[point];
    }
    return {p.x / p.z, p.y / p.z, p.z, frame.view.perspective ? p.z : depth};
}

Flow::Flow(const Scene& scene, const RenderSettings& settings, double number)
    : previous_(pose_instant(scene, frame_before(settings), number - settings.image.flow_step)),
      now_(pose_instant(scene, settings, number)),
      next_(pose_instant(scene, frame_after(settings), number + settings.image.flow_step)) {}

std::optional<glm::vec2> Flow::between(const Frame& from, const Frame& to, const SurfaceSample& sample) {
    const Placed a = place_of(from, sample), b = place_of(to, sample);
    if (!(a.w >= from.view.w_near() && b.w >= to.view.w_near())) return std::nullopt;
    return glm::vec2(b.x - a.x, a.y - b.y);
}

}  // namespace pentaprism
