#pragma once
// What a pixel sees of an edge that moves, is out of focus, or both: the integrand that sample patterns are for, and
// its exact answers.
//
// The integrand is whether an edge at `a` is to the right of the sample: x + L*t + R*u < a. x lies on a lattice of
// 1/256, and the exact answers count it so.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sample/sample_table.h"

namespace pentaprism::support {

struct Edge {
    const char* name;
    double motion, blur;  // L, R in pixels
    bool seen_by(const SamplePoint& s, double a) const { return s.x + motion * s.t + blur * s.u < a; }
};
inline constexpr Edge kEdges[] = {{"still", 0, 0}, {"moving", 6, 0}, {"out of focus", 0, 4}, {"both", 6, 4}};

// Part of the unit disk with u < s.
inline double part_of_disk(double s) {
    if (s <= -1) return 0;
    if (s >= 1) return 1;
    return 0.5 + (s * std::sqrt(1 - s * s) + std::asin(s)) / std::numbers::pi;
}

// Its integral from -1 to s.
inline double integral_of_part(double s) {
    if (s <= -1) return 0;
    if (s >= 1) return s;
    const double root = std::sqrt(1 - s * s);
    return 0.5 * s + (s * std::asin(s) + root - root * root * root / 3) / std::numbers::pi;
}

inline double exact(const Edge& edge, double a) {
    double sum = 0;
    for (int k = 0; k < 256; ++k) {
        const double b = a - k / 256.0;  // L*t + R*u < b
        const double L = edge.motion, R = edge.blur;
        if (L == 0 && R == 0) sum += b > 0;
        if (L > 0 && R == 0) sum += std::clamp(b / L, 0.0, 1.0);
        if (L == 0 && R > 0) sum += part_of_disk(b / R);
        if (L > 0 && R > 0) sum += (integral_of_part(b / R) - integral_of_part((b - L) / R)) * R / L;
    }
    return sum / 256;
}

inline double estimate(const SampleTable& table, const Edge& edge, int px, int py, double a) {
    int seen = 0;
    for (int i = 0; i < table.spp(); ++i) seen += edge.seen_by(table.sample(px, py, i), a);
    return static_cast<double>(seen) / table.spp();
}

// Evenly spread over [0, 1).
inline double golden(int n) {
    return std::fmod((n + 1) * 0.6180339887498949, 1.0);
}

}  // namespace pentaprism::support
