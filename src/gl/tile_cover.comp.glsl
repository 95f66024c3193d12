// Third of three: a group for each tile, an invocation for each of its pixels. The group shears 64 triangles of the tile's
// list at a time, one each, to the middle of the cell; then each pixel asks for all of its samples and all 64 the culling
// test, the exact test and whether what it hits is nearer.

layout(local_size_x = 8, local_size_y = 8) in;

#include "cover/exact.glsl"
#include "bound/screen_bounds.glsl"
#include "culling"
#include "frame/opacity.glsl"
#include "gl/samples.glsl"
#include "gl/tiles.glsl"

uniform ivec2 first_group;   // the tile of the first
uniform ivec2 some_tiles;  // those that have lists: from, to
uniform uvec2 some_entries;  // of each list: from, to

layout(binding = 0) uniform usamplerBuffer sample_points;
layout(binding = 0, r32ui) uniform restrict uimage2D tested;  // exact tests of each pixel
layout(binding = 1, r32ui) uniform restrict uimage2D covered;

layout(std430, binding = 0) restrict buffer Hits { uvec2 hits[]; };  // triangle, bits of its depth
layout(std430, binding = 5) restrict readonly buffer Records { uvec4 records[]; };
layout(std430, binding = 6) restrict readonly buffer Ends { uint ends[]; };  // of each tile's list
layout(std430, binding = 7) restrict readonly buffer Entries { uint entries[]; };

shared LocalTriangle triangles[kTilePixels];
shared uvec4 kept[kTilePixels];  // their records

void fetch(uint entry, uint place, vec2 centre) {
    uvec4 record = records[entries[entry]];
    Draw d = draws[record.y];
    MovingTriangle m = moving_triangle(d, record.x);
    vec4 box = vec4(-1.0, 1.0, -1.0, 1.0) * kEverywhere;
    if (reaches_camera(m)) box = exact_box(m, screen_bounds(m));
    triangles[place] = localize(m, box, centre, float(d.segments), float(d.segment), d.two_sided != 0u);
    kept[place] = record;
}

// Counts of the pixel: tested, covered.
uvec2 cover_pixel(uint place, ivec2 pixel, vec2 centre) {
    uvec4 record = kept[place];
    ivec4 p = pixels_of(record);
    uvec2 counts = uvec2(0u);
    if (pixel.x < p.x || pixel.x >= p.y || pixel.y < p.z || pixel.y >= p.w) return counts;
    LocalTriangle T = triangles[place];
    for (int slot = 0; slot < pass_slots; ++slot) {
        int entry = entry_of(pixel, slot);
        uvec4 packed_sample = texelFetch(sample_points, entry);
        LocalSample point = unpack_sample(packed_sample);
        float fraction = segment_time(T, point.t);
        if (!(fraction >= 0.0 && fraction < 1.0) || !culling_keeps(T, point, pixel % kCellSize)) continue;
        ++counts.x;
        SampleHit hit = cover_sample(T, point, centre);
        if (!hit.hit) continue;
        ++counts.y;
        uvec2 known = hits[entry];
        float depth = uintBitsToFloat(known.y);
        if (!(hit.depth < depth || (hit.depth == depth && record.x < known.x))) continue;
        Draw d = draws[record.y];
        if (is_opaque_at(surface_of(int(d.part)), record.x, record.x - d.first_of_part, hit.barycentrics, pixel,
                         index_of(packed_sample)))
            hits[entry] = uvec2(record.x, floatBitsToUint(hit.depth));
    }
    return counts;
}

void main() {
    ivec2 tile = first_group + ivec2(gl_WorkGroupID.xy);
    int index = tile.y * tiles.x + tile.x;
    if (index < some_tiles.x || index >= some_tiles.y) return;
    ivec2 pixel = (first_tile + tile) * kTile + ivec2(gl_LocalInvocationID.xy);
    bool is_wanted = pixel.x >= region.x && pixel.x < region.y && pixel.y >= region.z && pixel.y < region.w;
    vec2 centre = cell_centre(pixel / kCellSize);
    uint own = gl_LocalInvocationIndex, begin = index == some_tiles.x ? 0u : ends[index - 1];
    uint end = min(ends[index], begin + some_entries.y);
    uvec2 counts = uvec2(0u);
    for (uint first = begin + some_entries.x; first < end; first += kTilePixels) {
        uint count = min(end - first, kTilePixels);
        barrier();
        if (own < count) fetch(first + own, own, centre);
        barrier();
        if (is_wanted)
            for (uint k = 0u; k < count; ++k) counts += cover_pixel(k, pixel, centre);
    }
    if (!is_wanted || counts.x == 0u) return;
    ivec2 place = pixel - region.xz;
    imageAtomicAdd(tested, place, counts.x);
    imageAtomicAdd(covered, place, counts.y);
}
