// Twin of shade/seen_samples.cpp, project(): the barycentrics that a sample sees, inside the triangle.

#include "bound/local_triangle.glsl"

int segment_at(float t, int segments) {
    return min(int(t * float(segments)), segments - 1);
}

vec3 seen_barycentrics(LocalTriangle T, LocalSample s, out bool front) {
    precise float tau = s.t * T.segments - T.segment;
    precise vec3 w = T.qw + tau * T.dw, c = T.qc + tau * T.dc;
    precise vec3 x = ((T.qx + tau * T.dx) + s.u * c) - s.hx * w, y = ((T.qy + tau * T.dy) + s.v * c) - s.hy * w;
    precise vec3 e = x.yzx * y.zxy - x.zxy * y.yzx;
    precise float sum = (e.x + e.y) + e.z;
    front = sum > 0.0;
    precise float over_sum = 1.0 / sum;
    precise vec3 kept = max(e * over_sum, vec3(0.0));
    precise float total = (kept.x + kept.y) + kept.z, over_total = 1.0 / total;
    bool usable = !isinf(total) && !isnan(total) && total > 0.0;
    return usable ? kept * over_total : vec3(1.0 / 3.0);
}
