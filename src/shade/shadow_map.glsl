// Twin of what shade/shadow_map.h tells of a map, and the cells of it that are here. A cell is drawn by the processor when a
// look-up has asked for it.

#include "sample/net.glsl"

const int kCoarsest = 24, kFinest = -24, kLimits = 24, kLeastLimit = -8;

// ShadowMap and its LightView.
struct ShadowFace {
    vec4 position, right, up, forward;
    int perspective, width, least_exponent, unused;
};

const uint kEmptyCell = 0xffffffffu;

layout(std430, binding = 3) restrict readonly buffer Faces { ShadowFace faces[]; };
// Open addressing: x | y << 16; map, exponent and limit; cell + 1, or 0: an empty entry.
layout(std430, binding = 4) restrict readonly buffer Pages { uvec4 pages[]; };
layout(std430, binding = 6) restrict buffer Requests {
    uint request_count, missing;
    uint marks[4096];  // so that not all ask for the same
    uvec2 requests[];
};
layout(binding = 11) uniform samplerBuffer map_samples;  // x, y, t of each sample of 16 cells
layout(binding = 12) uniform samplerBuffer map_depths;   // of each cell

uniform uint page_mask, most_requests, map_seed;

const int kSamplesPerCell = 32 * 32 * 4;

uint hash_of(uvec2 key) {
    return mixed(key.x ^ mixed(key.y));
}

uvec2 key_of(int face, int exponent, int limit, int cell) {
    return uvec2(uint(cell), uint(face) << 16 | uint(exponent - kFinest) << 8 | uint(limit));
}

// The cell's number, kEmptyCell if nothing is in it. false: it is not here.
bool find_cell(uvec2 key, out uint cell) {
    for (uint at = hash_of(key) & page_mask;; at = (at + 1u) & page_mask) {
        uvec4 entry = pages[at];
        if (entry.z == 0u) return false;
        if (entry.xy == key) {
            cell = entry.z - 1u;
            if (entry.w != 0u) cell = kEmptyCell;
            return true;
        }
    }
}

void request_cell(uvec2 key) {
    uint hash = hash_of(key);
    if (atomicExchange(marks[hash & 4095u], hash | 1u) == (hash | 1u)) return;
    uint at = atomicAdd(request_count, 1u);
    if (at < most_requests) requests[at] = key;
}

// ShadowSamples::index_of()
int samples_cell(int cell) {
    int cx = cell & 0xffff, cy = cell >> 16;
    uint hash = mixed(mixed(uint(cx / 4) + map_seed) + uint(cy / 4));
    uint x = uint(cx) + (hash & 0xffu), y = uint(cy) + (hash >> 8 & 0xffu);
    return int(y % 4u * 4u + x % 4u);
}

vec3 map_sample(int cell, int index) {
    return texelFetch(map_samples, samples_cell(cell) * kSamplesPerCell + index).xyz;
}

int exponent_in(float x) {  // std::ilogb of what is above 0
    return int(floatBitsToUint(x) >> 23 & 0xffu) - 127;
}
bool is_finite(float x) {
    return !isinf(x) && !isnan(x);
}
float power_of_two(int exponent) {
    return uintBitsToFloat(uint(exponent + 127) << 23);
}

// ShadowMap::exponent_of() and limit_of().
int level_exponent(ShadowFace face, float texel) {
    return texel > 0.0 && is_finite(texel) ? clamp(exponent_in(texel), face.least_exponent, kCoarsest) : kCoarsest;
}
int depth_limit(ShadowFace face, float depth) {
    if (face.perspective == 0 || !is_finite(depth)) return kLimits - 1;
    return clamp((depth > 0.0 ? exponent_in(depth) : -127) + 1 - kLeastLimit, 0, kLimits - 1);
}
