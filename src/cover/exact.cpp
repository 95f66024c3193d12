#include "cover/exact.h"

#include <algorithm>
#include <cmath>

namespace pentaprism {
namespace {

// The triangle as the sample's lens position and time place it, relative to the sample's ray
// (docs/develop/algorithms.md, 1.5): the sample is covered when the origin lies in the triangle (X_i, Y_i) and in front
// of the camera.
struct Deltas {
    float x[3], y[3], w[3], z[3];
};

Deltas deltas(const PlacedTriangle& placed, float hx, float hy) {
    Deltas D;
    for (int i = 0; i < 3; ++i) {
        D.x[i] = std::fma(-hx, placed.w[i], placed.x[i]);
        D.y[i] = std::fma(-hy, placed.w[i], placed.y[i]);
        D.w[i] = placed.w[i];
        D.z[i] = placed.z[i];
    }
    return D;
}

// Two rounded products and one rounded difference: swapping i and j negates it exactly, hence neighbours agree.
float edge(const Deltas& D, int i, int j) {
    const float a = D.x[i] * D.y[j], b = D.x[j] * D.y[i];
    return a - b;
}

// Sign of edge i -> j; a sample on the edge counts as if it were at (x + h, y + h^2) for a vanishing h > 0.
int sign_with_ties(float e, const Deltas& D, int i, int j) {
    if (e > 0.0f) return 1;
    if (e < 0.0f) return -1;
    const float p = D.w[j] * D.y[i], q = D.w[i] * D.y[j];
    if (p > q) return 1;
    if (p < q) return -1;
    const float r = D.w[i] * D.x[j], s = D.w[j] * D.x[i];
    if (r > s) return 1;
    if (r < s) return -1;
    return 0;
}

bool straddles_zero(const float v[3]) {
    return std::min({v[0], v[1], v[2]}) <= 0.0f && std::max({v[0], v[1], v[2]}) >= 0.0f;
}

// Depth and barycentrics from the edge functions: perspective-correct whatever the signs of w.
void resolve(const Deltas& D, const float e[3], SampleHit& hit) {
    const float sum = (e[0] + e[1]) + e[2];
    const float depth = ((e[0] * D.z[0] + e[1] * D.z[1]) + e[2] * D.z[2]) / sum;
    hit.depth = std::min(std::max(depth, std::min({D.z[0], D.z[1], D.z[2]})), std::max({D.z[0], D.z[1], D.z[2]}));
    for (int k = 0; k < 3; ++k) hit.barycentrics[k] = e[k] / sum;
    hit.front = sum > 0.0f;
    hit.hit = sum != 0.0f;
}

}  // namespace

PlacedTriangle place_triangle(const LocalTriangle& T, float u, float v, float t) {
    PlacedTriangle placed;
    const float tau = std::fma(t, T.segments, -T.segment);  // exact: t is a multiple of 2^-24
    placed.in_segment = tau >= 0.0f && tau < 1.0f;
    for (int i = 0; i < 3; ++i) {
        const float x = std::fma(tau, T.dx[i], T.qx[i]), y = std::fma(tau, T.dy[i], T.qy[i]);
        const float w = std::fma(tau, T.dw[i], T.qw[i]), c = std::fma(tau, T.dc[i], T.qc[i]);
        placed.x[i] = std::fma(u, c, x);
        placed.y[i] = std::fma(v, c, y);
        placed.w[i] = w;
        placed.z[i] = T.orthographic ? std::fma(tau, T.dz[i], T.qz[i]) : w;
    }
    return placed;
}

SampleHit cover_placed(const LocalTriangle& T, const PlacedTriangle& placed, float hx, float hy,
                       const CellCentre& centre) {
    if (!placed.in_segment) return {};
    const Deltas D = deltas(placed, hx, hy);
    const float e[3] = {edge(D, 1, 2), edge(D, 2, 0), edge(D, 0, 1)};
    const int sign = sign_with_ties(e[0], D, 1, 2);
    if (sign == 0 || sign != sign_with_ties(e[1], D, 2, 0) || sign != sign_with_ties(e[2], D, 0, 1)) return {};
    if (!T.two_sided && sign < 0) return {};
    // Condition (N): for slivers the edge functions may be rounding noise that agrees in sign beyond the tips.
    if (!straddles_zero(D.x) || !straddles_zero(D.y)) return {};
    if (T.behind) {
        const float gx = centre.x + hx, gy = centre.y + hy;
        if (!(gx >= T.box[0] && gx <= T.box[1] && gy >= T.box[2] && gy <= T.box[3])) return {};
    }
    SampleHit hit;
    resolve(D, e, hit);
    if (!hit.hit || !(hit.depth >= T.z_near && hit.depth <= T.z_far)) return {};
    return hit;
}

SampleHit cover_sample(const LocalTriangle& T, const LocalSample& s, const CellCentre& centre) {
    return cover_placed(T, place_triangle(T, s.u, s.v, s.t), s.hx, s.hy, centre);
}

SampleHit project_sample(const LocalTriangle& T, const LocalSample& s) {
    const Deltas D = deltas(place_triangle(T, s.u, s.v, s.t), s.hx, s.hy);
    const float e[3] = {edge(D, 1, 2), edge(D, 2, 0), edge(D, 0, 1)};
    SampleHit hit;
    resolve(D, e, hit);
    return hit;
}

}  // namespace pentaprism
