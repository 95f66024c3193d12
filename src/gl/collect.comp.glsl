// From the multisampled framebuffer to a buffer in the order of Hits.

#include "bound/local_triangle.glsl"
#include "gl/samples.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

uniform ivec4 region;
layout(binding = 0) uniform usampler2DMS seen;
layout(std430, binding = 0) restrict writeonly buffer Collected { uvec2 hits[]; };  // triangle, bits of its depth

void main() {
    ivec2 place = ivec2(gl_GlobalInvocationID.xy), pixel = place + region.xz;
    if (pixel.x >= region.y || pixel.y >= region.w) return;
    for (int slot = 0; slot < pass_slots; ++slot) hits[entry_of(pixel, slot)] = texelFetch(seen, place, slot).rg;
}
