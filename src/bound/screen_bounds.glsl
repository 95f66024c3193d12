// Twin of bound/screen_bounds.h: the fifteen-edge box. McGuire, Enderton, Shirley, Luebke 2010 conjectured it,
// docs/develop/algorithms.md 3.2 proves it.

#include "bound/local_triangle.glsl"

// Closed rectangle in pixels from the middle of the picture, y up. Empty: x0 > x1.
struct ScreenBox {
    double x0, x1, y0, y1, nearest_w;
};

bool is_empty(ScreenBox box) {
    return !(box.x0 <= box.x1);
}

// p: x, y, w, c.
void add(inout ScreenBox box, dvec4 p) {
    precise double cx = abs(p.w), cy = lens_ratio * cx, inverse = 1.0lf / p.z;
    precise double x0 = (p.x - cx) * inverse, x1 = (p.x + cx) * inverse, y0 = (p.y - cy) * inverse,
                   y1 = (p.y + cy) * inverse;
    box.x0 = min(box.x0, x0);
    box.x1 = max(box.x1, x1);
    box.y0 = min(box.y0, y0);
    box.y1 = max(box.y1, y1);
    box.nearest_w = min(box.nearest_w, p.z);
}

ScreenBox screen_bounds(MovingTriangle m) {
    dvec4 points[6];
    for (int i = 0; i < 3; ++i) {
        points[2 * i] = dvec4(m.q[i]);
        points[2 * i + 1] = dvec4(m.r[i]);
    }
    ScreenBox box = ScreenBox(kHuge, -kHuge, kHuge, -kHuge, kHuge);
    bool all_in_front = true;
    for (int i = 0; i < 6; ++i) {
        if (points[i].z >= w_near)
            add(box, points[i]);
        else
            all_in_front = false;
    }
    if (!all_in_front) {
        for (int i = 0; i < 6; ++i)
            for (int j = i + 1; j < 6; ++j) {
                dvec4 p = points[i], q = points[j];
                if ((p.z >= w_near) == (q.z >= w_near)) continue;
                precise double s = (w_near - p.z) / (q.z - p.z);
                precise dvec4 there = p + s * (q - p);
                add(box, dvec4(there.x, there.y, w_near, there.w));
            }
    }
    if (is_empty(box)) return box;
    double scale_x = 0.0lf, scale_y = 0.0lf, farthest_w = 0.0lf;
    double reach_x = min(max(abs(box.x0), abs(box.x1)), 32768.0lf);
    double reach_y = min(max(abs(box.y0), abs(box.y1)), 32768.0lf);
    for (int i = 0; i < 6; ++i) {
        dvec4 p = abs(points[i]);
        farthest_w = max(farthest_w, p.z);
        precise double x = p.x + p.w + p.z * (32.0lf + reach_x), y = p.y + lens_ratio * p.w + p.z * (32.0lf + reach_y);
        scale_x = max(scale_x, x);
        scale_y = max(scale_y, y);
    }
    precise double slack = 16.0lf * kUnitRoundoff / box.nearest_w;
    precise ScreenBox grown = ScreenBox(box.x0 - slack * scale_x, box.x1 + slack * scale_x, box.y0 - slack * scale_y,
                                        box.y1 + slack * scale_y,
                                        max(w_near, box.nearest_w - 2.0lf * kUnitRoundoff * farthest_w));
    return grown;
}

// Half-open rectangle of pixels (x0, x1, y0, y1), y down, cut to `limits`; rejects before it clamps: x0 = x1.
ivec4 covered_pixels(ScreenBox box, ivec4 limits) {
    const ivec4 kNone = ivec4(0);
    if (is_empty(box)) return kNone;
    double half_width = 0.5lf * double(picture_width), half_height = 0.5lf * double(picture_height);
    precise double x0 = floor(box.x0 + half_width), x1 = floor(box.x1 + half_width) + 1.0lf;
    precise double y0 = floor(half_height - box.y1), y1 = floor(half_height - box.y0) + 1.0lf;
    if (!(x0 < limits.y && x1 > limits.x && y0 < limits.w && y1 > limits.z)) return kNone;
    return ivec4(max(x0, double(limits.x)), min(x1, double(limits.y)), max(y0, double(limits.z)),
                 min(y1, double(limits.w)));
}

// Some vertex may be behind the camera plane; the end of the path as the exact test computes it counts, too.
bool reaches_camera(MovingTriangle m) {
    for (int i = 0; i < 3; ++i) {
        precise float step = float(double(m.r[i].z) - double(m.q[i].z)), end = m.q[i].z + step;
        if (min(min(m.q[i].z, m.r[i].z), end) < w_near) return true;
    }
    return false;
}

// LocalTriangle's box: the exact test asks only triangles that reach the camera plane.
vec4 exact_box(MovingTriangle m, ScreenBox bounds) {
    return reaches_camera(m) ? vec4(bounds.x0, bounds.x1, bounds.y0, bounds.y1) : vec4(-1.0, 1.0, -1.0, 1.0) * kEverywhere;
}
