// Twin of bound/local_bounds.h: the box and the hull of a triangle on the screen, as samples of one cell see it.

#include "bound/local_triangle.glsl"

// The six points: corners at both ends of a part of the shutter, point 2 * corner + end.
struct SixPoints {
    double x[6], y[6], w[6], c[6];
    double scale_x, scale_y, least_w;
};

SixPoints six_points(LocalTriangle T, SegmentDomain d) {
    SixPoints p;
    p.scale_x = p.scale_y = 0.0lf;
    p.least_w = kHuge;
    double lens_u = max(abs(d.u0), abs(d.u1)), lens_v = max(abs(d.v0), abs(d.v1));
    for (int k = 0; k < 6; ++k) {
        int i = k / 2;
        double s = k % 2 == 0 ? d.s0 : d.s1;
        precise double x = double(T.qx[i]) + s * double(T.dx[i]), y = double(T.qy[i]) + s * double(T.dy[i]);
        precise double w = double(T.qw[i]) + s * double(T.dw[i]), c = double(T.qc[i]) + s * double(T.dc[i]);
        precise double of_x = abs(x) + lens_u * abs(c) + 17.0lf * abs(w), of_y = abs(y) + lens_v * abs(c) + 17.0lf * abs(w);
        p.x[k] = x, p.y[k] = y, p.w[k] = w, p.c[k] = c;
        p.scale_x = max(p.scale_x, of_x);
        p.scale_y = max(p.scale_y, of_y);
        p.least_w = min(p.least_w, w);
    }
    return p;
}

// The next larger float, and the next smaller.
float above(float f) {
    if (isinf(f) && f > 0.0) return f;
    if (f == 0.0) return uintBitsToFloat(1u);
    uint bits = floatBitsToUint(f);
    return uintBitsToFloat(f > 0.0 ? bits + 1u : bits - 1u);
}
float up(double v) {
    return above(float(v));
}
float down(double v) {
    return -above(-float(v));
}

// x0, x1, y0, y1 in pixels from the cell's middle: the box that the exact test asks of triangles at the camera plane.
vec4 exact_box_of_cell(LocalTriangle T) {
    const double kOut = 1.0lf / 512.0lf;
    double middle_x = -double(T.centre.x), middle_y = -double(T.centre.y);
    precise double x0 = T.box.x + middle_x - kOut, x1 = T.box.y + middle_x + kOut, y0 = T.box.z + middle_y - kOut,
                   y1 = T.box.w + middle_y + kOut;
    return vec4(down(x0), up(x1), down(y0), up(y1));
}

vec4 local_bounds(LocalTriangle T, SegmentDomain d, SixPoints p) {
    if (reaches_camera(T)) return exact_box_of_cell(T);
    double x0 = kHuge, x1 = -kHuge, y0 = kHuge, y1 = -kHuge;
    for (int k = 0; k < 6; ++k) {
        precise double inverse = 1.0lf / p.w[k], u0 = d.u0 * p.c[k], u1 = d.u1 * p.c[k], v0 = d.v0 * p.c[k],
                       v1 = d.v1 * p.c[k];
        precise double left = (p.x[k] + min(u0, u1)) * inverse, right = (p.x[k] + max(u0, u1)) * inverse;
        precise double bottom = (p.y[k] + min(v0, v1)) * inverse, top = (p.y[k] + max(v0, v1)) * inverse;
        x0 = min(x0, left);
        x1 = max(x1, right);
        y0 = min(y0, bottom);
        y1 = max(y1, top);
    }
    precise double slack = 16.0lf * kUnitRoundoff / p.least_w;
    precise double out_x = slack * p.scale_x, out_y = slack * p.scale_y;
    precise double left = x0 - out_x, right = x1 + out_x, bottom = y0 - out_y, top = y1 + out_y;
    return vec4(down(left), up(right), down(bottom), up(top));
}

double turn_of(dvec2 a, dvec2 b, dvec2 c) {
    precise double turn = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    return turn;
}

double squared_length(dvec2 v) {
    precise double square = v.x * v.x + v.y * v.y;
    return square;
}

bool is_before(dvec2 lowest, dvec2 a, dvec2 b) {
    if (a == lowest || b == lowest) return a == lowest && b != lowest;
    double turn = turn_of(lowest, a, b);
    if (turn != 0.0lf) return turn > 0.0lf;
    return squared_length(a - lowest) < squared_length(b - lowest);
}

