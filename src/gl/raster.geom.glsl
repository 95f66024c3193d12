// The conservative bound of a moving, defocused triangle: the whole pixels of the fifteen-edge box, as the CPU bins them
// (bin/bins.h). Their sides lie between the pixels, so that the rasterizer's own sample positions, which have nothing to do
// with ours, are all inside and nothing has to be dilated.
//
// For `--culling hull` instead the convex hull of the six points on the screen, grown by the circle of confusion and by a
// pixel for the rasterizer's positions: all pixels of which a part is in the hull, and some more, which the fragment shader
// refuses. Triangles at the camera plane have their box.

#include "gl/bound.glsl"
#ifdef DRAW_HULL
#include "gl/hull_strip.glsl"
#endif

layout(triangles) in;
layout(triangle_strip, max_vertices = 12) out;

uniform int part;
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
    flat ivec4 pixels;
    flat uint triangle;
} bound;

// `place`: in pixels of the framebuffer.
void emit(MovingTriangle m, vec4 box, ivec4 pixels, vec2 place) {
    bound.q = m.q;
    bound.r = m.r;
    bound.z_q = m.z_q;
    bound.z_r = m.z_r;
    bound.box = box;
    bound.pixels = pixels;
    bound.triangle = first_triangle + uint(gl_PrimitiveIDIn);
    gl_Position = vec4(2.0 * place.x / float(region.y - region.x) - 1.0, 2.0 * place.y / float(region.w - region.z) - 1.0,
                       0.0, 1.0);
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
    ivec4 pixels;
    vec4 box;
    if (!bound_triangle(m, surface_of(part), uint(gl_PrimitiveIDIn), two_sided, region, pixels, box)) return;
#ifdef DRAW_HULL
    vec2 outline[kMostCorners];
    int corners = reaches_camera(m) ? 0 : hull_outline(m, outline);
    if (corners > 0) {
        // 0, n - 1, 1, n - 2, ...: a strip across the polygon. Where rounding has turned one of its triangles over, that is
        // culled: no sample is drawn twice.
        for (int k = 0; k < corners; ++k) {
            int at = k % 2 == 0 ? k / 2 : corners - (k + 1) / 2;
            emit(m, box, pixels, outline[at] - vec2(region.xz));
        }
        EndPrimitive();
        return;
    }
#endif
    vec4 sides = vec4(pixels - region.xxzz);
    emit(m, box, pixels, sides.xz);
    emit(m, box, pixels, sides.yz);
    emit(m, box, pixels, sides.xw);
    emit(m, box, pixels, sides.yw);
    EndPrimitive();
}
