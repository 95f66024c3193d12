#pragma once
// glTF metallic-roughness: Lambert under GGX, with the energy that one bounce between microfacets loses put back.
//
// Walter, Marschner, Li, Torrance 2007 (GGX); Heitz 2014 (height-correlated masking); Schlick 1994 (Fresnel); Turquin
// 2019 (scaling by the tabulated albedo). The glTF appendix mixes (1 - F) * diffuse + F * specular, which gains up to
// half again as much light as comes in; here the diffuse part gets what the specular one leaves: a white surface
// reflects at most 1.

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <pentaprism/settings.h>
#include <span>

namespace pentaprism {

/// Smallest roughness that lights are shaded with: a mirror would show a point light in no pixel at all.
inline constexpr float kLeastRoughness = 0.045f;

/// Directional albedo of the specular lobe: E = f0 * x + f90 * y. From a table; cos_view in (0, 1].
glm::vec2 specular_albedo(float cos_view, float roughness);

/// The table, [32 * row + column]: rows by roughness from 0 to 1, columns by the square root of cos_view.
std::span<const glm::vec2> specular_albedo_table();

/// How a dielectric reflects: KHR_materials_ior and KHR_materials_specular.
struct DielectricReflection {
    glm::vec3 f0{0.04f};  ///< at normal incidence
    float f90 = 1.0f;     ///< at grazing incidence

    static DielectricReflection of(float ior, float specular, const glm::vec3& specular_color);
};

/// A material at a point, seen from one direction.
class Brdf {
  public:
    Brdf(const glm::vec3& base, float metallic, float roughness, float cos_view,
         const DielectricReflection& dielectric = {}, BrdfModel model = BrdfModel::kGltf);

    /// Reflected radiance over incoming irradiance perpendicular to the ray: the BRDF times cos_light.
    /// cos_half = n.h, cos_difference = v.h; cos_light > 0.
    glm::vec3 reflected(float cos_light, float cos_half, float cos_difference) const;

    /// For surfaces that let part of the light through instead of scattering it.
    void scale_diffuse(float share) { diffuse_albedo_ *= share; }

    /// Share of uniform light from all sides that goes to the eye by the diffuse part and by the specular part.
    const glm::vec3& diffuse_albedo() const { return diffuse_albedo_; }
    const glm::vec3& specular_albedo() const { return specular_albedo_; }

  private:
    BrdfModel model_;
    float cos_view_, alpha2_, roughness_, dielectric_f90_;
    glm::vec3 diffuse_albedo_, specular_albedo_;
    glm::vec3 dielectric_f0_, dielectric_scale_, metal_f0_, metal_scale_;
};

/// A layer of varnish (KHR_materials_clearcoat): a dielectric of index 1.5 without colour over everything else.
class Coat {
  public:
    Coat(float share, float roughness, float cos_view);

    /// As Brdf::reflected(), with the cosines of the coat's own normal.
    float reflected(float cos_light, float cos_half, float cos_difference) const;

    /// Share of uniform light that it throws back: what is below gets the rest.
    float albedo() const { return albedo_; }

  private:
    float cos_view_, alpha2_, scale_, albedo_;
};

/// Fibres that stand on a surface (KHR_materials_sheen): Estevez & Kulla 2017, with the masking of Neubelt & Pettineo
/// 2013. What is below gets what its albedo leaves.
class Sheen {
  public:
    Sheen(const glm::vec3& color, float roughness, float cos_view);
    glm::vec3 reflected(float cos_light, float cos_half) const;
    const glm::vec3& albedo() const { return albedo_; }

  private:
    float cos_view_, inverse_alpha_;
    glm::vec3 color_, albedo_;
};

/// Directional albedo of white sheen, from a table.
float sheen_albedo(float cos_view, float roughness);

/// That table, 16 x 16, arranged as the other one.
std::span<const float> sheen_albedo_table();

}  // namespace pentaprism
