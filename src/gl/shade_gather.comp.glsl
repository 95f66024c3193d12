// First of four: which points a pixel's samples see, one for each side of each triangle (TileShader::shade_pixels()). An
// invocation for each sample; the first that sees a triangle speaks for all of its pixel.

layout(local_size_x = 64) in;

#include "gl/sample_bits.glsl"
#include "shade/seen_samples.glsl"
#include "shade/shade_point.glsl"
#include "shade/shaded_part.glsl"

const uint kNoTriangle = 0xffffffffu;

uniform uint sample_count, samples_of_pixel;
uniform ivec2 region_cell;  // of the region's top left pixel
uniform int region_cell_columns;
uniform uint first_block;    // of the region's blocks, 64 in each cell
uniform bool by_quarters;    // shadows change while the shutter is open
uniform bool with_lanes;

layout(std430, binding = 1) restrict writeonly buffer Lanes { vec2 lanes[]; };  // two barycentrics of each shadow look-up
// [pixel][sample index]; a pixel is 16 * (block) + lane.
layout(std430, binding = 3) restrict readonly buffer Samples { uvec4 samples[]; };
layout(std430, binding = 4) restrict readonly buffer Seen { uint seen[]; };
layout(std430, binding = 5) restrict writeonly buffer PointOfSample { uint point_of_sample[]; };  // 4 * point + quarter
layout(std430, binding = 6) restrict buffer Counter { uint next_point; };

ivec2 pixel_of(uint pixel) {
    uint block = first_block + pixel / 16u, lane = pixel % 16u;
    int cell = int(block) / (kCellBlocks * kCellBlocks), in_cell = int(block) % (kCellBlocks * kCellBlocks);
    ivec2 corner = region_cell + ivec2(cell % region_cell_columns, cell / region_cell_columns);
    return corner * kCellSize + ivec2(in_cell % kCellBlocks, in_cell / kCellBlocks) * kBlockSize +
           ivec2(int(lane) % kBlockSize, int(lane) / kBlockSize);
}

// FewPoints of a quarter, of each side: [side][quarter][look-up].
vec2 few[2 * kQuarters * kLookups];
int few_count[2 * kQuarters], few_seen[2 * kQuarters], few_stride[2 * kQuarters];

void add_few(int list, vec2 b) {
    if (few_seen[list]++ % few_stride[list] != 0) return;
    if (few_count[list] == kLookups) {
        few[list * kLookups + 1] = few[list * kLookups + 2];
        few_count[list] = kLookups / 2;
        few_stride[list] *= 2;
    }
    few[list * kLookups + few_count[list]++] = b;
}

void main() {
    uint own = item_index();
    if (own >= sample_count) return;
    uint triangle = seen[own];
    if (triangle == kNoTriangle) {
        point_of_sample[own] = kNoTriangle;
        return;
    }
    uint pixel = own / samples_of_pixel, begin = pixel * samples_of_pixel;
    for (uint i = begin; i < own; ++i)
        if (seen[i] == triangle) return;

    ShadedPart part = parts[texelFetch(part_of, int(triangle)).r];
    ivec2 place = pixel_of(pixel);
    vec2 centre = cell_centre(place / kCellSize);
    for (int list = 0; list < 2 * kQuarters; ++list) {
        few_count[list] = few_seen[list] = 0;
        few_stride[list] = 1;
    }
    int segments = part.moves != 0 ? part.segments : 1, known = -1;
    uint number[2] = uint[2](kNoTriangle, kNoTriangle), quarters[2] = uint[2](0u, 0u);
    vec3 sum[2] = vec3[2](vec3(0.0), vec3(0.0));
    float count[2] = float[2](0.0, 0.0);
    LocalTriangle T;
    for (uint i = own; i < begin + samples_of_pixel; ++i) {
        if (seen[i] != triangle) continue;
        LocalSample point = unpack_sample(samples[i]);
        int segment = segment_at(point.t, segments);
        if (segment != known)
            T = localize(moving_triangle(part, triangle, segment), vec4(0.0), centre, float(segments), float(segment), true);
        known = segment;
        bool front;
        vec3 b = seen_barycentrics(T, point, front);
        int side = front ? 1 : 0, quarter = by_quarters ? min(int(point.t * float(kQuarters)), kQuarters - 1) : 0;
        if (number[side] == kNoTriangle) number[side] = atomicAdd(next_point, 1u);
        sum[side] += b;
        count[side] += 1.0;
        quarters[side] |= 1u << quarter;
        if (with_lanes) add_few(side * kQuarters + quarter, b.xy);
        point_of_sample[i] = 4u * number[side] + uint(quarter);
    }
    for (int side = 0; side < 2; ++side) {
        if (number[side] == kNoTriangle) continue;
        ShadePoint point;
        point.triangle = triangle;
        point.pixel = uint(place.x) | uint(place.y) << 16;
        point.front = uint(side);
        point.quarters = by_quarters ? quarters[side] : 15u;
        point.barycentrics = vec4(sum[side] / count[side], 0.0);
        point.rest = point.position = vec4(0.0);
        shade_points[number[side]] = point;
        if (!with_lanes) continue;
        for (int lane = 0; lane < kShadowLanes; ++lane) {
            int list = side * kQuarters + (by_quarters ? lane / kLookups : 0);
            if (few_count[list] > 0)
                lanes[number[side] * uint(kShadowLanes) + uint(lane)] =
                    few[list * kLookups + lane % kLookups % few_count[list]];
        }
    }
}
