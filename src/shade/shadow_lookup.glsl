// Twin of shade/shadow_lookup.h and shadow_receiver.h: how much of a light reaches a point of a triangle, by sixteen samples
// of the light's shadow map. What decides is `precise`: the same operations in the same order as in C++.

#include "shade/shade_point.glsl"
#include "shade/shadow_map.glsl"

const float kFarthestBehind = 12.0, kFarthestBefore = 100.0, kBias = 0.2, kWidestTangent = 1.5;
const int kAttempts = 16, kCell = 32;
const int kStill = 0, kStraight = 1, kInPieces = 2;  // ShadowReceiver::Path

struct WorldPart {
    uint vertex_count;
    int segments, moves, unused;
};

layout(std430, binding = 1) restrict readonly buffer Lanes { vec2 lanes[]; };
layout(std430, binding = 2) restrict readonly buffer WorldParts { WorldPart world_parts[]; };
layout(binding = 3) uniform usamplerBuffer part_of;
layout(binding = 9) uniform samplerBuffer world_points;
layout(binding = 10) uniform usamplerBuffer world_corners;

// Of the look-up at hand.
struct Receiver {
    ShadowFace face;
    uint triangle;
    WorldPart part;
    int path;
    vec3 offset;
};
struct Corners {
    vec3 at[3];
};

Receiver receiver;
uint looked_point, looked_seed, looked_quarters;
int looked_face, level, limit;
float level_scale, half_width;
vec2 from[kShadowLanes], way[kShadowLanes];

Corners corners_at_knot(int knot) {
    Corners made;
    for (int k = 0; k < 3; ++k) {
        int corner = int(texelFetch(world_corners, int(3u * receiver.triangle) + k).r + uint(knot) * receiver.part.vertex_count);
        // LightView::place()
        precise vec3 p = texelFetch(world_points, corner).xyz - receiver.face.position.xyz;
        vec3 x = receiver.face.right.xyz, y = receiver.face.up.xyz, z = receiver.face.forward.xyz;
        precise float along_x = p.x * x.x + p.y * x.y + p.z * x.z;
        precise float along_y = p.x * y.x + p.y * y.y + p.z * y.z;
        precise float along_z = p.x * z.x + p.y * z.y + p.z * z.z;
        made.at[k] = vec3(along_x, along_y, along_z);
    }
    return made;
}

// A share of the way from one knot to the next.
Corners corners_between(int segment, float s) {
    Corners made;
    for (int end = 0; end <= receiver.part.moves; ++end) {
        Corners here = corners_at_knot(segment + end);
        for (int k = 0; k < 3; ++k) {
            precise vec3 between = end == 0 ? here.at[k] : made.at[k] + s * (here.at[k] - made.at[k]);
            made.at[k] = between;
        }
    }
    return made;
}

// Corners at the borders of a quarter; of a straight path, of the shutter.
void corners_of_quarter(int quarter, out Corners begin, out Corners end) {
    int last = receiver.path == kStill ? 0 : 1;
    for (int border = 0; border <= last; ++border) {
        precise float along = float((quarter + border) * receiver.part.segments) / float(kQuarters);
        if (receiver.path != kInPieces) along = float(border);
        int segment = min(int(along), receiver.part.segments - 1);
        precise float s = along - float(segment);
        Corners here = corners_between(segment, s);
        if (border == 0) begin = here;
        if (border == last) end = here;
    }
}

vec3 lane_barycentrics(int lane) {
    vec2 b = lanes[looked_point * uint(kShadowLanes) + uint(lane)];
    return vec3(b, 1.0 - b.x - b.y);
}
bool is_asked(int lane) {
    return (looked_quarters >> (lane / kLookups) & 1u) != 0u;
}

vec3 blend(vec3 b, Corners corners) {
    precise vec3 p = receiver.offset;
    for (int k = 0; k < 3; ++k) p = p + b[k] * corners.at[k];
    return p;
}

