#pragma once
// A point of a surface as light meets it: what the triangle says of it (shaded_triangle.h), before its material does.

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "shade/footprint.h"

namespace pentaprism {

struct SurfacePoint {
    glm::vec3 position{0.0f};  ///< relative to the eye, at mid-shutter
    glm::vec3 normal{0.0f};    ///< interpolated, as it is
    glm::vec4 tangent{0.0f};   ///< the same; only if has_tangent
    glm::vec3 face{0.0f};      ///< unit normal of the facet, towards the side that is seen
    glm::vec3 color{1.0f};     ///< of the vertices
    glm::vec2 uv[2] = {};      ///< of each set of texture coordinates
    TextureFootprint footprint[2];
    float bulge = 0.0f;  ///< how far the smooth surface lies over the facet, along its normal
    bool front = true, has_tangent = false;
};

}  // namespace pentaprism
