#include "cover/dice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "bound/screen_bounds.h"

namespace pentaprism {
namespace {

constexpr int kMaxLevel = 12;     // 4096 pieces to an edge
constexpr int kMaxNearLevel = 4;  // of what reaches in front of the near distance
constexpr int kLattice = 1 << kMaxLevel;

// Barycentric coordinates times kLattice; their sum is kLattice.
using LatticePoint = std::array<int, 3>;

struct Cut {
    std::array<LatticePoint, 3> corner;
    int level;
    bool in_group;
};

LatticePoint middle(const LatticePoint& a, const LatticePoint& b) {
    return {(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, (a[2] + b[2]) / 2};
}

// Exact products, and on an edge of the triangle a sum of two: neighbours with that edge get the same number.
float at(const float v[3], const LatticePoint& p) {
    const double a = static_cast<double>(v[0]) * p[0], b = static_cast<double>(v[1]) * p[1],
                 c = static_cast<double>(v[2]) * p[2];
    return static_cast<float>(((a + b) + c) * (1.0 / kLattice));
}

LocalTriangle piece_of(const LocalTriangle& T, const Cut& cut) {
    if (cut.level == 0) return T;
    LocalTriangle piece = T;
    for (int i = 0; i < 3; ++i) {
        const LatticePoint& p = cut.corner[i];
        piece.qx[i] = at(T.qx, p), piece.qy[i] = at(T.qy, p), piece.qw[i] = at(T.qw, p), piece.qc[i] = at(T.qc, p);
        piece.dx[i] = at(T.dx, p), piece.dy[i] = at(T.dy, p), piece.dw[i] = at(T.dw, p), piece.dc[i] = at(T.dc, p);
        if (!T.orthographic) continue;
        piece.qz[i] = at(T.qz, p), piece.dz[i] = at(T.dz, p);
    }
    return piece;
}

// In the cell's coordinates; z is not asked for.
MovingTriangle moving(const LocalTriangle& T) {
    MovingTriangle m{};
    for (int i = 0; i < 3; ++i) {
        m.x[i][0] = T.qx[i], m.x[i][1] = T.qx[i] + T.dx[i];
        m.y[i][0] = T.qy[i], m.y[i][1] = T.qy[i] + T.dy[i];
        m.w[i][0] = T.qw[i], m.w[i][1] = T.qw[i] + T.dw[i];
        m.c[i][0] = T.qc[i], m.c[i][1] = T.qc[i] + T.dc[i];
    }
    return m;
}

bool reaches_behind(const MovingTriangle& m, float w_near) {
    for (const auto& corner : m.w)
        if (!(corner[0] >= w_near && corner[1] >= w_near)) return true;
    return false;
}

// All w are above 0.
float longest_edge(const MovingTriangle& m) {
    float longest = 0.0f;
    for (int end = 0; end < 2; ++end)
        for (int i = 0; i < 3; ++i) {
            const int j = (i + 1) % 3;
            const float dx = m.x[i][end] / m.w[i][end] - m.x[j][end] / m.w[j][end];
            const float dy = m.y[i][end] / m.w[i][end] - m.y[j][end] / m.w[j][end];
            longest = std::max(longest, dx * dx + dy * dy);
        }
    return std::sqrt(longest);
}

float rounded_down(double x) {
    return std::nextafter(static_cast<float>(std::max(x, -1e30)), -INFINITY);
}
float rounded_up(double x) {
    return std::nextafter(static_cast<float>(std::min(x, 1e30)), INFINITY);
}

}  // namespace

void Dicer::dice(const LocalTriangle& T, const LocalBox& window, const Visitor& visitor) const {
    std::vector<Cut> stack{{{{{kLattice, 0, 0}, {0, kLattice, 0}, {0, 0, kLattice}}}, 0, false}};
    while (!stack.empty()) {
        Cut cut = stack.back();
        stack.pop_back();
        Micropolygon micro{piece_of(T, cut), {}, 0.0f};
        const MovingTriangle m = moving(micro.piece);
        const ScreenBox box = screen_bounds(m, T.w_near, ratio_);
        if (!(box.x0 <= window.x1 && box.x1 >= window.x0 && box.y0 <= window.y1 && box.y1 >= window.y0)) continue;
        const bool behind = reaches_behind(m, T.w_near);
        micro.box = {rounded_down(box.x0), rounded_up(box.x1), rounded_down(box.y0), rounded_up(box.y1)};
        micro.nearest_w = rounded_down(box.nearest_w);
        if (cut.level > 0) {
            micro.piece.behind = behind;
            micro.piece.box[0] = rounded_down(box.x0 + centre_.x), micro.piece.box[1] = rounded_up(box.x1 + centre_.x);
            micro.piece.box[2] = rounded_down(box.y0 + centre_.y), micro.piece.box[3] = rounded_up(box.y1 + centre_.y);
        }
        const float edge = behind ? INFINITY : longest_edge(m);
        if (!(edge > kLongestEdge) || cut.level == (behind ? kMaxNearLevel : kMaxLevel)) {
            visitor.visit(micro, cut.in_group);
            continue;
        }
        if (!cut.in_group && edge <= kLongestEdgeOfGroup) {
            if (!visitor.enter_group(micro)) continue;
            cut.in_group = true;
        }
        const auto& [a, b, c] = cut.corner;
        const LatticePoint ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
        for (const std::array<LatticePoint, 3>& quarter :
             {std::array{ab, bc, ca}, std::array{ca, bc, c}, std::array{ab, b, bc}, std::array{a, ab, ca}})
            stack.push_back({quarter, cut.level + 1, cut.in_group});
    }
}

}  // namespace pentaprism
