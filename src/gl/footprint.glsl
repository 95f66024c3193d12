// What a culling test is asked about: the aligned square of `size` pixels that holds the pixel, with the whole lens and
// shutter (the tile and the pixel of cull/cull_test.h).

#include "cull/cull_axis.glsl"

Footprint square_of(ivec2 place, int size) {
    vec2 corner = vec2(place / size * size);
    float left = corner.x - 16.0, top = 16.0 - corner.y, side = float(size), ratio = float(lens_ratio);
    return Footprint(left, left + side, top - side, top, Domain(-1.0, 1.0, -ratio, ratio, 0.0, 1.0));
}
