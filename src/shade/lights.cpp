#include "shade/lights.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec4.hpp>

namespace pentaprism {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

PosedLight posed(const Light& light, const glm::dmat4& world, const glm::dvec3& eye) {
    const glm::dvec3 axis = -glm::dvec3(world[2]);
    const double length = glm::length(axis);
    PosedLight out;
    out.kind = light.kind;
    out.position = glm::vec3(glm::dvec3(world[3]) - eye);
    out.direction = length > 0.0 ? glm::vec3(axis / length) : glm::vec3(0.0f, 0.0f, -1.0f);
    out.intensity = light.color * light.intensity;
    out.range = light.range;
    const float outer = std::cos(light.outer_cone);
    out.cone_scale = 1.0f / std::max(0.001f, std::cos(light.inner_cone) - outer);
    out.cone_offset = -outer * out.cone_scale;
    out.outer_cone = light.outer_cone;
    return out;
}

PosedLight sun(const glm::vec3& from, const glm::vec3& lux) {
    return {LightKind::kDirectional, glm::vec3(0.0f), -glm::normalize(from), lux, kInfinity, 1.0f, 0.0f};
}

Lighting default_lighting() {
    Lighting lighting;
    lighting.lights.push_back(sun({0.5f, 0.9f, 0.6f}, {2.3f, 2.2f, 2.05f}));
    lighting.lights.push_back(sun({-0.8f, 0.3f, -0.4f}, {0.35f, 0.42f, 0.55f}));
    lighting.lights.back().casts_shadow = false;  // a second sun's shadows would look odd; it stands for more sky
    lighting.sky = {0.36f, 0.40f, 0.46f};
    lighting.ground = {0.16f, 0.14f, 0.12f};
    return lighting;
}

float saturate(float x) {
    return std::clamp(x, 0.0f, 1.0f);
}

}  // namespace

Lighting pose_lights(const Frame& frame, const glm::dvec3& eye, const Environment* environment) {
    const Scene& scene = *frame.scene;
    Lighting lighting;
    for (std::size_t i = 0; i < scene.nodes.size(); ++i) {
        const Node& node = scene.nodes[i];
        if (node.light == kNone || !node.visible || i >= frame.middle.world.size()) continue;
        lighting.lights.push_back(posed(scene.lights[node.light], frame.middle.world[i], eye));
    }
    if (environment) {
        lighting.environment = environment;
        if (const auto& light = environment->sun()) lighting.lights.push_back(sun(light->direction, light->irradiance));
        return lighting;
    }
    return lighting.lights.empty() ? default_lighting() : lighting;
}

Incoming incoming(const PosedLight& light, const glm::vec3& position) {
    if (light.kind == LightKind::kDirectional) return {-light.direction, light.intensity};
    const glm::vec3 path = light.position - position;
    const float distance2 = std::max(glm::dot(path, path), 1e-12f), distance = std::sqrt(distance2);
    const glm::vec3 to_light = path / distance;
    float share = 1.0f / distance2;
    if (light.range < kInfinity && light.range > 0.0f) {
        const float ratio = distance / light.range, ratio2 = ratio * ratio;
        share *= saturate(1.0f - ratio2 * ratio2);
    }
    if (light.kind == LightKind::kSpot) {
        const float cone = saturate(glm::dot(-to_light, light.direction) * light.cone_scale + light.cone_offset);
        share *= cone * cone;
    }
    return {to_light, light.intensity * share};
}

}  // namespace pentaprism
