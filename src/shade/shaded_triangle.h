#pragma once
// One triangle as shading sees it: attributes at its corners, and how fast they change over the screen, the shutter and
// the lens. Set up once for all of a tile's points on the triangle.

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "shade/shading_scene.h"

namespace pentaprism {

class ShadedTriangle {
  public:
    ShadedTriangle(const ShadingScene& scene, std::uint32_t triangle);

    /// Linear colour of the point with these barycentrics (inside the triangle, sum 1) seen from the front or the back.
    glm::vec3 shade(const glm::vec3& barycentrics, bool front) const;

  private:
    /// The triangle on the screen: pixels, at mid-shutter and through the middle of the lens.
    struct Projection {
        glm::dvec3 corner[3];   // x, y, w
        glm::dvec3 by_x, by_y;  // columns of the inverse of the corners' matrix: change of barycentrics over w
        glm::dvec3 motion[3];   // of each corner over the whole shutter
        glm::dvec3 coc;         // c of each corner
    };
    void project(std::uint32_t triangle);
    TextureFootprint footprint(const glm::vec3& barycentrics, int set) const;

    const ShadingScene& scene_;
    const ShadedPart& part_;
    std::array<std::uint32_t, 3> vertices_;
    Projection projection_;
};

}  // namespace pentaprism
