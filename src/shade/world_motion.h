#pragma once
// The frame's triangles in the world over the shutter: what a light sees of them. The camera's own motion is not in it.

#include <array>
#include <cmath>
#include <glm/vec3.hpp>
#include <vector>

#include "base/uninitialized.h"
#include "frame/frame.h"

namespace pentaprism {

/// Parts and triangles are numbered as in the frame, which knows the corners of these; its points are others.
struct WorldMotion {
    struct Bounds {
        glm::vec3 low{INFINITY}, high{-INFINITY};
    };
    const Frame* frame = nullptr;  ///< not owned
    std::vector<Part> parts;
    std::vector<std::uint32_t> shifts;      ///< of each part: what a number of a point of the frame lacks, modulo 2^32
    std::vector<Bounds> bounds;             ///< of each part over the shutter
    UninitializedVector<glm::vec3> points;  ///< metres from the origin; of each vertex at each knot of its part
    glm::dvec3 origin{0.0};
    bool moves = false;                ///< any part
    std::vector<bool> at_mid_shutter;  ///< of each part: whether its points are as they are then, and no others

    const Part& part_of(std::uint32_t triangle) const { return parts[frame->part_of[triangle]]; }

    /// Into `points`, at knot 0.
    std::array<std::uint32_t, 3> corners(std::uint32_t triangle) const {
        const std::uint32_t shift = shifts[frame->part_of[triangle]];
        const std::uint32_t* corner = &frame->corners[3 * std::size_t{triangle}];
        return {corner[0] + shift, corner[1] + shift, corner[2] + shift};
    }
};

/// Knots are the frame's; what stands still in the world has one. `frozen`: all of it as it is at mid-shutter.
/// `frame` must outlive what is returned.
WorldMotion world_motion(const Frame& frame, const glm::dvec3& origin, bool frozen);

}  // namespace pentaprism
