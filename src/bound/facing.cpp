#include "bound/facing.h"

#include <algorithm>
#include <cmath>

namespace pentaprism {
namespace {

constexpr double kUnitRoundoff = 1.0 / 16777216.0;

struct Row {
    double x, y, w;
};

double determinant(const Row& a, const Row& b, const Row& c) {
    return a.x * (b.y * c.w - b.w * c.y) - a.y * (b.x * c.w - b.w * c.x) + a.w * (b.x * c.y - b.y * c.x);
}

// The corners at both ends, index [corner][end], and the lens: (u, v) = middle + (a, b), |(a, b)| <= half in each
// coordinate, on the ellipse within that rectangle if `disk`.
struct Question {
    double x[3][2], y[3][2], w[3][2], c[3][2];
    double middle_u, middle_v, half_u, half_v;
    bool disk;
};

bool stands_still(const Question& q) {
    for (int i = 0; i < 3; ++i)
        if (q.x[i][0] != q.x[i][1] || q.y[i][0] != q.y[i][1] || q.w[i][0] != q.w[i][1] || q.c[i][0] != q.c[i][1])
            return false;
    return true;
}

// Slack for the rounding of the exact test: scales with the products, not with D. The sheared test has x, y up to half
// a cell times w larger.
double slack(const Question& q) {
    double size_x = 0, size_y = 0, size_w = 0;
    for (int i = 0; i < 3; ++i)
        for (int end = 0; end < 2; ++end) {
            const double c = std::abs(q.c[i][end]);
            size_x = std::max(size_x, std::abs(q.x[i][end]) + (std::abs(q.middle_u) + q.half_u) * c);
            size_y = std::max(size_y, std::abs(q.y[i][end]) + (std::abs(q.middle_v) + q.half_v) * c);
            size_w = std::max(size_w, std::abs(q.w[i][end]));
        }
    return 64.0 * kUnitRoundoff * (size_x + 16.0 * size_w) * (size_y + 16.0 * size_w) * size_w;
}

Facing decide(const Question& q) {
    // Bernstein coefficients over s of D(a,b,s) = D0 + a*Du + b*Dv; coefficient j averages the determinants in which j
    // vertices are taken at the end.
    double d0[4] = {}, du[4] = {}, dv[4] = {};
    constexpr int kCount[8] = {0, 1, 1, 2, 1, 2, 2, 3};
    constexpr double kChoices[4] = {1, 3, 3, 1};
    const bool still = stands_still(q);
    for (int choice = 0; choice < (still ? 1 : 8); ++choice) {
        const int j = kCount[choice];
        Row plain[3], lens_x[3], lens_y[3];
        for (int i = 0; i < 3; ++i) {
            const int end = choice >> i & 1;
            const double c = q.c[i][end], w = q.w[i][end];
            const double x = q.x[i][end] + q.middle_u * c, y = q.y[i][end] + q.middle_v * c;
            plain[i] = {x, y, w};
            lens_x[i] = {c, y, w};
            lens_y[i] = {x, c, w};
        }
        d0[j] += determinant(plain[0], plain[1], plain[2]) / kChoices[j];
        du[j] += determinant(lens_x[0], lens_x[1], lens_x[2]) / kChoices[j];
        dv[j] += determinant(lens_y[0], lens_y[1], lens_y[2]) / kChoices[j];
    }
    const double tau = slack(q);
    bool front = true, back = true;
    for (int j = 0; j < (still ? 1 : 4); ++j) {
        const double along_u = q.half_u * du[j], along_v = q.half_v * dv[j];
        const double rho = q.disk ? std::hypot(along_u, along_v) : std::abs(along_u) + std::abs(along_v);
        front = front && d0[j] - rho > tau;
        back = back && d0[j] + rho < -tau;
    }
    return front ? Facing::kFront : back ? Facing::kBack : Facing::kMixed;
}

}  // namespace

Facing facing(const MovingTriangle& m, double ratio) {
    Question q{{}, {}, {}, {}, 0.0, 0.0, 1.0, ratio, true};
    for (int i = 0; i < 3; ++i)
        for (int end = 0; end < 2; ++end) {
            q.x[i][end] = m.x[i][end];
            q.y[i][end] = m.y[i][end];
            q.w[i][end] = m.w[i][end];
            q.c[i][end] = m.c[i][end];
        }
    return decide(q);
}

Facing facing(const LocalTriangle& T, const SegmentDomain& d) {
    const double u0 = d.u0, u1 = d.u1, v0 = d.v0, v1 = d.v1;
    Question q{{}, {}, {}, {}, 0.5 * (u0 + u1), 0.5 * (v0 + v1), 0.5 * (u1 - u0), 0.5 * (v1 - v0), false};
    for (int i = 0; i < 3; ++i)
        for (int end = 0; end < 2; ++end) {
            const double s = end == 0 ? d.s0 : d.s1;
            q.x[i][end] = T.qx[i] + s * T.dx[i];
            q.y[i][end] = T.qy[i] + s * T.dy[i];
            q.w[i][end] = T.qw[i] + s * T.dw[i];
            q.c[i][end] = T.qc[i] + s * T.dc[i];
        }
    return decide(q);
}

}  // namespace pentaprism
