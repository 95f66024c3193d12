// Bounds with one mistake each: the samples of tests/property/culling_test.cpp must notice every one, and nothing
// without a mistake (docs/develop/algorithms.md 4.13). The formulas are written out once more, in double and for one
// sample at a time, so that a mistake is one line here and none in the renderer.
#include <algorithm>
#include <functional>
#include <gtest/gtest.h>
#include <string>
#include <utility>
#include <vector>

#include "support/ask_cull.h"

namespace pentaprism {
namespace {

using support::effort;
using support::for_each_accepted;
using support::Hard;
using support::HardCase;
using support::kHardClasses;
using support::LensShape;
using support::Random;

// Six points of one axis, [corner][end], and what is asked about.
struct Axis {
    double p[3][2], c[3][2], w[3][2];
    double g0, g1, lens0, lens1;
    double slack() const {
        double s = 0;
        for (int i = 0; i < 3; ++i)
            for (int e = 0; e < 2; ++e)
                s = std::max(s, std::abs(p[i][e]) + std::max(std::abs(lens0), std::abs(lens1)) * std::abs(c[i][e]) +
                                    17 * std::abs(w[i][e]));
        return 32 * 0x1p-24 * s;
    }
};

struct Asked {
    const HardCase* hard;
    Axis x, y;
    double hx, hy, u, v, s;
    bool front;
};

Asked ask_about(const HardCase& c, const Footprint& f, const LocalSample& sample, bool front) {
    const LocalTriangle& T = c.local;
    Asked a{&c, {}, {}, sample.hx, sample.hy, sample.u, sample.v, std::fma(sample.t, T.segments, -T.segment), front};
    for (int i = 0; i < 3; ++i)
        for (int e = 0; e < 2; ++e) {
            a.x.p[i][e] = T.qx[i] + double{T.dx[i]} * e;
            a.y.p[i][e] = T.qy[i] + double{T.dy[i]} * e;
            a.x.w[i][e] = a.y.w[i][e] = T.qw[i] + double{T.dw[i]} * e;
            a.x.c[i][e] = a.y.c[i][e] = T.qc[i] + double{T.dc[i]} * e;
        }
    a.x.g0 = f.x0, a.x.g1 = f.x1, a.x.lens0 = -1, a.x.lens1 = 1;
    a.y.g0 = f.y0, a.y.g1 = f.y1, a.y.lens0 = -c.ratio(), a.y.lens1 = c.ratio();
    return a;
}

// ---- Corner values and what is made of them (4.1, 4.5, 4.6.4)

enum class CornerMistake { kNone, kNoFootprintWidth, kVertexForgotten, kUnsignedCoc };

void corners(const Axis& a, CornerMistake mistake, double highest[2][2], double lowest[2][2]) {
    const double middle = 0.5 * (a.g0 + a.g1);
    const double half = mistake == CornerMistake::kNoFootprintWidth ? 0 : 0.5 * (a.g1 - a.g0);
    for (int l = 0; l < 2; ++l)
        for (int e = 0; e < 2; ++e) {
            highest[l][e] = -INFINITY, lowest[l][e] = INFINITY;
            for (int i = 0; i < (mistake == CornerMistake::kVertexForgotten ? 2 : 3); ++i) {
                const double c = mistake == CornerMistake::kUnsignedCoc ? std::abs(a.c[i][e]) : a.c[i][e];
                const double at = a.p[i][e] + (l == 0 ? a.lens0 : a.lens1) * c - middle * a.w[i][e];
                const double w = std::abs(a.w[i][e]);
                highest[l][e] = std::max(highest[l][e], at + half * w + a.slack());
                lowest[l][e] = std::min(lowest[l][e], at - half * w - a.slack());
            }
        }
}

bool bilinear_keeps(const Axis& a, double lens, double s, CornerMistake mistake) {
    double highest[2][2], lowest[2][2];
    corners(a, mistake, highest, lowest);
    const double f = (lens - a.lens0) / (a.lens1 - a.lens0);
    const auto at = [&](const double m[2][2]) {
        return (m[0][0] * (1 - f) + m[1][0] * f) * (1 - s) + (m[0][1] * (1 - f) + m[1][1] * f) * s;
    };
    return at(highest) >= 0 && at(lowest) <= 0;
}

bool lines_keep(const Axis& a, double lens, double s, bool swapped) {
    double highest[2][2], lowest[2][2];
    corners(a, CornerMistake::kNone, highest, lowest);
    const double f = (lens - a.lens0) / (a.lens1 - a.lens0);
    for (const double sign : {1.0, -1.0}) {
        const auto& m = sign > 0 ? highest : lowest;
        const double m00 = sign * m[0][0], m01 = sign * m[0][1], m10 = sign * m[1][0], m11 = sign * m[1][1];
        const double k = m00 + m11 - m10 - m01, base = m00 + (m10 - m00) * f + (m01 - m00) * s;
        if ((k > 0) != swapped ? base + k * f < 0 || base + k * s < 0 : base < 0 || base + k * (f + s - 1) < 0)
            return false;
    }
    return true;
}

// ---- Clip space (4.6)

bool stage1_keeps(const Axis& a, double lens, bool swapped) {
    const double middle = 0.5 * (a.g0 + a.g1), half = 0.5 * (a.g1 - a.g0), slack = a.slack();
    for (const double sign : {1.0, -1.0}) {  // all negative; all positive
        double low = -INFINITY, high = INFINITY;
        for (int i = 0; i < 3; ++i)
            for (int e = 0; e < 2; ++e) {
                const double x = sign * (a.p[i][e] - middle * a.w[i][e]) + half * std::abs(a.w[i][e]) + slack;
                const double c = sign * a.c[i][e];
                if (c == 0 && x >= 0) high = -INFINITY;
                if (c > 0) (swapped ? low : high) = swapped ? std::max(low, -x / c) : std::min(high, -x / c);
                if (c < 0) (swapped ? high : low) = swapped ? std::min(high, -x / c) : std::max(low, -x / c);
            }
        if (lens > low + 1e-5 && lens < high - 1e-5) return false;
    }
    return true;
}

bool stage2_keeps(const Axis& a, double lens, double s, bool guarded) {
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY}, least = INFINITY, largest = 1;
    int sign = 0;
    for (const double g : {a.g0, a.g1})
        for (int i = 0; i < 3; ++i) {
            const double x0 = a.p[i][0] - g * a.w[i][0], x1 = a.p[i][1] - g * a.w[i][1];
            const double c0 = a.c[i][0], c1 = a.c[i][1], d0 = x1 - x0, d1 = c1 - c0;
            const auto d = [&](double l) { return d0 + d1 * l; };
            const auto t = [&](double l) { return -(x0 + c0 * l) / d(l); };
            const double enough = 1e-3 * (std::abs(x0) + std::abs(x1) + std::abs(c0) + std::abs(c1));
            for (const double l : {a.lens0, a.lens1}) {
                const int here = d(l) > enough ? 1 : d(l) < -enough ? -1 : 0;
                if (here == 0 || (guarded && sign != 0 && here != sign)) return true;
                sign = here;
                least = std::min(least, std::abs(d(l)));
            }
            const double middle = 0.5 * (a.lens0 + a.lens1), half = 0.5 * (a.lens1 - a.lens0);
            const double rise = (-c0 * d0 + x0 * d1) / (d(middle) * d(middle)) * half;
            const double ends[2][2] = {{t(a.lens0), t(middle) - rise}, {t(a.lens1), t(middle) + rise}};
            for (int e = 0; e < 2; ++e) {
                low[e] = std::min({low[e], ends[e][0], ends[e][1]});
                high[e] = std::max({high[e], ends[e][0], ends[e][1]});
                largest = std::max({largest, std::abs(low[e]), std::abs(high[e])});
            }
        }
    const double f = (lens - a.lens0) / (a.lens1 - a.lens0), out = 1e-6 * largest + a.slack() / least;
    return s >= low[0] + f * (low[1] - low[0]) - out && s <= high[0] + f * (high[1] - high[0]) + out;
}

// ---- Edges (4.8, 4.9, 3.6)

enum class PlaneMistake { kNone, kNoRest, kNoQuadratic };

struct Quadratic {
    double z0, z1, z2;
    Quadratic(const double p[2][2], const double q[2][2]) {
        const double p1 = 0.5 * (p[0][0] + p[0][1]), p2 = 0.5 * (p[1][0] + p[1][1]), q1 = 0.5 * (q[0][0] + q[0][1]),
                     q2 = 0.5 * (q[1][0] + q[1][1]);
        const double dp1 = p[0][1] - p[0][0], dp2 = p[1][1] - p[1][0], dq1 = q[0][1] - q[0][0], dq2 = q[1][1] - q[1][0];
        z0 = p1 * q2 - p2 * q1;
        z1 = p1 * dq2 + dp1 * q2 - p2 * dq1 - dp2 * q1;
        z2 = dp1 * dq2 - dp2 * dq1;
    }
};

double edge_slack(const Asked& a) {
    double size = 0;  // of both axes at once: generous
    for (const Axis* axis : {&a.x, &a.y}) size = std::max(size, axis->slack());
    return 4 * size * size / (32 * 0x1p-24);
}

bool planes_keep(const Asked& q, PlaneMistake mistake) {
    const double gx = 0.5 * (q.x.g0 + q.x.g1), gy = 0.5 * (q.y.g0 + q.y.g1), hx = 0.5 * (q.x.g1 - q.x.g0),
                 hy = 0.5 * (q.y.g1 - q.y.g0), hv = q.y.lens1;
    bool front = true, back = true;
    for (int k = 0; k < 3; ++k) {
        double A[2][2], B[2][2], U[2][2], V[2][2], W[2][2];
        for (int n = 0; n < 2; ++n)
            for (int e = 0; e < 2; ++e) {
                const int i = (k + 1 + n) % 3;
                A[n][e] = q.x.p[i][e] - gx * q.x.w[i][e];
                B[n][e] = q.y.p[i][e] - gy * q.y.w[i][e];
                U[n][e] = q.x.c[i][e];
                V[n][e] = hv * q.y.c[i][e];
                W[n][e] = q.x.w[i][e];
            }
        const Quadratic ab(A, B), ub(U, B), av(A, V), wb(W, B), aw(A, W), uw(U, W), vw(V, W);
        const auto off = [](const Quadratic& z) { return std::abs(z.z1) / 2 + std::abs(z.z2) / 8; };
        const auto all = [](const Quadratic& z) { return std::abs(z.z0) + std::abs(z.z1) / 2 + std::abs(z.z2) / 4; };
        double rest = off(ub) + off(av) + hx * off(wb) + hy * off(aw) + hy * all(uw) + hx * all(vw);
        if (mistake == PlaneMistake::kNoRest) rest = 0;
        const bool quadratic = mistake != PlaneMistake::kNoQuadratic;
        const double up = quadratic ? std::max(ab.z2, 0.0) / 4 : 0, down = quadratic ? std::min(ab.z2, 0.0) / 4 : 0;
        const auto middle = [](const Quadratic& z) { return z.z0 + z.z2 / 8; };
        const double linear = -middle(wb) * (q.hx - gx) - middle(aw) * (q.hy - gy) + middle(ub) * q.u +
                              middle(av) * q.v / hv + ab.z1 * (q.s - 0.5);
        if (ab.z0 + up + rest + linear < -edge_slack(q)) front = false;
        if (ab.z0 + down - rest + linear > edge_slack(q)) back = false;
    }
    return front || back;
}

bool half_spaces_keep(const Asked& q, int tile_corners) {
    bool front = true, back = true;
    for (int k = 0; k < 3; ++k) {
        double highest = -INFINITY, lowest = INFINITY;
        for (int corner = 0; corner < tile_corners; ++corner) {
            const double gx = corner % 2 == 0 ? q.x.g0 : q.x.g1, gy = corner / 2 == 0 ? q.y.g0 : q.y.g1;
            double X[2][2], Y[2][2];
            for (int n = 0; n < 2; ++n)
                for (int e = 0; e < 2; ++e) {
                    const int i = (k + 1 + n) % 3;
                    X[n][e] = q.x.p[i][e] + q.u * q.x.c[i][e] - gx * q.x.w[i][e];
                    Y[n][e] = q.y.p[i][e] + q.v * q.y.c[i][e] - gy * q.y.w[i][e];
                }
            const double b[3] = {X[0][0] * Y[1][0] - X[1][0] * Y[0][0],
                                 0.5 * (X[0][0] * Y[1][1] + X[0][1] * Y[1][0] - X[1][0] * Y[0][1] - X[1][1] * Y[0][0]),
                                 X[0][1] * Y[1][1] - X[1][1] * Y[0][1]};
            for (const double e : b) highest = std::max(highest, e), lowest = std::min(lowest, e);
        }
        if (highest < -edge_slack(q)) front = false;
        if (lowest > edge_slack(q)) back = false;
    }
    return front || back;
}

// Of the whole lens at the sample's place in it: the determinant's Bernstein coefficients in s.
bool facing_keeps(const Asked& q, bool inner) {
    double d[4] = {}, size_x = 0, size_y = 0, size_w = 0;
    constexpr int kCount[8] = {0, 1, 1, 2, 1, 2, 2, 3};
    for (int choice = 0; choice < 8; ++choice) {
        double x[3], y[3], w[3];
        for (int i = 0; i < 3; ++i) {
            const int e = choice >> i & 1;
            x[i] = q.x.p[i][e] + q.u * q.x.c[i][e], y[i] = q.y.p[i][e] + q.v * q.y.c[i][e], w[i] = q.x.w[i][e];
            size_x = std::max(size_x, std::abs(x[i]) + std::abs(q.u * q.x.c[i][e]));
            size_y = std::max(size_y, std::abs(y[i]) + std::abs(q.v * q.y.c[i][e]));
            size_w = std::max(size_w, std::abs(w[i]));
        }
        d[kCount[choice]] += (x[0] * (y[1] * w[2] - w[1] * y[2]) - y[0] * (x[1] * w[2] - w[1] * x[2]) +
                              w[0] * (x[1] * y[2] - y[1] * x[2])) /
                             (kCount[choice] % 3 == 0 ? 1 : 3);
    }
    const double tau = 64 * 0x1p-24 * (size_x + 16 * size_w) * (size_y + 16 * size_w) * size_w;
    bool all_front = true, all_back = true;
    for (const int j : {0, 1, 2, 3}) {
        if (!inner && (j == 1 || j == 2)) continue;
        all_front = all_front && d[j] > tau;
        all_back = all_back && d[j] < -tau;
    }
    return q.front ? !all_back : !all_front;
}

// ---- Screen bounds (3.2, 3.4)

bool box_keeps(const Asked& q, int without) {
    const double near = q.hard->frame.view.w_near();
    for (const auto& [axis, place] : {std::pair(&q.x, q.hx), std::pair(&q.y, q.hy)}) {
        const double lens = axis->lens1;
        double low = INFINITY, high = -INFINITY, least = INFINITY, size = 0;
        const auto add = [&](double p, double c, double w) {
            low = std::min(low, (p - lens * std::abs(c)) / w), high = std::max(high, (p + lens * std::abs(c)) / w);
            least = std::min(least, w);
        };
        int pair = 0;
        for (int a = 0; a < 6; ++a) {
            const double p = axis->p[a / 2][a % 2], c = axis->c[a / 2][a % 2], w = axis->w[a / 2][a % 2];
            // The exact test counts from the picture's middle: its magnitudes are larger.
            size = std::max(size, std::abs(p) + lens * std::abs(c) + 8192 * std::abs(w));
            if (w >= near) add(p, c, w);
            for (int b = a + 1; b < 6; ++b, ++pair) {
                const double p2 = axis->p[b / 2][b % 2], c2 = axis->c[b / 2][b % 2], w2 = axis->w[b / 2][b % 2];
                if ((w >= near) == (w2 >= near) || pair == without) continue;
                const double s = (near - w) / (w2 - w);
                add(p + s * (p2 - p), c + s * (c2 - c), near);
            }
        }
        const double slack = 16 * 0x1p-24 * size / least;
        if (!(place >= low - slack && place <= high + slack)) return false;
    }
    return true;
}

bool ranges_keep(const Asked& q, bool swapped) {
    for (const auto& [axis, place] : {std::pair(&q.x, q.hx), std::pair(&q.y, q.hy)}) {
        const double lens = axis->lens1, slack = axis->slack() / 2;
        double front0 = INFINITY, front1 = -INFINITY, back0 = INFINITY, back1 = -INFINITY;
        for (int a = 0; a < 6; ++a) {
            const double p = axis->p[a / 2][a % 2], c = axis->c[a / 2][a % 2], w = axis->w[a / 2][a % 2];
            if (std::abs(w) <= 1e-6) return true;
            double &low = w > 0 ? front0 : back0, &high = w > 0 ? front1 : back1;
            low = std::min(low, p / w - (lens * std::abs(c) + slack) / std::abs(w));
            high = std::max(high, p / w + (lens * std::abs(c) + slack) / std::abs(w));
        }
        const bool open_low = swapped ? front0 > back1 : front0 < back1;
        const bool open_high = swapped ? front1 < back0 : front1 > back0;
        if ((!open_low && place < front0) || (!open_high && place > front1)) return false;
    }
    return true;
}

using Keeps = std::function<bool(const Asked&)>;

struct Bound {
    const char* name;
    Keeps sound;
    std::vector<std::pair<const char*, Keeps>> broken;
    std::vector<Hard> classes{kHardClasses.begin(), kHardClasses.end()};
    int wanted = 12'000;
};

// Without the thin ones: what float noise accepts of those at the camera plane is in no bounds of real triangles but
// those that the exact test asks itself.
const std::vector<Hard> kAtTheCameraPlane = {Hard::kGeneric, Hard::kStraddling, Hard::kNearZero, Hard::kLattice};

Bound corner_bound() {
    const auto with = [](CornerMistake m) {
        return [m](const Asked& q) { return bilinear_keeps(q.x, q.u, q.s, m) && bilinear_keeps(q.y, q.v, q.s, m); };
    };
    return {"corners",
            with(CornerMistake::kNone),
            {{"the footprint's width is dropped", with(CornerMistake::kNoFootprintWidth)},
             {"a vertex is forgotten", with(CornerMistake::kVertexForgotten)},
             {"the circle of confusion has lost its sign", with(CornerMistake::kUnsignedCoc)},
             {"u stands for v", [](const Asked& q) { return bilinear_keeps(q.y, q.u, q.s, CornerMistake::kNone); }},
             {"the middle of the shutter stands for all",
              [](const Asked& q) { return bilinear_keeps(q.x, q.u, 0.5, CornerMistake::kNone); }},
             {"the first segment stands for all", [](const Asked& q) {
                  const double first = q.s + static_cast<double>(q.hard->local.segment);
                  return bilinear_keeps(q.x, q.u, first, CornerMistake::kNone);
              }}}};
}

Bound line_bound() {
    const auto with = [](bool swapped) {
        return [swapped](const Asked& q) {
            return lines_keep(q.x, q.u, q.s, swapped) && lines_keep(q.y, q.v, q.s, swapped);
        };
    };
    return {"lines", with(false), {{"the wrong envelope", with(true)}}};
}

Bound stage1_bound() {
    const auto with = [](bool swapped) {
        return [swapped](const Asked& q) { return stage1_keeps(q.x, q.u, swapped) && stage1_keeps(q.y, q.v, swapped); };
    };
    return {"stage 1", with(false), {{"smallest and largest are swapped", with(true)}}};
}

Bound stage2_bound() {
    const auto with = [](bool guarded) {
        return [guarded](const Asked& q) {
            return stage2_keeps(q.x, q.u, q.s, guarded) && stage2_keeps(q.y, q.v, q.s, guarded);
        };
    };
    return {"stage 2", with(true), {{"the guard of the signs is removed", with(false)}}};
}

Bound plane_bound() {
    const auto with = [](PlaneMistake m) { return [m](const Asked& q) { return planes_keep(q, m); }; };
    return {"planes",
            with(PlaneMistake::kNone),
            {{"the rest is dropped", with(PlaneMistake::kNoRest)},
             {"the quadratic term is taken for 0", with(PlaneMistake::kNoQuadratic)}}};
}

Bound half_space_bound() {
    const auto with = [](int n) { return [n](const Asked& q) { return half_spaces_keep(q, n); }; };
    return {"half-spaces", with(4), {{"a corner of the tile is forgotten", with(3)}}};
}

Bound facing_bound() {
    const auto with = [](bool inner) { return [inner](const Asked& q) { return facing_keeps(q, inner); }; };
    return {"facing", with(true), {{"the inner Bernstein coefficients are dropped", with(false)}}};
}

Bound box_bound() {
    Bound bound{"box", [](const Asked& q) { return box_keeps(q, -1); }, {}, kAtTheCameraPlane, 50'000};
    constexpr const char* kEdges[15] = {
        "edge 0 is removed",  "edge 1 is removed",  "edge 2 is removed",  "edge 3 is removed",  "edge 4 is removed",
        "edge 5 is removed",  "edge 6 is removed",  "edge 7 is removed",  "edge 8 is removed",  "edge 9 is removed",
        "edge 10 is removed", "edge 11 is removed", "edge 12 is removed", "edge 13 is removed", "edge 14 is removed"};
    for (int k = 0; k < 15; ++k) bound.broken.emplace_back(kEdges[k], [k](const Asked& q) { return box_keeps(q, k); });
    return bound;
}

Bound range_bound() {
    const auto with = [](bool swapped) { return [swapped](const Asked& q) { return ranges_keep(q, swapped); }; };
    return {"gamma ranges", with(false), {{"the conditions are swapped", with(true)}}, kAtTheCameraPlane};
}

class ABound : public ::testing::TestWithParam<Bound (*)()> {};

TEST_P(ABound, LosesSamplesOnlyWithAMistakeAndThenIsCaught) {
    const Bound bound = GetParam()();
    std::int64_t asked = 0, lost = 0;
    std::vector<std::int64_t> caught(bound.broken.size());
    for (const Hard hard : bound.classes) {
        Random r(9);
        for_each_accepted(hard, 4, bound.wanted * effort(), LensShape::kDisk, true,
                          [&](const HardCase& c, const LocalSample& s, const SampleHit& hit) {
                              const int size = 1 << r.below(4);
                              const Asked q =
                                  ask_about(c, support::square_around(s, size, {-1, 1, -c.ratio(), c.ratio(), 0, 1}), s,
                                            hit.front);
                              ++asked;
                              lost += !bound.sound(q);
                              for (std::size_t k = 0; k < caught.size(); ++k) caught[k] += !bound.broken[k].second(q);
                          });
    }
    EXPECT_EQ(lost, 0) << "of " << asked << ", without a mistake";
    for (std::size_t k = 0; k < caught.size(); ++k) EXPECT_GT(caught[k], 0) << bound.broken[k].first;
}

INSTANTIATE_TEST_SUITE_P(Culling, ABound,
                         ::testing::Values(corner_bound, line_bound, stage1_bound, stage2_bound, plane_bound,
                                           half_space_bound, facing_bound, box_bound, range_bound),
                         [](const auto& info) {
                             std::string name = info.param().name;
                             for (char& c : name)
                                 if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
                             return name;
                         });

}  // namespace
}  // namespace pentaprism
