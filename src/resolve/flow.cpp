#include "resolve/flow.h"

#include <array>

namespace pentaprism {
namespace {

// One instant: a pinhole and a shutter that is open for no time.
Frame instant(const Scene& scene, RenderSettings settings, double number) {
    settings.shutter.motion_blur = false;
    settings.camera.defocus = false;
    settings.camera.fstop.reset();
    settings.camera.lens_radius.reset();
    settings.camera.focus_pixel.reset();
    settings.camera.focus_object.clear();
    const View view = make_view(scene, settings, number);
    return pose_frame(scene, view, choose_animations(scene, settings.animation.animation), settings.shutter);
}

// Raster clip space of the point, in double: pixels come of a quotient.
glm::dvec3 place(const Frame& frame, const SurfaceSample& sample) {
    const Part& part = frame.parts[frame.part_of[sample.triangle]];
    glm::dvec3 p(0.0);
    for (int i = 0; i < 3; ++i) {
        const glm::vec4& corner = frame.points[part.first_point + sample.vertices[i]];
        p += double(sample.barycentrics[i]) * glm::dvec3(corner.x, corner.y, corner.z);
    }
    return p;
}

}  // namespace

Flow::Flow(const Scene& scene, const RenderSettings& settings, double number)
    : previous_(instant(scene, settings, number - 1.0)),
      now_(instant(scene, settings, number)),
      next_(instant(scene, settings, number + 1.0)) {}

std::optional<glm::vec2> Flow::between(const Frame& from, const Frame& to, const SurfaceSample& sample) {
    const glm::dvec3 a = place(from, sample), b = place(to, sample);
    if (!(a.z >= from.view.w_near() && b.z >= to.view.w_near())) return std::nullopt;
    return glm::vec2(b.x / b.z - a.x / a.z, -(b.y / b.z - a.y / a.z));
}

}  // namespace pentaprism
