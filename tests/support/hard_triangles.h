#pragma once
// Moving, defocused triangles that are hard for bounds and culling tests, by class, and samples built forwards onto
// them: nearly all of these are hits, so that a wrong rejection shows (docs/develop/algorithms.md 4.13).

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "bound/local_triangle.h"
#include "cover/exact.h"
#include "support/random.h"

namespace pentaprism::support {

enum class Hard {
    kGeneric,
    kStraddling,
    kNearZero,
    kCrossingFocus,
    kArbitraryCoc,
    kDegenerate,
    kLattice,
    kTinyFast,
    kStatic,
    kFocusPull,
    kSliver
};
inline constexpr std::array kHardClasses = {
    Hard::kGeneric, Hard::kStraddling, Hard::kNearZero, Hard::kCrossingFocus, Hard::kArbitraryCoc, Hard::kDegenerate,
    Hard::kLattice, Hard::kTinyFast,   Hard::kStatic,   Hard::kFocusPull,     Hard::kSliver};

inline std::string name_of(Hard hard) {
    constexpr const char* kNames[] = {"generic in front", "w straddles zero", "w at or near zero",     "crosses focus",
                                      "arbitrary CoC",    "degenerate",       "small-integer lattice", "tiny and fast",
                                      "static",           "focus pulled",     "collinear or thin"};
    return kNames[static_cast<int>(hard)];
}

/// One triangle in a picture, and the cell of the exact test's grid in which it is looked at.
struct HardCase {
    Frame frame;
    int segment = 0;
    int cx = 0, cy = 0;
    CellCentre centre{};
    MovingTriangle moving{};  ///< the frame's, of that segment
    LocalTriangle local{};
    std::uint64_t serial = 0;  ///< another number for another triangle
    float ratio() const { return static_cast<float>(frame.view.lens.ratio); }
};

/// Vertices in the cell's own coordinates: x / w is in pixels from the cell's middle. Index [corner][end].
struct Corners {
    double x[3][2], y[3][2], w[3][2], c[3][2];
};

namespace detail {

inline void place(Random& r, Corners& k, double size, double common, double own, double w0, double w1) {
    const double x0 = r.range(-18, 18), y0 = r.range(-18, 18), mx = r.range(-common, common),
                 my = r.range(-common, common);
    for (int i = 0; i < 3; ++i) {
        const double x = x0 + r.range(-size, size), y = y0 + r.range(-size, size);
        for (int e = 0; e < 2; ++e) {
            const double w = r.range(w0, w1);
            k.w[i][e] = w;
            k.x[i][e] = w * (x + e * (mx + r.range(-own, own)));
            k.y[i][e] = w * (y + e * (my + r.range(-own, own)));
        }
    }
}

inline void focus(Corners& k, int end, double blur, double distance) {
    for (int i = 0; i < 3; ++i) k.c[i][end] = blur * (k.w[i][end] / distance - 1.0);
}

inline void around_zero(Random& r, Corners& k, double near) {
    for (int i = 0; i < 3; ++i)
        for (int e = 0; e < 2; ++e) {
            const double special[] = {0.0,   near, near * (1 + 0x1p-22), near * (1 - 0x1p-22), 1e-7,
                                      -1e-7, 1.0,  r.range(-1, 3)};
            k.w[i][e] = special[r.below(8)];
            k.x[i][e] = r.range(-6, 6);
            k.y[i][e] = r.range(-6, 6);
        }
}

inline void make_degenerate(Random& r, Corners& k) {
    const int kind = r.below(3);
    const double s = r.range(0, 1);
    for (int e = 0; e < 2; ++e) {
        auto copy = [&](int to, int from, double f, int other) {
            for (auto* p : {&k.x, &k.y, &k.w, &k.c}) (*p)[to][e] = (*p)[from][e] + f * ((*p)[other][e] - (*p)[from][e]);
        };
        if (kind == 0) copy(2, 1, 0, 1);                    // an edge
        if (kind == 1) copy(2, 0, s, 1);                    // collinear
        if (kind == 2) copy(1, 0, 0, 0), copy(2, 0, 0, 0);  // a point
    }
}

inline void make_sliver(Random& r, Corners& k) {
    const double f = r.range(-0.5, 1.5), thickness = r.chance(0.4) ? 0.0 : std::exp2(r.range(-26, -12));
    for (int e = 0; e < 2; ++e) {
        for (auto* p : {&k.x, &k.y, &k.w, &k.c}) (*p)[2][e] = (*p)[0][e] + f * ((*p)[1][e] - (*p)[0][e]);
        k.x[2][e] += thickness * r.range(-8, 8) * k.w[2][e];
    }
}

inline void lattice(Random& r, Corners& k) {
    const int lowest_w = r.chance(0.3) ? -1 : 1;
    for (int i = 0; i < 3; ++i)
        for (int e = 0; e < 2; ++e) {
            k.x[i][e] = r.between(-8, 8);
            k.y[i][e] = r.between(-8, 8);
            k.w[i][e] = r.between(lowest_w, 2);
            k.c[i][e] = r.between(-2, 2);
        }
}

}  // namespace detail

inline Corners hard_corners(Random& r, Hard hard, double near) {
    Corners k{};
    const double blur = r.magnitude(0.1, 60), distance = r.range(1.5, 12), size = r.magnitude(0.2, 50);
    detail::place(r, k, size, r.magnitude(0.1, 50), r.chance(0.5) ? 0 : r.magnitude(0.1, 20), 1, 14);
    if (hard == Hard::kGeneric)
        detail::place(r, k, size, r.magnitude(0.1, 50), r.chance(0.5) ? 0 : 10, 6, r.range(6, 9));
    if (hard == Hard::kStraddling) detail::place(r, k, 40, 40, 20, -2, 3);
    if (hard == Hard::kNearZero) detail::around_zero(r, k, near);
    if (hard == Hard::kTinyFast) detail::place(r, k, r.magnitude(0.02, 1), 200, 0, 4, 4.1);
    const bool pinhole = r.chance(0.15);
    for (int e = 0; e < 2; ++e)
        detail::focus(k, e, pinhole ? 0 : blur, hard == Hard::kCrossingFocus ? r.range(4, 8) : distance);
    if (hard == Hard::kFocusPull) detail::focus(k, 1, r.magnitude(0.1, 60), r.range(1.5, 12));
    if (hard == Hard::kArbitraryCoc)
        for (auto& corner : k.c)
            for (double& c : corner) c = r.sign() * r.magnitude(0.01, 100);
    if (hard == Hard::kDegenerate) detail::make_degenerate(r, k);
    if (hard == Hard::kSliver) detail::make_sliver(r, k);
    if (hard == Hard::kLattice) detail::lattice(r, k);
    if (hard == Hard::kStatic)
        for (auto* p : {&k.x, &k.y, &k.w, &k.c})
            for (int i = 0; i < 3; ++i) (*p)[i][1] = (*p)[i][0];
    return k;
}

/// Puts one triangle with such corners into `out.frame`; both sides count unless asked otherwise.
inline void make_hard_case(Random& r, Hard hard, HardCase& out, bool two_sided = true) {
    Frame& frame = out.frame;
    frame.view = View{};
    frame.view.width = r.between(16, r.chance(0.5) ? 200 : 8192);
    frame.view.height = r.between(16, r.chance(0.5) ? 200 : 8192);
    frame.view.lens.ratio = r.chance(0.5) ? 1.0 : r.range(0.4, 2.5);
    frame.view.depth_near = hard == Hard::kLattice ? 0.5 : r.magnitude(0.01, 0.5);
    out.cx = r.below((frame.view.width + kCellSize - 1) / kCellSize);
    out.cy = r.below((frame.view.height + kCellSize - 1) / kCellSize);
    out.centre = cell_centre(frame.view, out.cx, out.cy);

    Part part;
    part.triangle_count = 1;
    part.vertex_count = 3;
    part.moves = hard != Hard::kStatic || r.chance(0.5);
    part.segments = part.moves ? r.between(1, 8) : 1;
    part.two_sided = two_sided;
    out.segment = r.below(part.segments);
    frame.parts.assign(1, part);
    frame.corners = {0, 1, 2};
    frame.part_of = {0};
    const Corners k = hard_corners(r, hard, frame.view.depth_near);
    frame.points.resize(3 * (static_cast<std::size_t>(part.segments) + 1));
    for (int knot = 0; knot <= part.segments; ++knot)
        for (int i = 0; i < 3; ++i) {
            const int e = knot > out.segment ? 1 : 0;
            frame.points[3 * static_cast<std::size_t>(knot) + i] =
                glm::vec4(static_cast<float>(k.x[i][e] + out.centre.x * k.w[i][e]),
                          static_cast<float>(k.y[i][e] + out.centre.y * k.w[i][e]), static_cast<float>(k.w[i][e]),
                          static_cast<float>(k.c[i][e]));
        }
    out.moving = moving_triangle(frame, 0, out.segment);
    out.local = localize(frame, 0, out.segment, out.centre);
    ++out.serial;
}

/// Which lens points a sample may have: those of a disk, as all samples of pictures, or all of its square, as most
/// bounds allow.
enum class LensShape { kDisk, kSquare };

inline bool on_lens(LensShape shape, const HardCase& hard_case, const LocalSample& s) {
    const double v = double{s.v} / hard_case.frame.view.lens.ratio;
    return shape == LensShape::kSquare || double{s.u} * s.u + v * v <= 1 + 0x1p-22;
}

namespace detail {

inline void lens_point(Random& r, LensShape shape, Hard hard, double& u, double& v) {
    u = 2 * r.biased() - 1;
    v = 2 * r.biased() - 1;
    if (hard == Hard::kLattice && r.chance(0.7)) u = r.between(-2, 2) * 0.5, v = r.between(-2, 2) * 0.5;
    const double length = std::hypot(u, v);
    if (shape == LensShape::kDisk && length > 1) u *= (1 - 1e-7) / length, v *= (1 - 1e-7) / length;
}

inline void weights(Random& r, Hard hard, double a[3]) {
    const bool beyond = hard == Hard::kSliver && r.chance(0.5);  // samples on the line, outside the tips
    for (int i = 0; i < 3; ++i) a[i] = beyond ? r.range(-1, 2) : -std::log(1 - r.unit());
    if (!beyond && r.chance(0.4)) a[r.below(3)] = 0;
    if (!beyond && r.chance(0.2)) a[r.below(3)] *= 1e-7;
    const double sum = a[0] + a[1] + a[2];
    for (int i = 0; i < 3; ++i) a[i] /= sum;
}

}  // namespace detail

/// A sample aimed at the triangle; false if it misses or falls outside the cell.
inline bool aim(Random& r, const HardCase& hard_case, Hard hard, LensShape shape, LocalSample& sample, SampleHit& hit) {
    const LocalTriangle& T = hard_case.local;
    double a[3], u, v;
    detail::weights(r, hard, a);
    detail::lens_point(r, shape, hard, u, v);
    double tau = hard == Hard::kLattice && r.chance(0.7) ? r.below(4) * 0.25 : r.biased();
    const double t = std::floor((tau + T.segment) / T.segments * 16777216.0) / 16777216.0;
    sample.t = static_cast<float>(std::min(t, 1.0 - 0x1p-24));
    sample.u = static_cast<float>(u);
    sample.v =
        std::clamp(static_cast<float>(v * hard_case.frame.view.lens.ratio), -hard_case.ratio(), hard_case.ratio());
    tau = static_cast<double>(sample.t) * T.segments - T.segment;
    double x = 0, y = 0, w = 0;
    for (int i = 0; i < 3; ++i) {
        const double c = T.qc[i] + tau * T.dc[i];
        x += a[i] * (T.qx[i] + tau * T.dx[i] + sample.u * c);
        y += a[i] * (T.qy[i] + tau * T.dy[i] + sample.v * c);
        w += a[i] * (T.qw[i] + tau * T.dw[i]);
    }
    if (!(w > 0)) return false;
    x /= w;
    y /= w;
    if (!r.chance(0.3)) {  // the lattice of real samples
        x = std::round(x * 256) / 256;
        y = std::round(y * 256) / 256;
    }
    constexpr double half = kCellSize / 2;
    if (!(std::abs(x) < half && std::abs(y) < half)) return false;
    sample.hx = static_cast<float>(x);
    sample.hy = static_cast<float>(y);
    hit = cover_sample(T, sample, hard_case.centre);
    return hit.hit;
}

/// Moves an accepted sample along one coordinate to the last float that is still accepted on the way to a random place:
/// there the exact test decides by its last bits. t moves in its steps of 2^-24. `hit` is that of the new place.
inline void push_to_border(Random& r, const HardCase& hard_case, LensShape shape, LocalSample& sample, SampleHit& hit) {
    const int which = r.below(5);
    float* const coordinate[] = {&sample.hx, &sample.hy, &sample.u, &sample.v, &sample.t};
    const double low[] = {-16, -16, -1, -hard_case.ratio(), 0}, high[] = {16, 16, 1, hard_case.ratio(), 1 - 0x1p-24};
    const auto rounded = [&](double value) {
        return static_cast<float>(which == 4 ? std::floor(value * 0x1p24) * 0x1p-24 : value);
    };
    float inside = *coordinate[which], outside = rounded(r.range(low[which], high[which]));
    for (int step = 0; step < 60; ++step) {
        const float middle = rounded(0.5 * (static_cast<double>(inside) + outside));
        if (middle == inside || middle == outside) break;
        *coordinate[which] = middle;
        const SampleHit there = cover_sample(hard_case.local, sample, hard_case.centre);
        const bool accepted = there.hit && on_lens(shape, hard_case, sample);
        (accepted ? inside : outside) = middle;
        if (accepted) hit = there;
    }
    *coordinate[which] = inside;
}

/// Calls visit(case, sample, hit) for at least `wanted` accepted samples of that class; returns how many there were.
template <class Visit>
int for_each_accepted(Hard hard, std::uint64_t seed, int wanted, LensShape shape, bool two_sided, Visit&& visit) {
    Random r(seed * 64 + static_cast<std::uint64_t>(hard));
    HardCase hard_case;
    int accepted = 0;
    for (int triangle = 0; accepted < wanted && triangle < 8 * wanted; ++triangle) {
        make_hard_case(r, hard, hard_case, two_sided);
        for (int attempt = 0; attempt < 24; ++attempt) {
            LocalSample sample;
            SampleHit hit;
            if (!aim(r, hard_case, hard, shape, sample, hit)) continue;
            ++accepted;
            visit(hard_case, sample, hit);
        }
    }
    return accepted;
}

}  // namespace pentaprism::support
