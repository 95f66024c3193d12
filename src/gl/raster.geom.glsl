// The conservative bound of a moving, defocused triangle: the whole pixels of the fifteen-edge box, as the CPU bins them
// (bin/bins.h). Their sides lie between the pixels, so that the rasterizer's own sample positions, which have nothing to do
// with ours, are all inside and nothing has to be dilated.

#include "bound/facing.glsl"
#include "bound/screen_bounds.glsl"
#include "frame/opacity.glsl"

layout(triangles) in;
layout(triangle_strip, max_vertices = 4) out;

uniform uint first_triangle;  // of the part
uniform bool two_sided;
uniform ivec4 region;  // x0, x1, y0, y1: the pixels of the framebuffer

in Corner {
    vec4 open, close;
    float z_open, z_close;
} corner[];

out Bound {
    flat vec4 q[3];
    flat vec4 r[3];
    flat vec3 z_q;
    flat vec3 z_r;
    flat vec4 box;
    flat uint triangle;
} bound;

const float kLargestCoordinate = 1e12;  // as the CPU's bins drop what is larger

bool is_usable(MovingTriangle m) {
    for (int i = 0; i < 3; ++i) {
        bvec4 open = lessThanEqual(abs(m.q[i]), vec4(kLargestCoordinate));
        bvec4 close = lessThanEqual(abs(m.r[i]), vec4(kLargestCoordinate));
        if (!all(open) || !all(close)) return false;
    }
    return all(lessThanEqual(abs(m.z_q), vec3(kLargestCoordinate))) &&
           all(lessThanEqual(abs(m.z_r), vec3(kLargestCoordinate)));
}

void emit(MovingTriangle m, vec4 box, int x, int y) {
    bound.q = m.q;
    bound.r = m.r;
    bound.z_q = m.z_q;
    bound.z_r = m.z_r;
    bound.box = box;
    bound.triangle = first_triangle + uint(gl_PrimitiveIDIn);
    gl_Position = vec4(2.0 * float(x - region.x) / float(region.y - region.x) - 1.0,
                       2.0 * float(y - region.z) / float(region.w - region.z) - 1.0, 0.0, 1.0);
    EmitVertex();
}

void main() {
    MovingTriangle m;
    for (int i = 0; i < 3; ++i) {
        m.q[i] = corner[i].open;
        m.r[i] = corner[i].close;
        m.z_q[i] = corner[i].z_open;
        m.z_r[i] = corner[i].z_close;
    }
    if (!is_usable(m) || opacity_class(uint(gl_PrimitiveIDIn)) == kClear) return;
    ScreenBox bounds = screen_bounds(m);
    ivec4 pixels = covered_pixels(bounds, region);
    if (pixels.x >= pixels.y || pixels.z >= pixels.w) return;
    if (!two_sided && facing(m) == kBack) return;
    vec4 box = exact_box(m, bounds);
    emit(m, box, pixels.x, pixels.z);
    emit(m, box, pixels.y, pixels.z);
    emit(m, box, pixels.x, pixels.w);
    emit(m, box, pixels.y, pixels.w);
    EndPrimitive();
}
