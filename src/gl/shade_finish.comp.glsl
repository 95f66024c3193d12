// Last of four: what shadows leave of each point's light in each quarter of the shutter (TileShader::light_quarters()).

layout(local_size_x = 64) in;

#include "shade/shade_point.glsl"

uniform int casting_lights;
uniform bool by_quarters;

layout(std430, binding = 1) restrict writeonly buffer Colors { vec4 colors[]; };  // [point][quarter]
layout(std430, binding = 7) restrict readonly buffer Shares { Share shares[]; };

const float kBrightest = 1048576.0;

float contained(float x) {
    return !isinf(x) && !isnan(x) ? clamp(x, 0.0, kBrightest) : 0.0;
}

void main() {
    uint item = item_index();
    if (item >= point_count) return;
    uint index = first_point + item;
    vec3 color[kQuarters];
    for (int q = 0; q < kQuarters; ++q) color[q] = shade_points[index].rest.rgb;
    for (int k = 0; k < casting_lights; ++k) {
        Share share = shares[item * uint(casting_lights) + uint(k)];
        if (share.state == kNoShare) continue;
        float part[kQuarters];
        for (int q = 0; q < kQuarters; ++q) part[q] = 0.25 * float(bitCount(share.lit >> (kLookups * q) & 15u));
        if (!by_quarters) part[0] = 0.25 * (part[0] + part[1] + part[2] + part[3]);
        for (int q = 0; q < kQuarters; ++q) color[q] += part[q] * share.color;
    }
    for (int q = 0; q < kQuarters; ++q)
        colors[4u * index + uint(q)] = vec4(contained(color[q].r), contained(color[q].g), contained(color[q].b), 1.0);
}
