#pragma once
// What one light may see: the triangles that can stand in its way, in its own view, and their bounds.

#include <cstdint>
#include <glm/mat3x3.hpp>
#include <memory>
#include <span>

#include "frame/frame.h"
#include "shade/world_motion.h"

namespace pentaprism {

/// From where and which way a light looks, relative to the world motion's origin.
struct LightView {
    bool perspective = false;
    glm::dvec3 position{0.0};  ///< of a perspective one; an orthographic one looks from the origin, both ways
    glm::dmat3 axes{1.0};      ///< columns: right, up, forward; orthonormal
};

/// A perspective view ends at this tangent, right, left, up and down: a face of a cube (1) with room around it.
inline constexpr float kWidestTangent = 1.5f;

struct Casters {
    /// One motion segment of one triangle in the light's view: metres or tangents, y up.
    struct Box {
        float x0, x1, y0, y1;
        float nearest;  ///< no sample sees it at a smaller depth
        std::uint32_t triangle;
        std::uint16_t segment;
        bool mixed;  ///< its opacity is to be asked: OpacityClass::kMixed
    };
    Frame frame;  ///< x and y in metres or tangents; parts out of view are left out, so triangles have other numbers
    std::span<const Box> boxes;
    std::unique_ptr<Box[]> room;  ///< what `boxes` are of
    float extent = 0.0f;          ///< of the boxes, from the middle
};

/// `width`: pixels of the frame's view. `parallel`: on all cores; false for calls from within a loop over cores that
/// may make others wait for the result.
Casters make_casters(const WorldMotion& world, const Frame& frame, const LightView& view, int width, bool parallel);

}  // namespace pentaprism
