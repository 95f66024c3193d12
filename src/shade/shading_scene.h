#pragma once
// What shading looks up: the frame's geometry in world space at mid-shutter, bound materials and lights.

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <pentaprism/scene.h>
#include <vector>

#include "frame/frame.h"
#include "shade/footprint.h"
#include "shade/lights.h"
#include "shade/shadows.h"

namespace pentaprism {

struct BoundMaterial {
    Material material;
    BoundTexture base_color, metallic_roughness, occlusion, emissive;
    bool textured = false;  ///< any of them
};

/// A placed primitive at mid-shutter.
struct ShadedPart {
    const Primitive* primitive = nullptr;
    const BoundMaterial* material = nullptr;
    std::vector<glm::vec3> positions;  ///< of each vertex, relative to the eye: world axes
    std::vector<glm::vec3> normals;    ///< unit
};

struct ShadingOptions {
    ShadowMode shadows = ShadowMode::kMoving;
};

class ShadingScene {
  public:
    /// Poses all parts of the frame. The frame, its scene and its textures must outlive this.
    explicit ShadingScene(const Frame& frame, const ShadingOptions& options = {});
    ShadingScene(const ShadingScene&) = delete;
    ShadingScene& operator=(const ShadingScene&) = delete;

    const Frame& frame() const { return frame_; }
    const ShadedPart& part_of(std::uint32_t triangle) const { return parts_[frame_.part_of[triangle]]; }
    const Lighting& lighting() const { return lighting_; }
    const Shadows& shadows() const { return *shadows_; }

    /// How large a texel of a shadow map should be there, metres: a pixel, and a quarter of what defocus blurs.
    float shadow_texel(const glm::vec3& position) const;

    /// Unit vector from a point to the eye; for an orthographic camera the same everywhere.
    glm::vec3 to_eye(const glm::vec3& position) const;

  private:
    const Frame& frame_;
    std::vector<BoundMaterial> materials_;  // the scene's, then the default one
    std::vector<ShadedPart> parts_;
    Lighting lighting_;
    std::unique_ptr<const Shadows> shadows_;
    glm::vec3 backwards_;  // against the direction of view
};

}  // namespace pentaprism
