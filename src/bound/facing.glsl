// Twin of bound/facing.h: which side of a moving, defocused triangle can be seen, over the whole shutter and lens. After
// Munkberg & Akenine-Moller 2011 (Backface Culling for Motion Blur and Depth of Field).

#include "bound/local_triangle.glsl"

const int kBack = -1, kMixed = 0, kFront = 1;

// The corners at both ends, index [end]; the lens is (u, v) = middle + (a, b), |(a, b)| <= half in each coordinate, on the
// ellipse within that rectangle if `disk`.
struct FacingQuestion {
    dvec3 x[2], y[2], w[2], c[2];
    double middle_u, middle_v, half_u, half_v;
    bool disk;
};

bool stands_still(FacingQuestion q) {
    return q.x[0] == q.x[1] && q.y[0] == q.y[1] && q.w[0] == q.w[1] && q.c[0] == q.c[1];
}

double facing_slack(FacingQuestion q) {
    double size_x = 0.0lf, size_y = 0.0lf, size_w = 0.0lf;
    for (int end = 0; end < 2; ++end) {
        dvec3 c = abs(q.c[end]);
        size_x = max(size_x, largest(abs(q.x[end]) + (abs(q.middle_u) + q.half_u) * c));
        size_y = max(size_y, largest(abs(q.y[end]) + (abs(q.middle_v) + q.half_v) * c));
        size_w = max(size_w, largest(abs(q.w[end])));
    }
    return 64.0lf * kUnitRoundoff * (size_x + 16.0lf * size_w) * (size_y + 16.0lf * size_w) * size_w;
}

// Rows (x, y, w) of the corners; each vector holds one column.
double determinant_of(dvec3 x, dvec3 y, dvec3 w) {
    return x[0] * (y[1] * w[2] - w[1] * y[2]) - y[0] * (x[1] * w[2] - w[1] * x[2]) + w[0] * (x[1] * y[2] - y[1] * x[2]);
}

int decide_facing(FacingQuestion q) {
    // Bernstein coefficients over s; coefficient j averages the determinants in which j corners are taken at the end.
    double d0[4] = double[4](0.0lf, 0.0lf, 0.0lf, 0.0lf), du[4] = d0, dv[4] = d0;
    const double kChoices[4] = double[4](1.0lf, 3.0lf, 3.0lf, 1.0lf);
    bool still = stands_still(q);
    for (int choice = 0; choice < (still ? 1 : 8); ++choice) {
        int j = bitCount(choice);
        dvec3 x, y, w, c;
        for (int i = 0; i < 3; ++i) {
            int end = choice >> i & 1;
            c[i] = q.c[end][i];
            w[i] = q.w[end][i];
            x[i] = q.x[end][i] + q.middle_u * c[i];
            y[i] = q.y[end][i] + q.middle_v * c[i];
        }
        d0[j] += determinant_of(x, y, w) / kChoices[j];
        du[j] += determinant_of(c, y, w) / kChoices[j];
        dv[j] += determinant_of(x, c, w) / kChoices[j];
    }
    double tau = facing_slack(q);
    bool front = true, back = true;
    for (int j = 0; j < (still ? 1 : 4); ++j) {
        double along_u = q.half_u * du[j], along_v = q.half_v * dv[j];
        double rho = q.disk ? sqrt(along_u * along_u + along_v * along_v) : abs(along_u) + abs(along_v);
        front = front && d0[j] - rho > tau;
        back = back && d0[j] + rho < -tau;
    }
    return front ? kFront : back ? kBack : kMixed;
}

int facing(MovingTriangle m) {
    FacingQuestion q;
    for (int i = 0; i < 3; ++i) {
        dvec4 open = dvec4(m.q[i]), close = dvec4(m.r[i]);
        q.x[0][i] = open.x, q.y[0][i] = open.y, q.w[0][i] = open.z, q.c[0][i] = open.w;
        q.x[1][i] = close.x, q.y[1][i] = close.y, q.w[1][i] = close.z, q.c[1][i] = close.w;
    }
    q.middle_u = q.middle_v = 0.0lf;
    q.half_u = 1.0lf;
    q.half_v = lens_ratio;
    q.disk = true;
    return decide_facing(q);
}

// Of the samples of one cell within a part of lens and segment; here (u, v) may be anywhere in its rectangle.
int facing(LocalTriangle T, SegmentDomain d) {
    double u0 = d.u0, u1 = d.u1, v0 = d.v0, v1 = d.v1;
    FacingQuestion q;
    q.middle_u = 0.5lf * (u0 + u1), q.middle_v = 0.5lf * (v0 + v1);
    q.half_u = 0.5lf * (u1 - u0), q.half_v = 0.5lf * (v1 - v0);
    q.disk = false;
    for (int end = 0; end < 2; ++end) {
        double s = end == 0 ? d.s0 : d.s1;
        q.x[end] = dvec3(T.qx) + s * dvec3(T.dx);
        q.y[end] = dvec3(T.qy) + s * dvec3(T.dy);
        q.w[end] = dvec3(T.qw) + s * dvec3(T.dw);
        q.c[end] = dvec3(T.qc) + s * dvec3(T.dc);
    }
    return decide_facing(q);
}
