#include "shade/light_point.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <optional>

#include "frame/opacity.h"
#include "shade/brdf.h"
#include "shade/unit_vector.h"

namespace pentaprism {

// A smooth normal may lean so far from the face that the eye's ray would be mirrored into the surface. Then the nearest
// normal between it and the face's that mirrors the ray along the surface (1/100 above it) takes its place. In the
// plane of both normals, with the face's as axis, the eye at angle phi and at length r, a normal at angle theta mirrors
// the eye's direction to height r cos(2 theta - phi).
glm::vec3 visible_normal(const glm::vec3& normal, const glm::vec3& face, const glm::vec3& to_eye) {
    const float height = glm::dot(to_eye, face);
    const float least = std::min(0.9f * height, 0.01f);
    if (!(height > 0.0f) || 2.0f * glm::dot(normal, to_eye) * glm::dot(normal, face) - height >= least) return normal;
    const glm::vec3 along = normalized_or(normal - glm::dot(normal, face) * face, glm::vec3(0.0f));
    const float side = glm::dot(to_eye, along), r = std::sqrt(side * side + height * height);
    const float turn = std::acos(std::min(least / r, 1.0f)), phi = std::atan2(side, height);
    const float now = std::atan2(glm::dot(normal, along), glm::dot(normal, face));
    const float theta = std::clamp(now, 0.5f * (phi - turn), 0.5f * (phi + turn));
    return std::sin(theta) * along + std::cos(theta) * face;
}

namespace {

// The normal of a texel, x and y scaled: unit, or as long as filtering left it.
glm::vec3 decoded_normal(const glm::vec4& texel, float scale) {
    return {(2.0f * texel.x - 1.0f) * scale, (2.0f * texel.y - 1.0f) * scale, 2.0f * texel.z - 1.0f};
}

// What a surface does with the light of one direction.
class Surface {
  public:
    Surface(const Brdf& brdf, float roughness, const glm::vec3& normal, const glm::vec3& to_eye)
        : brdf_(brdf), roughness_(roughness), normal_(normal), to_eye_(to_eye) {}

    void add_coat(float share, float roughness, const glm::vec3& normal) {
        coat_normal_ = normal;
        coat_roughness_ = roughness;
        coat_ = Coat(share, roughness, glm::dot(normal, to_eye_));
        below_ *= 1.0f - coat_->albedo();
    }
    void add_sheen(const glm::vec3& color, float roughness) {
        sheen_ = Sheen(color, roughness, glm::dot(normal_, to_eye_));
        sheen_scale_ = below_;
        const glm::vec3& albedo = sheen_->albedo();
        below_ *= 1.0f - std::max({albedo.x, albedo.y, albedo.z});
    }

    // Reflected radiance over irradiance perpendicular to the ray; black from behind.
    glm::vec3 reflected(const glm::vec3& to_light) const {
        const glm::vec3 half = normalized_or(to_light + to_eye_, normal_);
        const float cos_difference = glm::dot(to_eye_, half);
        const auto cos_half = [&](const glm::vec3& n) { return std::max(0.0f, glm::dot(n, half)); };
        glm::vec3 color(0.0f);
        if (const float cos_light = glm::dot(normal_, to_light); cos_light > 0.0f) {
            color = below_ * brdf_.reflected(cos_light, cos_half(normal_), cos_difference);
            if (sheen_) color += sheen_scale_ * sheen_->reflected(cos_light, cos_half(normal_));
        }
        if (!coat_) return color;
        if (const float cos_light = glm::dot(coat_normal_, to_light); cos_light > 0.0f)
            color += coat_->reflected(cos_light, cos_half(coat_normal_), cos_difference);
        return color;
    }
    // The same of light from all sides.
    glm::vec3 ambient(const Lighting& lighting) const {
        const auto mirrored = [&](const glm::vec3& n) { return 2.0f * glm::dot(n, to_eye_) * n - to_eye_; };
        glm::vec3 color = brdf_.diffuse_albedo() * lighting.matte(normal_) +
                          brdf_.specular_albedo() * lighting.shiny(mirrored(normal_), roughness_);
        color *= below_;
        if (sheen_) color += sheen_scale_ * sheen_->albedo() * lighting.matte(normal_);
        if (coat_) color += coat_->albedo() * lighting.shiny(mirrored(coat_normal_), coat_roughness_);
        return color;
    }

    // Of what is not reflected by a coat or by fibres.
    float below() const { return below_; }

