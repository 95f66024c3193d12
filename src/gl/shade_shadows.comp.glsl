// Third of four: an invocation for each light of each point. Where a cell of a shadow map is not here the share stays open, and
// is asked again when the processor has drawn the cell.

layout(local_size_x = 64) in;

#include "shade/shadow_lookup.glsl"

struct PosedLight {  // shade/lights.glsl
    vec4 position, direction, intensity;
    float cone_offset;
    int share, first_face, faces;
};

layout(std430, binding = 5) restrict readonly buffer Lights { PosedLight lights[]; };
layout(std430, binding = 7) restrict buffer Shares { Share shares[]; };

uniform int light_count, casting_lights;
uniform uint first_share, share_count;  // of this dispatch

int light_of(int share) {
    for (int i = 0; i < light_count; ++i)
        if (lights[i].share == share) return i;
    return 0;
}

void main() {
    uint item = first_share + item_index();
    if (item >= first_share + share_count || shares[item].state != kOpenShare) return;
    uint point = first_point + item / uint(casting_lights);
    int light = light_of(int(item % uint(casting_lights)));
    int face = lights[light].first_face;
    if (lights[light].faces > 1) {
        vec3 from_light = shade_points[point].position.xyz - lights[light].position.xyz, size = abs(from_light);
        int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
        face += 2 * axis + (from_light[axis] < 0.0 ? 1 : 0);
    }
    // seed_of() of shade/shade_tile.cpp
    uint pixel = shade_points[point].pixel;
    uint seed = mixed(mixed((pixel & 0xffffu) + 0x9e3779b9u * shade_points[point].front) + (pixel >> 16)) + 8u * uint(light);
    bool here;
    uint lit = lit_lanes(point, face, shares[item].offset, seed, here);
    if (!here) {
        atomicAdd(missing, 1u);
        return;
    }
    shares[item].lit = lit;
    shares[item].state = kDoneShare;
}
