// One sample of one pixel in the bound of a triangle: the culling test, then the exact coverage test, then the depth test
// of the framebuffer, which keeps the nearest and, of equals, the first: triangles come in the order of their indices.

#include "cover/exact.glsl"
#include "culling"
#include "frame/opacity.glsl"
#include "gl/samples.glsl"

uniform ivec4 region;
uniform int part;
uniform uint first_triangle;  // of the part
uniform float segments, segment;
uniform bool two_sided;

layout(binding = 0) uniform usamplerBuffer sample_points;
layout(binding = 0, r32ui) uniform restrict uimage2D tested;  // exact tests of each pixel
layout(binding = 1, r32ui) uniform restrict uimage2D covered;

in Bound {
    flat vec4 q[3];
    flat vec4 r[3];
    flat vec3 z_q;
    flat vec3 z_r;
    flat vec4 box;
    flat ivec4 pixels;
    flat uint triangle;
} bound;

layout(location = 0) out uvec2 seen;  // triangle, bits of its depth

void main() {
    if (gl_SampleID >= pass_slots) discard;
    ivec2 place = ivec2(gl_FragCoord.xy), pixel = place + region.xz;
    ivec4 p = bound.pixels;
    if (pixel.x < p.x || pixel.x >= p.y || pixel.y < p.z || pixel.y >= p.w) discard;
    vec2 centre = cell_centre(pixel / kCellSize);
    LocalTriangle T = localize(MovingTriangle(bound.q, bound.r, bound.z_q, bound.z_r), bound.box, centre, segments, segment,
                               two_sided);
    uvec4 packed_sample = texelFetch(sample_points, entry_of(pixel, gl_SampleID));
    LocalSample point = unpack_sample(packed_sample);
    // Samples of another segment of the path are that segment's; no test has to find that out.
    float fraction = segment_time(T, point.t);
    if (!(fraction >= 0.0 && fraction < 1.0)) discard;
    if (!culling_keeps(T, point, pixel % kCellSize)) discard;
    imageAtomicAdd(tested, place, 1u);
    SampleHit hit = cover_sample(T, point, centre);
    if (!hit.hit) discard;
    imageAtomicAdd(covered, place, 1u);
    if (!is_opaque_at(surface_of(part), bound.triangle, bound.triangle - first_triangle, hit.barycentrics, pixel,
                      index_of(packed_sample)))
        discard;
    seen = uvec2(bound.triangle, floatBitsToUint(hit.depth));
    // Depths are below 1e12: divided by 2^41 they keep every bit and lie in [0, 1].
    gl_FragDepth = hit.depth * (1.0 / 2199023255552.0);
}
