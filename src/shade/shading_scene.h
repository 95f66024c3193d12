#pragma once
// What shading looks up: the frame's geometry in world space at mid-shutter, bound materials and lights.

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <pentaprism/scene.h>
#include <span>
#include <vector>

#include "frame/frame.h"
#include "shade/footprint.h"
#include "shade/lights.h"
#include "shade/shadows.h"

namespace pentaprism {

struct BoundMaterial {
    Material material;
    BoundTexture base_color, metallic_roughness, normal, occlusion, emissive;
    BoundTexture specular, specular_color, coat, coat_roughness, coat_normal, sheen_color, sheen_roughness,
        transmission;
    bool textured = false;  ///< any of them
    bool layered = false;   ///< has a coat, a sheen or lets light through
};

/// A placed primitive at mid-shutter.
struct ShadedPart {
    const Primitive* primitive = nullptr;
    const BoundMaterial* material = nullptr;
    std::span<const glm::vec3> positions;  ///< of each vertex, relative to the eye: world axes
    std::vector<glm::vec3> normals;        ///< unit
    std::vector<glm::vec4> tangents;       ///< where the material has a normal map
};

/// What shares one evaluation: the samples of a pixel and a triangle, those that see a cell of the triangle
/// (shaded_triangle.h), or none.
enum class ShadingRate : std::uint8_t { kPixel, kDecoupled, kSample };

struct ShadingOptions {
    ShadowMode shadows = ShadowMode::kMoving;
    BrdfModel brdf = BrdfModel::kGltf;
    TextureFilter texture_filter = TextureFilter::kFull;
    ShadingRate rate = ShadingRate::kPixel;
    std::shared_ptr<const Environment> environment;
};

class ShadingScene {
  public:
    /// Poses all parts of the frame. The frame, its scene and its textures must outlive this.
    explicit ShadingScene(const Frame& frame, const ShadingOptions& options = {});
    ShadingScene(const ShadingScene&) = delete;
    ShadingScene& operator=(const ShadingScene&) = delete;

    const Frame& frame() const { return frame_; }
    const std::vector<ShadedPart>& parts() const { return parts_; }  ///< as Frame::parts
    const ShadedPart& part_of(std::uint32_t triangle) const { return parts_[frame_.part_of[triangle]]; }
    /// Of the scene, then the default one; those of the parts are among them.
    const std::vector<BoundMaterial>& materials() const { return materials_; }
    const ShadingOptions& options() const { return options_; }
    const Lighting& lighting() const { return lighting_; }
    const Shadows& shadows() const { return *shadows_; }

    /// Variance of a texture's footprint over shutter and lens that one evaluation stands for. All of it, where it
    /// serves a whole pixel; where each of `spp` samples picks its own, the samples average over motion and lens
    /// themselves, and what falls to each has a width of N^-0.4 (measured; four dimensions would say -0.25 to -0.5).
    float blur_share(int spp) const;

    /// How large a texel of a shadow map should be there, metres: a pixel, and a quarter of what defocus blurs.
    float shadow_texel(const glm::vec3& position) const;

    /// What is seen where nothing is hit; false: nothing.
    bool has_background() const { return options_.environment != nullptr; }
    /// At (gx, gy) pixels from the middle of the picture, y up, through (u, v) of the lens at time t: what is
    /// infinitely far away.
    glm::vec3 background(float gx, float gy, float u, float v, float t) const;

    /// Unit vector against the direction of view.
    const glm::vec3& backwards() const { return backwards_; }

    /// Unit vector from a point to the eye; for an orthographic camera the same everywhere.
    glm::vec3 to_eye(const glm::vec3& position) const;

  private:
    const Frame& frame_;
    ShadingOptions options_;
    std::vector<BoundMaterial> materials_;  // the scene's, then the default one
    std::vector<ShadedPart> parts_;
    std::vector<UninitializedVector<glm::vec3>> positions_;  // of parts whose points the shadows do not have
    Lighting lighting_;
    std::unique_ptr<const Shadows> shadows_;
    struct CameraKnot {
        glm::mat3 to_world;
        View view;
    };
    std::vector<CameraKnot> cameras_;  // at the knots of the shutter; for backgrounds
    glm::vec3 backwards_;              // against the direction of view
};

}  // namespace pentaprism
