#pragma once
// The frame's triangles in the world over the shutter: what a light sees of them. The camera's own motion is not in it.

#include <cmath>
#include <glm/vec3.hpp>
#include <vector>

#include "base/uninitialized.h"
#include "frame/frame.h"

namespace pentaprism {

/// Parts and corners are numbered as in the frame, so a triangle has the same index here.
struct WorldMotion {
    struct Bounds {
        glm::vec3 low{INFINITY}, high{-INFINITY};
    };
    std::vector<Part> parts;
    std::vector<Bounds> bounds;             ///< of each part over the shutter
    UninitializedVector<glm::vec3> points;  ///< metres from the origin; of each vertex at each knot of its part
    UninitializedVector<std::uint32_t> corners;
    glm::dvec3 origin{0.0};
    UninitializedVector<std::uint32_t> part_of;  ///< of each triangle
    bool moves = false;                          ///< any part
};

/// Knots are the frame's; what stands still in the world has one. `frozen`: all of it as it is at mid-shutter.
WorldMotion world_motion(const Frame& frame, const glm::dvec3& origin, bool frozen);

}  // namespace pentaprism
