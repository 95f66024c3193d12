// The polygon that the geometry shader draws for `--culling hull`: the hull of the six points (bound/local_bounds.glsl) and
// all that lies within a square around any of its points, whose half side is the largest circle of confusion, a pixel and
// what fixed-point rasterizers and float round.

#include "bound/local_bounds.glsl"

const int kMostCorners = 12;
const float kRasterMargin = 1.0 + 1.0 / 16.0;
const float kFarthestCorner = 32768.0;  // float and fixed point are exact enough up to here

// Which corner of the square is farthest in a direction: 0 to 3, counter-clockwise from (+, +).
int farthest_corner(dvec2 n) {
    return n.y >= 0.0lf ? (n.x >= 0.0lf ? 0 : 1) : (n.x < 0.0lf ? 2 : 3);
}

vec2 square_corner(int corner, vec2 reach) {
    return vec2(corner == 0 || corner == 3 ? reach.x : -reach.x, corner < 2 ? reach.y : -reach.y);
}

// Corners in pixels of the picture, y down, in order round the polygon. 0: it is too large; draw the box.
int hull_outline(MovingTriangle m, out vec2 outline[kMostCorners]) {
    dvec2 hull[6];
    float circle = 0.0;
    for (int k = 0; k < 6; ++k) {
        vec4 at = k % 2 == 0 ? m.q[k / 2] : m.r[k / 2];
        hull[k] = dvec2(at.xy) / double(at.z);
        circle = max(circle, abs(at.w) / at.z);
    }
    make_hull(hull);
    vec2 middle = 0.5 * vec2(picture_width, picture_height);
    vec2 reach = vec2(circle, circle * float(lens_ratio)) * 1.0001 + kRasterMargin;
    int first = 0, count = 0;
    while (first < 6 && hull[(first + 1) % 6] == hull[first]) ++first;
    if (first == 6) return 0;  // a point
    // Round the hull and back to its first side: at each point one corner of the square, and more where it turns.
    int corner = -1;
    for (int k = 0; k <= 6; ++k) {
        dvec2 here = hull[(first + k) % 6], side = hull[(first + k + 1) % 6] - here;
        if (side == dvec2(0.0lf)) continue;
        int wanted = farthest_corner(dvec2(side.y, -side.x));
        if (corner < 0) corner = wanted;
        for (;;) {
            vec2 place = vec2(here) + square_corner(corner, reach);
            bool closed = k == 6 && corner == wanted;  // the corner that was the first
            if (!closed) {
                if (!(abs(place.x) < kFarthestCorner && abs(place.y) < kFarthestCorner) || count == kMostCorners) return 0;
                outline[count++] = vec2(middle.x + place.x, middle.y - place.y);
            }
            if (corner == wanted) break;
            corner = (corner + 1) % 4;
        }
    }
    return count;
}
