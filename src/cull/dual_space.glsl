// Twin of dual_space.cpp: an interval of u, one of v and one of t for each footprint. Laine, Aila, Karras, Lehtinen 2011,
// Clipless Dual-Space Bounds for Faster Stochastic Rasterization.

#include "cull/cull_intervals.glsl"

bool dual_space_keeps(LocalTriangle T, Footprint footprint, LocalSample sampled) {
    SegmentDomain domain = segment_domain(T, footprint.domain);
    return narrow_domain(T, footprint, domain) && is_within(domain, sampled, segment_time(T, sampled.t));
}