  private:
    Brdf brdf_;
    float roughness_, coat_roughness_ = 0.0f;
    glm::vec3 normal_, to_eye_, coat_normal_{0.0f};
    std::optional<Coat> coat_;
    std::optional<Sheen> sheen_;
    float below_ = 1.0f, sheen_scale_ = 1.0f;
};

// Mapped normals live in the frame (tangent, bitangent, normal) of the interpolated vectors as they are; the result
// alone is made unit (as MikkTSpace asks).
glm::vec3 mapped_normal(const SurfacePoint& point, const glm::vec3& map) {
    const glm::vec3 along(point.tangent);
    return map.x * along + map.y * (glm::cross(point.normal, along) * point.tangent.w) + map.z * point.normal;
}

}  // namespace

void light_point(const ShadingScene& scene, const BoundMaterial& bound, const SurfacePoint& point, LitColor& out) {
    out.shadowed.clear();
    out.rest = glm::vec3(0.0f);
    const Material& material = bound.material;
    const auto look_up = [&](const BoundTexture& texture) {
        return texture.pyramid ? texture.sample(point.uv[texture.set], point.footprint[texture.set]) : glm::vec4(1.0f);
    };

    const glm::vec3 base = glm::vec3(material.base_color) * glm::vec3(look_up(bound.base_color)) * point.color;
    if (material.unlit) {
        out.rest = base;
        return;
    }

    const glm::vec4 metallic_roughness = look_up(bound.metallic_roughness);
    const float metallic = material.metallic * metallic_roughness.z;
    const float roughness = material.roughness * metallic_roughness.y;
    const glm::vec3 to_eye = scene.to_eye(point.position);
    const auto towards_eye = [&](const glm::vec3& n) {
        const glm::vec3 unit = normalized_or(n, to_eye);
        return point.front ? unit : -unit;
    };
    const auto seen = [&](const glm::vec3& n) { return visible_normal(towards_eye(n), point.face, to_eye); };
    const glm::vec3 smooth_given = towards_eye(point.normal);
    const glm::vec3 smooth = visible_normal(smooth_given, point.face, to_eye);
    const glm::vec3 given =
        bound.normal.pyramid && point.has_tangent
            ? towards_eye(mapped_normal(point, decoded_normal(look_up(bound.normal), material.normal_scale)))
            : smooth_given;
    const glm::vec3 normal = visible_normal(given, point.face, to_eye);

    DielectricReflection reflection;
    if (material.ior != 1.5f || material.specular != 1.0f || material.specular_color != glm::vec3(1.0f) ||
        bound.specular.pyramid || bound.specular_color.pyramid)
        reflection = DielectricReflection::of(material.ior, material.specular * look_up(bound.specular).w,
                                              material.specular_color * glm::vec3(look_up(bound.specular_color)));
    float passed = 0.0f;  // of the light that would be scattered below the surface
    if (material.transmission > 0.0f)
        passed = material.transmission * look_up(bound.transmission).x * (1.0f - metallic);
    Brdf brdf(base, metallic, roughness, glm::dot(normal, to_eye), reflection, scene.options().brdf);
    brdf.scale_diffuse(1.0f - passed);
    Surface surface(brdf, roughness, normal, to_eye);
    if (bound.layered) {
        if (const float coat = material.clearcoat * look_up(bound.coat).x; coat > 0.0f) {
            const glm::vec3 coat_normal =
                bound.coat_normal.pyramid && point.has_tangent
                    ? seen(mapped_normal(point,
                                         decoded_normal(look_up(bound.coat_normal), material.clearcoat_normal_scale)))
                    : smooth;
            surface.add_coat(coat, material.clearcoat_roughness * look_up(bound.coat_roughness).y, coat_normal);
        }
        const glm::vec3 sheen = material.sheen_color * glm::vec3(look_up(bound.sheen_color));
        if (sheen != glm::vec3(0.0f))
            surface.add_sheen(sheen, material.sheen_roughness * look_up(bound.sheen_roughness).w);
    }
    // The samples that see through say nothing of what the surface reflects: the others speak for them.
    const float scale = material.transmission > 0.0f
                            ? 1.0f / (1.0f - see_through(material.transmission * look_up(bound.transmission).x))
                            : 1.0f;

    const Lighting& lighting = scene.lighting();
    glm::vec3 color = surface.below() * material.emissive * glm::vec3(look_up(bound.emissive));
    for (std::size_t i = 0; i < lighting.lights.size(); ++i) {
        const Incoming from = incoming(lighting.lights[i], point.position);
        if (from.irradiance == glm::vec3(0.0f)) continue;
        if (normal != given && glm::dot(given, from.to_light) <= 0.0f) continue;  // bending must not reach the light
        const glm::vec3 reflected = from.irradiance * surface.reflected(from.to_light);
        if (reflected == glm::vec3(0.0f)) continue;
        if (!scene.shadows().casts(i)) {
            color += reflected;
            continue;
        }
        // Facets that are turned away from the light though their smooth normals are not do not shadow themselves.
        const float lift = std::clamp(1.0f - glm::dot(point.face, from.to_light) / LitColor::kGrazing, 0.0f, 1.0f);
        out.shadowed.push_back({static_cast<std::uint32_t>(i), scale * reflected,
                                lift > 0.0f ? lift * (point.bulge * smooth) : glm::vec3(0.0f)});
    }
    if (lighting.ambient()) {
        glm::vec3 ambient = surface.ambient(lighting);
        if (bound.occlusion.pyramid)
            ambient *= 1.0f + material.occlusion_strength * (look_up(bound.occlusion).x - 1.0f);
        color += ambient;
    }
    out.rest = scale * color;
    out.position = point.position;

    // A light that adds less than half a code of 8 bits to what the point shows needs no shadow.
    const auto brightness = [](const glm::vec3& c) { return c.x + c.y + c.z; };
    float total = brightness(out.rest);
    for (const LitColor::Share& share : out.shadowed) total += brightness(share.color);
    std::erase_if(out.shadowed, [&](const LitColor::Share& share) {
        if (brightness(share.color) > LitColor::kNegligible * total) return false;
        out.rest += share.color;
        return true;
    });
}

}  // namespace pentaprism
