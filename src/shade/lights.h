#pragma once
// The lights of a frame at mid-shutter (KHR_lights_punctual), relative to the camera.

#include <glm/vec3.hpp>
#include <vector>

#include "frame/frame.h"
#include "shade/environment.h"

namespace pentaprism {

struct PosedLight {
    LightKind kind;
    glm::vec3 position;   ///< relative to the eye; unused if directional
    glm::vec3 direction;  ///< unit: the way the light travels; unused for a point light
    glm::vec3 intensity;  ///< lux, candela
    float range;
    float cone_scale, cone_offset;  ///< spot: share = saturate(cos * scale + offset)^2
    float outer_cone = 0.0f;        ///< spot: half angle
    bool casts_shadow = true;
};

/// Light that comes to a point: `irradiance` on a surface that faces it, from direction `to_light` (unit).
struct Incoming {
    glm::vec3 to_light, irradiance;
};

struct Lighting {
    std::vector<PosedLight> lights;
    /// Uniform light from above and from below; black unless the scene has no lights of its own.
    glm::vec3 sky{0.0f}, ground{0.0f};
    const Environment* environment = nullptr;  ///< instead of sky and ground; not owned
    bool ambient() const { return environment || sky != glm::vec3(0.0f) || ground != glm::vec3(0.0f); }

    /// What a white matte surface with this normal shows of the light from all around.
    glm::vec3 matte(const glm::vec3& normal) const {
        return environment ? environment->matte(normal) : between(normal);
    }
    /// What a mirror of this roughness shows in that direction.
    glm::vec3 shiny(const glm::vec3& direction, float roughness) const {
        return environment ? environment->shiny(direction, roughness) : between(direction);
    }

  private:
    glm::vec3 between(const glm::vec3& n) const { return ground + (sky - ground) * (0.5f + 0.5f * n.y); }
};

/// The visible lights of the scene, and the environment with its sun. A scene without either is lit by a key light from
/// above, a weak one from the other side and a pale sky, all fixed in the world.
Lighting pose_lights(const Frame& frame, const glm::dvec3& eye, const Environment* environment);

Incoming incoming(const PosedLight& light, const glm::vec3& position);

}  // namespace pentaprism
