// How a sample is packed (gl/upload.cpp).

#include "bound/local_triangle.glsl"

// Bits of u; bits of v; t in 24 bits and the low 8 bits of the sample's index in its pixel; the place in 256ths of a pixel
// from the cell's left and bottom side, 14 bits each, and the high 4 bits of the index.
LocalSample unpack_sample(uvec4 s) {
    vec2 place = vec2(s.w & 0x3fffu, s.w >> 14 & 0x3fffu) / 256.0 - 16.0;
    return LocalSample(place.x, place.y, uintBitsToFloat(s.x), uintBitsToFloat(s.y), float(s.z >> 8) / 16777216.0);
}
uint index_of(uvec4 s) {
    return s.w >> 28 << 8 | (s.z & 0xffu);
}