bool turns_right(dvec2 p[6], int a, int b, int c) {
    return turn_of(p[a], p[b], p[c]) < 0.0lf;
}

// Counter-clockwise from the lowest; some of the six that come out may be equal.
void make_hull(inout dvec2 p[6]) {
    for (int k = 1; k < 6; ++k)
        if (p[k].y < p[0].y || (p[k].y == p[0].y && p[k].x < p[0].x)) {
            dvec2 lower = p[k];
            p[k] = p[0];
            p[0] = lower;
        }
    const ivec2 kNetwork[9] = ivec2[9](ivec2(1, 2), ivec2(4, 5), ivec2(3, 5), ivec2(3, 4), ivec2(1, 4), ivec2(1, 3),
                                       ivec2(2, 5), ivec2(2, 4), ivec2(2, 3));
    for (int k = 0; k < 9; ++k) {
        int a = kNetwork[k].x, b = kNetwork[k].y;
        if (!is_before(p[0], p[b], p[a])) continue;
        dvec2 later = p[a];
        p[a] = p[b];
        p[b] = later;
    }
    bool keep2 = !turns_right(p, 1, 2, 3) && !turns_right(p, 1, 2, 4) && !turns_right(p, 1, 2, 5);
    bool keep3 = !turns_right(p, 1, 3, 4) && !turns_right(p, 1, 3, 5) && !turns_right(p, 2, 3, 4) &&
                 !turns_right(p, 2, 3, 5);
    bool keep4 = !turns_right(p, 1, 4, 5) && !turns_right(p, 2, 4, 5) && !turns_right(p, 3, 4, 5);
    if (!keep2) p[2] = p[1];
    if (!keep3) p[3] = p[2];
    if (!keep4) p[4] = p[3];
}

// A side of the hull: the footprint is not wholly outside x*nx + y*ny = h.
bool meets_side(float nx, float ny, double h, Footprint f) {
    precise double rounding = 4.0lf * kUnitRoundoff * (32.0lf * (abs(double(nx)) + abs(double(ny))) + abs(h));
    precise double moved = h + rounding;
    float x = nx > 0.0 ? f.x0 : f.x1, y = ny > 0.0 ? f.y0 : f.y1;  // the corner farthest inside
    precise float along = x * nx + y * ny;
    return !(along > up(moved));
}

// hull_polygon() and its meets() in one.
bool hull_meets(LocalTriangle T, SegmentDomain d, Footprint f) {
    SixPoints p = six_points(T, d);
    vec4 box = local_bounds(T, d, p);
    if (!meets_side(-1.0, 0.0, -box.x, f) || !meets_side(1.0, 0.0, box.y, f) || !meets_side(0.0, -1.0, -box.z, f) ||
        !meets_side(0.0, 1.0, box.w, f))
        return false;
    if (reaches_camera(T)) return true;
    dvec2 hull[6];
    for (int k = 0; k < 6; ++k) {
        precise dvec2 place = dvec2(p.x[k] / p.w[k], p.y[k] / p.w[k]);
        hull[k] = place;
    }
    make_hull(hull);
    for (int k = 0; k < 6; ++k) {
        dvec2 a = hull[k], b = hull[(k + 1) % 6];
        double length_of_side = sqrt(squared_length(b - a));
        if (!(length_of_side > 0.0lf)) continue;
        precise double across_x = (b.y - a.y) / length_of_side, across_y = (a.x - b.x) / length_of_side;
        float nx = float(across_x), ny = float(across_y);
        precise double of_u = double(d.u1) * nx, of_v = double(d.v1) * ny;
        double of_lens = sqrt(squared_length(dvec2(of_u, of_v)));
        double h = -kHuge;
        for (int j = 0; j < 6; ++j) {
            precise double farthest = (nx * p.x[j] + ny * p.y[j] + of_lens * abs(p.c[j])) / p.w[j];
            h = max(h, farthest);
        }
        precise double slack =
            16.0lf * kUnitRoundoff * (abs(nx) * p.scale_x + abs(ny) * p.scale_y) / p.least_w;
        precise double moved = h + slack;
        if (!meets_side(nx, ny, moved, f)) return false;
    }
    return true;
}
