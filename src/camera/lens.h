#pragma once
// The thin lens, and blur as an artist wants it instead (after Munkberg, Toth, Akenine-Moller 2012, Per-Vertex Defocus
// Blur for Stochastic Rasterization: a circle of confusion for each vertex, straight between them).

#include <array>
#include <glm/vec2.hpp>
#include <limits>
#include <memory>
#include <optional>

#include "camera/aperture_image.h"

namespace pentaprism {

/// c(z) = a + b * z: signed circle of confusion, a radius in pixels times w; negative in front of the focus plane. A
/// sample (u, v) sees a point at (x + u*c, y + v*ratio*c). Derivation: thin lens of radius A focused at F, with f_px =
/// fx: a = -A*f_px, b = A*f_px/F (perspective). An orthographic camera shears by the same slope: a = -A*fx, b = A*fx/F.
/// Of a plane of focus that leans, z is z + tilt . (Xc, Yc), and both are `stretch` times as large.
struct Lens {
    double a = 0.0, b = 0.0;
    double ratio = 1.0;   ///< height of the circle of confusion over its width (algorithms' lambda, pixels square)
    double radius = 0.0;  ///< metres, 0: pinhole
    double focus_distance = 0.0;  ///< metres
    double fstop = 0.0;           ///< 0: pinhole
    int blades = 0;               ///< 0: a disk
    double rotation_deg = 0.0;
    double roundness = 0.0;                      ///< of the blades: 0 straight, 1 arcs of the disk
    std::shared_ptr<const ApertureImage> image;  ///< instead of blades; may be null
    double cats_eye = 0.0;                       ///< CameraSettings::cats_eye

    /// The points (X, Y, z) of camera space (X to the right, Y up, z forward) with z + tilt . (X, Y) = focus_distance
    /// are sharp.
    glm::dvec2 tilt{0.0};
    double stretch = 1.0;  ///< largest on_tilted_plane() without it, so that samples stay on the unit disk

    /// Depths from the first to the second are sharp; the focus distance is one of them.
    std::optional<std::array<double, 2>> sharp_range;
    double max_foreground_px = std::numeric_limits<double>::infinity();  ///< largest radius in front of the focus

    bool pinhole() const { return radius == 0.0; }

    /// c is a + b * z everywhere: lines of sight are straight.
    bool straight() const { return !sharp_range && max_foreground_px == std::numeric_limits<double>::infinity(); }

    /// c at depth z (of a plane that leans: z + tilt . (X, Y)), with w = z (perspective) or 1. Continuous, and so is c
    /// / w, which never falls with z. In front of `depth_near`, where a radius means nothing, c goes on straight.
    double coc(double z, bool perspective, double depth_near) const;

    /// Sets a and b (and stretch) from radius, focus and tilt. `f_px`: View::fx.
    void focus(double f_px);

    /// Where a sample counts that goes through the lens at `uv` (v times ratio): with a plane of focus that leans, the
    /// same ray meets all points at once only if (u, v) is F / (F - radius * tilt . (u, v)) times as large. Exact;
    /// tests that assume the unit disk hold, for `stretch` takes the excess from here and gives it to c.
    glm::dvec2 on_tilted_plane(const glm::dvec2& uv) const;
};

}  // namespace pentaprism
