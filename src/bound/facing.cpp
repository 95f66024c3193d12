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

}  // namespace

Facing facing(const MovingTriangle& m, double ratio) {
    // Bernstein coefficients over t of D(u,v,t) = D0 + u*Du + v*Dv; coefficient j averages the determinants in which j
    // vertices are taken at the end of the segment.
    double d0[4] = {}, du[4] = {}, dv[4] = {};
    double size_x = 0, size_y = 0, size_w = 0;
    bool still = true, sharp = true;
    for (int i = 0; i < 3; ++i) {
        still = still && m.x[i][0] == m.x[i][1] && m.y[i][0] == m.y[i][1] && m.w[i][0] == m.w[i][1] &&
                m.c[i][0] == m.c[i][1];
        for (int end = 0; end < 2; ++end) {
            const double c = std::abs(m.c[i][end]);
            sharp = sharp && c == 0.0;
            size_x = std::max(size_x, std::abs(m.x[i][end]) + c);
            size_y = std::max(size_y, std::abs(m.y[i][end]) + ratio * c);
            size_w = std::max(size_w, std::abs(static_cast<double>(m.w[i][end])));
        }
    }
    constexpr int kCount[8] = {0, 1, 1, 2, 1, 2, 2, 3};
    constexpr double kChoices[4] = {1, 3, 3, 1};
    for (int choice = 0; choice < (still ? 1 : 8); ++choice) {
        const int j = kCount[choice];
        Row plain[3], lens_x[3], lens_y[3];
        for (int i = 0; i < 3; ++i) {
            const int end = choice >> i & 1;
            const double x = m.x[i][end], y = m.y[i][end], w = m.w[i][end], c = m.c[i][end];
            plain[i] = {x, y, w};
            lens_x[i] = {c, y, w};
            lens_y[i] = {x, c, w};
        }
        d0[j] += determinant(plain[0], plain[1], plain[2]) / kChoices[j];
        if (sharp) continue;
        du[j] += determinant(lens_x[0], lens_x[1], lens_x[2]) / kChoices[j];
        dv[j] += ratio * determinant(lens_y[0], lens_y[1], lens_y[2]) / kChoices[j];
    }
    // The slack scales with the products, not with D. The sheared exact test has x, y up to half a cell times w larger.
    const double tau = 64.0 * kUnitRoundoff * (size_x + 16.0 * size_w) * (size_y + 16.0 * size_w) * size_w;
    bool front = true, back = true;
    for (int j = 0; j < (still ? 1 : 4); ++j) {
        const double rho = std::hypot(du[j], dv[j]);
        front = front && d0[j] - rho > tau;
        back = back && d0[j] + rho < -tau;
    }
    return front ? Facing::kFront : back ? Facing::kBack : Facing::kMixed;
}

}  // namespace pentaprism
