// Twin of hull.cpp: the convex hull of the moving triangle's six points on the screen, moved out by the circle of
// confusion (McGuire, Enderton, Shirley, Luebke 2010). The geometry shader draws that hull instead of a box; here it is
// decided which of the pixels drawn at its border count.

#include "bound/local_bounds.glsl"

bool hull_keeps(LocalTriangle T, Footprint footprint, LocalSample sampled) {
    float ratio = float(lens_ratio);
    SegmentDomain d = segment_domain(T, Domain(-1.0, 1.0, -ratio, ratio, 0.0, 1.0));
    return !is_empty(d) && hull_meets(T, d, footprint);
}
