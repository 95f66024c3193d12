#pragma once
// What one light may see: the bounds of the triangles that can stand in its way, in its own view. The triangles
// themselves stay in the world, where all lights share them.

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <memory>
#include <span>

#include "frame/frame.h"
#include "shade/world_motion.h"

namespace pentaprism {

/// From where and which way a light looks, relative to the world motion's origin.
struct LightView {
    bool perspective = false;
    glm::vec3 position{0.0f};  ///< of a perspective one; an orthographic one looks from the origin, both ways
    glm::mat3 axes{1.0f};      ///< columns: right, up, forward; orthonormal

    /// A point of the world in this view: right, up, depth. What casts and what receives are placed alike, to the bit,
    /// here, in lanes (shadow_setup-inl.h) and on the card (shade/shadow_map.glsl).
    glm::vec3 place(const glm::vec3& point) const {
        const glm::vec3 p = point - position;
        return {glm::dot(p, axes[0]), glm::dot(p, axes[1]), glm::dot(p, axes[2])};
    }
};

/// A perspective view ends at this tangent, right, left, up and down: a face of a cube (1) with room around it.
inline constexpr float kWidestTangent = 1.5f;

/// A perspective light sees nothing nearer; metres.
inline constexpr float kNearestToLight = 1e-3f;

/// Share of a depth by which rounding may put a sample before its triangle.
inline constexpr float kDepthRounding = 32.0f / 16777216.0f;

/// What a light casts on surfaces lies between them and it, so what is drawn has a limit of depth: limit i leaves out
/// what is beyond 2^(i + kLeastLimit) metres, the last one nothing.
inline constexpr int kLimits = 24, kLeastLimit = -8;

/// The least limit that holds what is at that depth. An orthographic view, which sees both ways, has the last one
/// alone.
inline int limit_of(float depth, bool perspective) {
    if (!perspective || !std::isfinite(depth)) return kLimits - 1;
    // As std::ilogb(), which is a call.
    const int exponent = static_cast<int>(std::bit_cast<std::uint32_t>(depth) >> 23) - 127;
    return depth > 0.0f ? std::clamp(exponent + 1 - kLeastLimit, 0, kLimits - 1) : 0;
}

struct Casters {
    /// One motion segment of one triangle in the light's view: metres or tangents, y up.
    struct Box {
        float x0, x1, y0, y1;
        std::uint32_t triangle;  ///< of the frame
        std::uint16_t segment;
        std::uint8_t limit;  ///< the least that holds a part of it
        bool mixed;          ///< its opacity is to be asked: OpacityClass::kMixed
    };
    const WorldMotion* world;  ///< not owned, as `frame`
    const Frame* frame;        ///< asked for opacity
    LightView view;
    std::span<const Box> boxes;
    std::unique_ptr<Box[]> room;  ///< what `boxes` are of
    float extent = 0.0f;          ///< of the boxes, from the middle
};

/// `parallel`: on all cores; false for calls from within a loop over cores that may make others wait for the result.
Casters make_casters(const WorldMotion& world, const Frame& frame, const LightView& view, bool parallel);

}  // namespace pentaprism
