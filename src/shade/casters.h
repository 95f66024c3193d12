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
#include <vector>

#include "frame/frame.h"
#include "shade/world_motion.h"

namespace pentaprism {

/// From where and which way a light looks, relative to the world motion's origin.
struct LightView {
    bool perspective = false;
    glm::vec3 position{0.0f};  ///< of a perspective one; an orthographic one looks from the origin, both ways
    glm::mat3 axes{1.0f};      ///< columns: right, up, forward; orthonormal

    /// A point of the world in this view: right, up, depth. What casts and what receives are placed alike, to the bit,
    /// here, in lanes (light_view-inl.h) and on the card (shadow_lookup.glsl).
    glm::vec3 place(const glm::vec3& point) const {
        const glm::vec3 p = point - position;
        return {glm::dot(p, axes[0]), glm::dot(p, axes[1]), glm::dot(p, axes[2])};
    }
};

/// A perspective view ends at this tangent, right, left, up and down: a face of a cube (1) with room around it.
inline constexpr float kWidestTangent = 1.5f;

/// What lies farther, to a side or in depth, is left out; metres.
inline constexpr float kLargestOfCasters = 1e12f;

/// A perspective light sees nothing nearer; metres.
inline constexpr float kNearestToLight = 1e-3f;

/// Share of a depth by which rounding may put a sample before its triangle.
inline constexpr float kDepthRounding = 32.0f / 16777216.0f;

/// What a light casts on surfaces lies between them and it, so what is drawn has a limit of depth: limit i leaves out
/// what is beyond 2^(i + kLeastLimit) metres, the last one nothing.
inline constexpr int kLimits = 24, kLeastLimit = -8;

/// Of a positive number, as std::ilogb(), which is a call; of subnormal ones one that is small enough.
inline int binary_exponent(float x) {
    return static_cast<int>(std::bit_cast<std::uint32_t>(x) >> 23) - 127;
}

/// The least limit that holds what is at that depth. An orthographic view, which sees both ways, has the last one
/// alone.
inline int limit_of(float depth, bool perspective) {
    if (!perspective || !std::isfinite(depth)) return kLimits - 1;
    return depth > 0.0f ? std::clamp(binary_exponent(depth) + 1 - kLeastLimit, 0, kLimits - 1) : 0;
}

struct Casters {
    static constexpr int kLanes = 16;
    /// Of sixteen boxes, or groups of boxes, in the light's view: metres or tangents, y up.
    struct Extents {
        float x0[kLanes], x1[kLanes], y0[kLanes], y1[kLanes];
        std::uint8_t limit[kLanes];  ///< the least that holds a part of it
    };
    /// One motion segment each of up to sixteen triangles, in as few bytes as they go into: there are millions.
    struct alignas(64) Boxes : Extents {
        static constexpr std::uint32_t kSpan = 256;  ///< how far numbers of triangles in one block may lie apart
        std::uint8_t beyond_first[kLanes];
        std::uint8_t segment[kLanes];  ///< a path has 64 at most
        std::uint32_t first_triangle;
        std::uint16_t mixed;  ///< a bit for each lane

        /// Of the frame.
        std::uint32_t triangle(std::size_t lane) const { return first_triangle + beyond_first[lane]; }
        /// Its opacity is to be asked: OpacityClass::kMixed.
        bool is_mixed(std::size_t lane) const { return (mixed >> lane & 1) != 0; }
    };
    static_assert(sizeof(Boxes) == 20 * kLanes);
    const WorldMotion* world;  ///< not owned
    LightView view;
    std::unique_ptr<Boxes[]> boxes;  ///< box i in lane i % kLanes of boxes[i / kLanes]
    std::uint32_t count = 0;         ///< of lanes; in those that are left over in a block is nothing
    /// A tree, as neighbours in the mesh lie near each other: of all boxes in each of `boxes` a lane, and of each of
    /// these again.
    std::vector<Extents> groups, groups_of_groups;
};

/// `parallel`: on all cores; false for calls from within a loop over cores that may make others wait for the result.
Casters make_casters(const WorldMotion& world, const LightView& view, bool parallel);

}  // namespace pentaprism
