#pragma once
// Questions that choosing a camera and a focus asks the posed scene.

#include <glm/vec3.hpp>
#include <limits>
#include <string>

#include "camera/view.h"

namespace pentaprism {

struct Box3 {
    glm::dvec3 lower{std::numeric_limits<double>::infinity()}, upper{-std::numeric_limits<double>::infinity()};
    bool empty() const { return !(lower.x <= upper.x); }
    glm::dvec3 centre() const { return 0.5 * (lower + upper); }
    void extend(const Box3& other) {
        lower = glm::min(lower, other.lower);
        upper = glm::max(upper, other.upper);
    }
};

/// World-space box of all that is placed at `node` or below it; of the whole scene for kNone.
Box3 bounding_box(const Scene& scene, const Pose& pose, Index node);

/// Depth along the axis of the nearest surface that a pinhole sees at picture position (x, y) in pixels from the top
/// left corner; +infinity where there is none.
double depth_at_pixel(const Scene& scene, const Pose& pose, const View& view, double x, double y);

/// The first node of that name, kNone if there is none.
Index find_node(const Scene& scene, const std::string& name);

}  // namespace pentaprism
