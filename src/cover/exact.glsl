// Twin of cover/exact.h: the exact 5D coverage test, with the same roundings in the same order. Homogeneous edge functions
// (Olano & Greer 1997); the watertight tie rule and condition (N) are docs/develop/algorithms.md 2.

#include "bound/local_triangle.glsl"

uniform bool orthographic;

struct SampleHit {
    bool hit;
    float depth;
    vec3 barycentrics;
    bool front;
};

const SampleHit kMiss = SampleHit(false, 0.0, vec3(0.0), true);

// The triangle as the sample's lens position and time place it, relative to the sample's ray.
struct Deltas {
    vec3 x, y, w, z;
};

// Two rounded products and one rounded difference: swapping i and j negates it exactly, hence neighbours agree.
float edge(Deltas D, int i, int j) {
    precise float a = D.x[i] * D.y[j], b = D.x[j] * D.y[i];
    precise float e = a - b;
    return e;
}

// Sign of edge i -> j; a sample on the edge counts as if it were at (x + h, y + h^2) for a vanishing h > 0.
int sign_with_ties(float e, Deltas D, int i, int j) {
    if (e > 0.0) return 1;
    if (e < 0.0) return -1;
    precise float p = D.w[j] * D.y[i], q = D.w[i] * D.y[j];
    if (p > q) return 1;
    if (p < q) return -1;
    precise float r = D.w[i] * D.x[j], s = D.w[j] * D.x[i];
    return r > s ? 1 : r < s ? -1 : 0;
}

bool straddles_zero(vec3 v) {
    return least(v) <= 0.0 && largest(v) >= 0.0;
}

// Depth and barycentrics from the edge functions: perspective-correct whatever the signs of w.
SampleHit resolve(Deltas D, float e0, float e1, float e2) {
    precise float sum = (e0 + e1) + e2;
    precise float moment = (e0 * D.z[0] + e1 * D.z[1]) + e2 * D.z[2];
    precise float depth = quotient(moment, sum);
    return SampleHit(sum != 0.0, min(max(depth, least(D.z)), largest(D.z)),
                     vec3(quotient(e0, sum), quotient(e1, sum), quotient(e2, sum)), sum > 0.0);
}

SampleHit cover_sample(LocalTriangle T, LocalSample s, vec2 centre) {
    float tau = segment_time(T, s.t);
    if (!(tau >= 0.0 && tau < 1.0)) return kMiss;
    vec3 w = fused(tau, T.dw, T.qw), c = fused(tau, T.dc, T.qc);
    vec3 x = fused(s.u, c, fused(tau, T.dx, T.qx)), y = fused(s.v, c, fused(tau, T.dy, T.qy));
    Deltas D = Deltas(fused(-s.hx, w, x), fused(-s.hy, w, y), w, orthographic ? fused(tau, T.dz, T.qz) : w);
    float e0 = edge(D, 1, 2), e1 = edge(D, 2, 0), e2 = edge(D, 0, 1);
    int side = sign_with_ties(e0, D, 1, 2);
    if (side == 0 || side != sign_with_ties(e1, D, 2, 0) || side != sign_with_ties(e2, D, 0, 1)) return kMiss;
    if (!T.two_sided && side < 0) return kMiss;
    // Condition (N): for slivers the edge functions may be rounding noise that agrees in sign beyond the tips.
    if (!straddles_zero(D.x) || !straddles_zero(D.y)) return kMiss;
    precise float gx = centre.x + s.hx, gy = centre.y + s.hy;
    if (!(gx >= T.box.x && gx <= T.box.y && gy >= T.box.z && gy <= T.box.w)) return kMiss;
    SampleHit hit = resolve(D, e0, e1, e2);
    hit.hit = hit.hit && hit.depth >= z_near && hit.depth <= z_far;
    return hit;
}
