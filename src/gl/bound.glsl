// Whether any sample can see a moving, defocused triangle, and in which pixels: as the CPU bins them (bin/bins.h).

#include "bound/facing.glsl"
#include "bound/screen_bounds.glsl"
#include "frame/opacity.glsl"

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

// pixels: x0, x1, y0, y1 of the picture, half open, cut to `region`. box: LocalTriangle's.
bool bound_triangle(MovingTriangle m, Surface surface, uint in_part, bool two_sided, ivec4 region, out ivec4 pixels,
                    out vec4 box) {
    if (!is_usable(m) || opacity_class(surface, in_part) == kClear) return false;
    ScreenBox bounds = screen_bounds(m);
    pixels = covered_pixels(bounds, region);
    box = exact_box(m, bounds);
    return pixels.x < pixels.y && pixels.z < pixels.w && (two_sided || facing(m) != kBack);
}
