// Twin of shade/environment.h: how the surroundings light what is there.

#include "scene/texture.glsl"

const float kPi = 3.14159265358979324;
const int kSkyLevels = 6;

layout(binding = 8) uniform samplerBuffer sky_texels;

vec3 sky_texel(ivec4 level, int column, int row) {
    return texelFetch(sky_texels, level.z + row * level.x + column).rgb;
}

// Environment::Map::bilinear()
vec3 sky_level(int number, vec3 direction) {
    ivec4 level = sky_levels[number];
    float longitude = direction.x == 0.0 && direction.z == 0.0 ? 0.0 : atan(direction.x, -direction.z);
    float polar = acos(clamp(direction.y, -1.0, 1.0));
    float x = (longitude / (2.0 * kPi) + 0.5) * float(level.x) - 0.5;
    float y = clamp(polar / kPi * float(level.y) - 0.5, 0.0, float(level.y - 1));
    float fx = floor(x);
    int i = (int(fx) + level.x) % level.x, j = min(int(y), level.y - 1);
    int right = (i + 1) % level.x, below = min(j + 1, level.y - 1);
    return mix(mix(sky_texel(level, i, j), sky_texel(level, right, j), x - fx),
               mix(sky_texel(level, i, below), sky_texel(level, right, below), x - fx), y - float(j));
}

vec3 environment_matte(vec3 d) {
    vec3 sum = 0.282095 * harmonics[0].rgb;
    sum += 0.488603 * d.y * harmonics[1].rgb;
    sum += 0.488603 * d.z * harmonics[2].rgb;
    sum += 0.488603 * d.x * harmonics[3].rgb;
    sum += 1.092548 * d.x * d.y * harmonics[4].rgb;
    sum += 1.092548 * d.y * d.z * harmonics[5].rgb;
    sum += 0.315392 * (3.0 * d.z * d.z - 1.0) * harmonics[6].rgb;
    sum += 1.092548 * d.x * d.z * harmonics[7].rgb;
    sum += 0.546274 * (d.x * d.x - d.y * d.y) * harmonics[8].rgb;
    return max(sum, vec3(0.0));
}

vec3 environment_shiny(vec3 direction, float roughness) {
    float level = clamp(roughness, 0.0, 1.0) * float(kSkyLevels - 1);
    int fine = min(int(level), kSkyLevels - 2);
    float share = level - float(fine);
    vec3 color = vec3(0.0);
    int last = share > 0.0 ? fine + 1 : fine;
    for (int i = fine; i <= last; ++i) {
        vec3 here = sky_level(i, direction);
        color = i == fine ? here : mix(color, here, share);
    }
    return color;
}
