#pragma once
// glTF metallic-roughness: Lambert under GGX, with the energy that one bounce between microfacets loses put back.
//
// Walter, Marschner, Li, Torrance 2007 (GGX); Heitz 2014 (height-correlated masking); Schlick 1994 (Fresnel); Turquin
// 2019 (scaling by the tabulated albedo). The glTF appendix mixes (1 - F) * diffuse + F * specular, which gains up to
// half again as much light as comes in; here the diffuse part gets what the specular one leaves: a white surface
// reflects at most 1.

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace pentaprism {

/// Smallest roughness that lights are shaded with: a mirror would show a point light in no pixel at all.
inline constexpr float kLeastRoughness = 0.045f;

/// Directional albedo of the specular lobe: E = f0 * x + f90 * y. From a table; cos_view in (0, 1].
glm::vec2 specular_albedo(float cos_view, float roughness);

/// A material at a point, seen from one direction.
class Brdf {
  public:
    Brdf(const glm::vec3& base, float metallic, float roughness, float cos_view);

    /// Reflected radiance over incoming irradiance perpendicular to the ray: the BRDF times cos_light.
    /// cos_half = n.h, cos_difference = v.h; cos_light > 0.
    glm::vec3 reflected(float cos_light, float cos_half, float cos_difference) const;

    /// Share of uniform light from all sides that goes to the eye by the diffuse part and by the specular part.
    const glm::vec3& diffuse_albedo() const { return diffuse_albedo_; }
    const glm::vec3& specular_albedo() const { return specular_albedo_; }

  private:
    float cos_view_, alpha2_, dielectric_scale_;
    glm::vec3 diffuse_albedo_, specular_albedo_;
    glm::vec3 metal_f0_, metal_scale_;
};

}  // namespace pentaprism
