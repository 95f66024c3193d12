// Twin of bound/local_triangle.h: a moving triangle sheared to the middle of one cell of 32x32 pixels, in double, rounded
// once. Vectors hold the three corners.

#include "base/number.glsl"

const int kCellSize = 32, kBlockSize = 4, kCellBlocks = 8;

uniform double w_near, lens_ratio;
uniform float z_near, z_far;
uniform int picture_width, picture_height;

// x, y, w, c of each corner at the two ends of the segment; z as well.
struct MovingTriangle {
    vec4 q[3], r[3];
    vec3 z_q, z_r;
};

const float kEverywhere = 1e30;

// Corner i is at q + s * d at fraction s of the segment. box: x0, x1, y0, y1, where the exact test looks; of a triangle
// that does not reach the camera plane everything, -kEverywhere to kEverywhere. centre: the cell's.
struct LocalTriangle {
    vec3 qx, qy, qw, qc, qz, dx, dy, dw, dc, dz;
    vec4 box;
    vec2 centre;
    float segments, segment;
    bool two_sided;
};

// (hx, hy): offset from the cell's middle in pixels, y up.
struct LocalSample {
    float hx, hy, u, v, t;
};

vec2 cell_centre(ivec2 cell) {
    return vec2(float(cell.x * kCellSize + kCellSize / 2) - 0.5 * float(picture_width),
                0.5 * float(picture_height) - float(cell.y * kCellSize + kCellSize / 2));
}

dvec3 corners_of(float a, float b, float c) {
    return dvec3(double(a), double(b), double(c));
}

LocalTriangle localize(MovingTriangle m, vec4 box, vec2 centre, float segments, float segment, bool two_sided) {
    dvec3 x = corners_of(m.q[0].x, m.q[1].x, m.q[2].x), y = corners_of(m.q[0].y, m.q[1].y, m.q[2].y);
    dvec3 w = corners_of(m.q[0].z, m.q[1].z, m.q[2].z), c = corners_of(m.q[0].w, m.q[1].w, m.q[2].w);
    precise dvec3 dx = corners_of(m.r[0].x, m.r[1].x, m.r[2].x) - x, dy = corners_of(m.r[0].y, m.r[1].y, m.r[2].y) - y;
    precise dvec3 dw = corners_of(m.r[0].z, m.r[1].z, m.r[2].z) - w, dc = corners_of(m.r[0].w, m.r[1].w, m.r[2].w) - c;
    precise dvec3 z = dvec3(m.z_q), dz = dvec3(m.z_r) - z;
    double centre_x = double(centre.x), centre_y = double(centre.y);
    precise dvec3 local_x = x - centre_x * w, local_y = y - centre_y * w;
    precise dvec3 local_dx = dx - centre_x * dw, local_dy = dy - centre_y * dw;
    return LocalTriangle(vec3(local_x), vec3(local_y), vec3(w), vec3(c), vec3(z), vec3(local_dx), vec3(local_dy), vec3(dw),
                         vec3(dc), vec3(dz), box, centre, segments, segment, two_sided);
}

// Some vertex may be behind the camera plane.
bool reaches_camera(LocalTriangle T) {
    return T.box.x != -kEverywhere;
}

// Closed ranges of the lens and the shutter.
struct Domain {
    float u0, u1, v0, v1, t0, t1;
};

// Closed ranges of what a culling test is asked about, in pixels from the cell's middle, y up, and of lens and shutter.
struct Footprint {
    float x0, x1, y0, y1;
    Domain domain;
};

// Of the lens and of s, the part of the shutter as fractions of the segment.
struct SegmentDomain {
    float u0, u1, v0, v1, s0, s1;
};

bool is_empty(SegmentDomain d) {
    return !(d.u0 <= d.u1 && d.v0 <= d.v1 && d.s0 <= d.s1);
}

// The fraction of its segment at which a sample is. Exact: t is a multiple of 2^-24.
float segment_time(LocalTriangle T, float t) {
    return fused(t, T.segments, -T.segment);
}

SegmentDomain segment_domain(LocalTriangle T, Domain d) {
    return SegmentDomain(d.u0, d.u1, d.v0, d.v1, max(0.0, segment_time(T, d.t0)), min(1.0, segment_time(T, d.t1)));
}
