#pragma once
// One triangle as shading sees it: attributes at its corners, and how fast they change over the screen, the shutter and
// the lens. Set up once for all of a tile's points on the triangle.

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "base/float4.h"
#include "shade/seen_samples.h"
#include "shade/shading_scene.h"
#include "shade/surface_point.h"

namespace pentaprism {

class ShadedTriangle {
  public:
    /// `blur_share`: ShadingScene::blur_share() of the picture.
    ShadedTriangle(const ShadingScene& scene, std::uint32_t triangle, float blur_share);

    /// The point with these barycentrics (inside the triangle, sum 1) seen from the front or the back. Its textures are
    /// averaged over the cell's sides.
    SurfacePoint surface(const glm::vec3& barycentrics, bool front, const ShadingCell& cell) const;
    const BoundMaterial& material() const { return *part_.material; }

    /// For SeenSamples; only of use where the rate asks for cells.
    const CellTriangle& cells() const { return cells_; }

    /// Neither motion nor lens blurs any of it: what a pixel's samples see is all there is to a cell.
    bool is_sharp() const;

    /// Barycentrics of the place (of the triangle's plane, moved into the triangle) that is seen at these pixels from
    /// the middle of the picture at mid-shutter.
    glm::vec3 barycentrics_at(const glm::dvec2& place) const;

    /// The same of the middles of a cell's four quarters.
    void barycentrics_of_quarters(const ShadingCell& cell, glm::vec3 out[4]) const;

  private:
    /// From barycentrics over w, up to a factor: those of a place on the surface, with sum 1.
    glm::vec3 on_surface(const glm::dvec3& over_w) const;
    /// The triangle on the screen: pixels, at mid-shutter and through the middle of the lens.
    struct Projection {
        glm::dvec3 corner[3];         // x, y, w
        glm::dvec3 by_x, by_y, by_1;  // columns of the inverse of the corners' matrix: barycentrics over w
        double sum_x, sum_y;          // of the first two columns
        glm::dvec3 motion[3];         // of each corner over the whole shutter
        glm::dvec3 coc;               // c of each corner
    };
    /// Attributes of vertices_, those that there are.
    struct Attributes {
        Float4 position[3], normal[3], tangent[3], color[3];
        Float4 uv[3];  // of both sets
    };
    void project();
    void read_attributes();
    void set_up_textures();
    /// Frame::in_source()
    glm::vec3 in_source(const glm::vec3& barycentrics) const;
    float bulge(const glm::vec3& barycentrics, bool front) const;
    void add_footprints(const glm::vec3& barycentrics, const ShadingCell& cell, TextureFootprint out[2]) const;

    const ShadingScene& scene_;
    std::uint32_t triangle_;
    float blur_share_;
    const ShadedPart& part_;
    const glm::vec2* piece_;                 // Piece::corner, or null
    std::array<std::uint32_t, 3> vertices_;  // Frame::vertices()
    Projection projection_;
    CellTriangle cells_;
    Attributes corners_;
    glm::dvec2 uv_edges_[2][2];    // texture coordinates from the triangle's first corner to the others: [set][edge]
    glm::vec3 face_normal_{0.0f};  // unit, towards the front
    float turns_[3];               // of the normals along each edge
    float smoothness_;             // 1: a facet of a smooth surface, 0: its normals merely spread
};

}  // namespace pentaprism