// Where the points are when their quarter begins, and the way to where they are when it ends. false: one is behind the light.
bool find_ways(out float reach, out float depth) {
    reach = depth = 0.0;
    Corners begin_corners, end_corners;
    bool known = false;
    for (int lane = 0; lane < kShadowLanes; ++lane) {
        if (!is_asked(lane)) continue;
        int q = lane / kLookups;
        if (lane == 0 || (receiver.path == kInPieces && lane % kLookups == 0) || !known)
            corners_of_quarter(q, begin_corners, end_corners);
        known = true;
        vec3 b = lane_barycentrics(lane), begin = blend(b, begin_corners), end = begin;
        if (receiver.path == kInPieces) end = blend(b, end_corners);
        if (receiver.path == kStraight) {
            vec3 open = begin;
            precise vec3 change = blend(b, end_corners) - open;
            float s = float(q) * 0.25;
            precise vec3 first = open + s * change, last = open + (s + 0.25) * change;
            begin = first, end = last;
        }
        vec2 at = begin.xy, then = end.xy;
        if (receiver.face.perspective != 0) {
            if (!(begin.z > 0.0 && end.z > 0.0)) return false;
            precise vec2 seen_first = begin.xy / begin.z, seen_last = end.xy / end.z;
            at = seen_first, then = seen_last;
            depth = max(depth, max(begin.z, end.z));
        }
        from[lane] = at;
        way[lane] = then - at;
        reach = max(reach, max(max(abs(at.x), abs(at.y)), max(abs(then.x), abs(then.y))));
    }
    return true;
}

// Coarser than asked for if a point would lie beyond the level's edge. false if it lies beyond all.
bool choose_level(float reach, float depth) {
    float away = 1.0;
    vec4 position = shade_points[looked_point].position;
    if (receiver.face.perspective != 0) {
        away = dot(position.xyz - receiver.face.position.xyz, receiver.face.forward.xyz);
        if (!(away > 1e-3)) return false;
        if (!(reach < 0.99 * kWidestTangent)) return false;
    }
    level = level_exponent(receiver.face, position.w / away);
    float edge = half_width - float(kCell);
    while (level < kCoarsest && !(reach < edge * power_of_two(level))) ++level;
    float texel = power_of_two(level);
    level_scale = power_of_two(-level);
    limit = receiver.face.perspective != 0 ? depth_limit(receiver.face, depth * (1.0 + kFarthestBehind * texel))
                                           : kLimits - 1;
    return reach < edge * texel;
}

// Cell (x | y << 16) and index of the sample in it.
ivec2 texel_at(vec2 place, int quarter) {
    precise float x = place.x + half_width, y = half_width - place.y;
    int px = int(x), py = int(y);
    return ivec2(py >> 5 << 16 | px >> 5, ((py & 31) << 5 | (px & 31)) << 2 | quarter);
}

// A map sample tells of the point only if the point is there at the sample's time: texels along the way are tried until
// one is. Returns how far along.
float search_along(vec2 place, vec2 along, float tau, int q) {
    float best = tau, least_miss = uintBitsToFloat(0x7f800000u);
    if (!(max(abs(along.x), abs(along.y)) > 0.5)) return best;
    for (int attempt = 0; attempt < kAttempts; ++attempt) {
        precise vec2 here = place + tau * along;
        ivec2 at = texel_at(here, q);
        precise float late = map_sample(at.x, at.y).z * 4.0 - float(q) - tau;
        float miss = max(abs(late * along.x), abs(late * along.y));
        if (miss < least_miss) {
            least_miss = miss;
            best = tau;
        }
        if (miss <= 0.5) break;
        tau += 0.618034;
        if (tau >= 1.0) tau -= 1.0;
    }
    return best;
}

// Depth by edge functions, which are weights.
float mean_depth(vec3 e, vec3 z, float own) {
    precise float depth = ((e.x * z.x + e.y * z.y) + e.z * z.z) / ((e.x + e.y) + e.z);
    return is_finite(depth) ? depth : own;
}

