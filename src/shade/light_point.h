#pragma once
// Material and lights of one point: what it shows. The readable twin of light_points.h, and its part for materials of
// several layers.

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "shade/shading_scene.h"
#include "shade/surface_point.h"

namespace pentaprism {

/// A point's colour, with what each light that casts shadows would add if nothing stood in its way.
struct LitColor {
    /// Cosine of face and light below which points are lifted to the smooth surface, little by little.
    static constexpr float kGrazing = 0.1f;
    /// Share of what a point shows that a light must add to need a shadow: half a code of 8 bits.
    static constexpr float kNegligible = 1.0f / 512.0f;
    struct Share {
        std::uint32_t light;
        glm::vec3 color;
        glm::vec3 offset;  ///< from the facet to the smooth surface it stands for; only where the light grazes it
    };
    glm::vec3 rest{0.0f};
    std::vector<Share> shadowed;
    glm::vec3 position{0.0f};  ///< relative to the eye, at mid-shutter
};

/// A normal that leans so far from the face that the eye's ray would be mirrored into the surface, bent back until it
/// is not; other normals as they are. All unit.
glm::vec3 visible_normal(const glm::vec3& normal, const glm::vec3& face, const glm::vec3& to_eye);

/// Linear colour of the point.
void light_point(const ShadingScene& scene, const BoundMaterial& material, const SurfacePoint& point, LitColor& out);

}  // namespace pentaprism
