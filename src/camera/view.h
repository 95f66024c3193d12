#pragma once
// The camera of one frame: projection, thin lens and shutter, resolved from the scene and the settings.
//
// Raster clip space, used by every later stage: x = fx * Xc, y = fy * Yc, w = distance in front of the lens plane, so
// that (x/w, y/w) is the offset in pixels from the middle of the picture, y up. It is the clip space of the papers
// times half the resolution: a circle of confusion is then round in the same unit as x. An orthographic camera has w =
// 1 everywhere and keeps its depth in z; a perspective camera has z = w.

#include <glm/mat4x4.hpp>
#include <optional>
#include <pentaprism/scene.h>
#include <pentaprism/settings.h>
#include <string>
#include <vector>

#include "camera/lens.h"
#include "camera/shutter_curve.h"
#include "scene/pose.h"

namespace pentaprism {

/// Shutter open and close in seconds; equal when nothing may move. A rolling shutter opens at `open` for the first row
/// and closes at `close` for the last.
struct Shutter {
    double open = 0.0, close = 0.0;
    RollingShutter rolling = RollingShutter::kNone;
    double exposure_share = 1.0;  ///< how much of that time a row is exposed: below 1 for a rolling shutter alone
    ShutterCurve curve{};         ///< within the exposure of a row
    double readout() const { return (1.0 - exposure_share) * (close - open); }  ///< seconds
    double middle() const { return 0.5 * (open + close); }
    /// Time of t in [0, 1].
    double at(double t) const { return open + (close - open) * t; }
};

struct View {
    int width = 0, height = 0;
    bool perspective = true;
    double fx = 1.0, fy = 1.0;                   ///< pixels (perspective: focal length; orthographic: pixels per metre)
    double depth_near = 0.01, depth_far = 1e30;  ///< metres along the axis
    Lens lens;
    Shutter shutter;
    Index camera_node = kNone;              ///< kNone: a camera that frames the scene
    glm::dmat4 fixed_world_to_camera{1.0};  ///< used when camera_node is kNone
    std::optional<glm::dmat4> offset;       ///< from the scene's camera to that of CameraSettings::offset
    std::string camera_name;
    double focal_length_mm = 0.0, sensor_width_mm = 36.0;
    bool optics_move = false;  ///< zoom or focus are animated: see view_at()
    CameraSettings asked{};    ///< what they follow from, if they are
    /// Smallest w that counts as in front of the camera in screen bounds: depth_near, or 1/2 for w = 1 everywhere.
    double w_near() const { return perspective ? depth_near : 0.5; }
    /// Signed circle of confusion of a point of raster clip space (x, y, and depth z), a radius in pixels times w.
    double coc(double x, double y, double z) const {
        return lens.coc(z + lens.tilt.x * x / fx + lens.tilt.y * y / fy, perspective, depth_near);
    }
    /// Lines of sight of one time are straight, and so are those of all times.
    bool has_straight_sight() const { return lens.pinhole() || (lens.straight() && !optics_move); }
};

/// World to camera space (right-handed, looking along -z) at the time of the pose.
glm::dmat4 world_to_camera(const View& view, const Pose& pose);

/// A point of camera space in raster clip space: x, y, w and the depth z.
inline glm::dvec4 to_raster_clip(const View& view, const glm::dvec3& camera_space) {
    const double depth = -camera_space.z;
    return {view.fx * camera_space.x, view.fy * camera_space.y, view.perspective ? depth : 1.0, depth};
}

/// What the sample (gx, gy, u, v), as the exact test has it, sees: the points origin + depth * direction of (x, y) in
/// raster clip space. Of a view with straight sight.
struct LineOfSight {
    glm::dvec2 origin, direction;
};
LineOfSight line_of_sight(const View& view, double gx, double gy, double u, double v);

/// The view at another time of its shutter: projection and lens where they are animated.
View view_at(const Scene& scene, const View& view, const Pose& pose);

/// Resolves camera, lens and shutter of frame number `frame`. Throws Error(kUsage) for a camera, node or animation that
/// the scene does not have.
View make_view(const Scene& scene, const RenderSettings& settings, double frame);

}  // namespace pentaprism
