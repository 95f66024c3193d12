// Twin of shade/lights.h.

#include "shade/environment.glsl"

const int kDirectional = 0, kPoint = 1, kSpot = 2;  // LightKind

struct PosedLight {
    vec4 position;   // w: kind
    vec4 direction;  // w: range; 0: no end
    vec4 intensity;  // w: cone_scale
    float cone_offset;
    int share;        // which of those that cast shadows; -1: casts none
    int first_face, faces;  // of its shadow maps
};

layout(std430, binding = 5) restrict readonly buffer Lights { PosedLight lights[]; };

uniform int light_count, casting_lights;
uniform bool with_ambient, with_environment;
uniform vec4 sky_light, ground_light;

struct Incoming {
    vec3 to_light, irradiance;
};

Incoming incoming(PosedLight light, vec3 position) {
    int kind = int(light.position.w);
    if (kind == kDirectional) return Incoming(-light.direction.xyz, light.intensity.rgb);
    vec3 path = light.position.xyz - position;
    float distance2 = max(dot(path, path), 1e-12), dist = sqrt(distance2);
    vec3 to_light = path / dist;
    float share = 1.0 / distance2;
    if (light.direction.w > 0.0) {
        float ratio = dist / light.direction.w, ratio2 = ratio * ratio;
        share *= clamp(1.0 - ratio2 * ratio2, 0.0, 1.0);
    }
    if (kind == kSpot) {
        float cone = clamp(dot(-to_light, light.direction.xyz) * light.intensity.w + light.cone_offset, 0.0, 1.0);
        share *= cone * cone;
    }
    return Incoming(to_light, light.intensity.rgb * share);
}

vec3 between_sky_and_ground(vec3 n) {
    return ground_light.rgb + (sky_light.rgb - ground_light.rgb) * (0.5 + 0.5 * n.y);
}
vec3 lighting_matte(vec3 normal) {
    return with_environment ? environment_matte(normal) : between_sky_and_ground(normal);
}
vec3 lighting_shiny(vec3 direction, float roughness) {
    return with_environment ? environment_shiny(direction, roughness) : between_sky_and_ground(direction);
}