// The plane of the triangle at the sample's time, seen where the sample is, but no deeper than its nearest edge.
bool is_lit(vec3 b, vec2 seen_at, float t, float occluder, Corners still) {
    Corners now = still;
    if (receiver.path != kStill) {
        precise float along = t * float(receiver.part.segments);
        int segment = min(int(along), receiver.part.segments - 1);
        precise float s = along - float(segment);
        now = corners_between(segment, s);
    }
    precise vec3 X, Y, z;
    for (int k = 0; k < 3; ++k) {
        precise vec3 v = now.at[k] + receiver.offset;
        bool in_perspective = receiver.face.perspective != 0;
        X[k] = v.x * level_scale - (in_perspective ? seen_at.x * v.z : seen_at.x);
        Y[k] = v.y * level_scale - (in_perspective ? seen_at.y * v.z : seen_at.y);
        z[k] = v.z;
    }
    precise vec3 e = X.yzx * Y.zxy - X.zxy * Y.yzx;
    precise float own = (b.x * z.x + b.y * z.y) + b.z * z.z;
    precise float texel = receiver.face.perspective != 0 ? 1.0 / level_scale * own : 1.0 / level_scale;
    precise float depth = mean_depth(e, z, own);
    precise float all = (e.x + e.y) + e.z;
    vec3 inside = max(floatBitsToInt(all) < 0 ? -e : e, vec3(0.0));
    depth = min(depth, mean_depth(inside, z, own));
    depth = max(depth, own - kFarthestBefore * texel);
    depth = min(depth, own + kFarthestBehind * texel);
    precise float farthest = occluder + kBias * texel;
    return depth <= farthest;
}

// Whether light arrives at lane; false in `here`: the cell is not here and was asked for.
bool compare_lane(int lane, Corners still, inout bool here) {
    int q = lane / kLookups, corner = lane % kLookups;
    uint hash = mixed(looked_seed + (uint(q) << 1));
    vec2 jitter = vec2(float(hash & 0xffffu), float(hash >> 16)) * (0.5 / 65536.0);
    precise vec2 shift = (jitter + 0.5 * vec2(float(corner & 1), float(corner >> 1))) - 0.5;
    precise vec2 place = shift + from[lane] * level_scale;
    if (receiver.path != kStill) {
        vec2 along = way[lane] * level_scale;
        float tau = search_along(place, along, 0.5 * jitter.x + 0.25 * float(corner), q);
        place = place + tau * along;
    }
    ivec2 at = texel_at(place, q);
    uvec2 key = key_of(looked_face, level, limit, at.x);
    uint cell;
    if (!find_cell(key, cell)) {
        request_cell(key);
        here = false;
        return true;
    }
    if (cell == kEmptyCell) return true;
    float occluder = texelFetch(map_depths, int(cell) * kSamplesPerCell + at.y).r;
    if (isinf(occluder)) return true;
    vec3 seen_sample = map_sample(at.x, at.y);
    float to_middle = half_width - 0.5 * float(kCell);
    precise vec2 seen_at = seen_sample.xy + vec2(float(at.x & 0xffff) * float(kCell) - to_middle,
                                                 to_middle - float(at.x >> 16) * float(kCell));
    return is_lit(lane_barycentrics(lane), seen_at, seen_sample.z, occluder, still);
}

// Bit for each lane: light arrives, or its quarter is not asked for. `here`: all cells were.
uint lit_lanes(uint point, int face, vec3 offset, uint seed, out bool here) {
    here = true;
    looked_point = point;
    looked_face = face;
    looked_seed = seed;
    looked_quarters = shade_points[point].quarters;
    receiver.face = faces[face];
    receiver.triangle = shade_points[point].triangle;
    receiver.part = world_parts[texelFetch(part_of, int(receiver.triangle)).r];
    receiver.path = receiver.part.moves == 0 ? kStill : receiver.part.segments == 1 ? kStraight : kInPieces;
    receiver.offset = vec3(0.0);
    if (offset != vec3(0.0))
        receiver.offset = vec3(dot(receiver.face.right.xyz, offset), dot(receiver.face.up.xyz, offset),
                               dot(receiver.face.forward.xyz, offset));
    half_width = 0.5 * float(receiver.face.width);
    float reach, depth;
    if (!find_ways(reach, depth) || !choose_level(reach, depth)) return 0xffffu;
    Corners still = corners_at_knot(0);
    uint lit = 0u;
    for (int lane = 0; lane < kShadowLanes; ++lane)
        if (!is_asked(lane) || compare_lane(lane, still, here)) lit |= 1u << lane;
    return lit;
}
