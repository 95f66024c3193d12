// hull: the convex hull of the moving triangle's six points on the screen, moved out by the circle of confusion.
//
// McGuire, Enderton, Shirley, Luebke 2010, Real-Time Stochastic Rasterization on Conventional GPU Architectures, draw
// that hull and test every sample in it. A footprint outside one of its sides holds no hit: with w > 0 the place of a
// hit is a quotient of affine functions, so in any direction n the farthest one is at one of the six points
// (docs/develop/algorithms.md 3.2, 3.5; bound/local_bounds.h computes it). The circle of confusion moves a side out by
// what it reaches in the direction of the side, over a lens that is a disk. The paper's hull of a triangle that reaches
// the camera plane is that of fifteen candidate points; we take their box there.
//
// A bound of the screen alone: it says nothing of single samples, whatever blurs.

#include "bound/local_bounds.h"
#include "cull/cull_test.h"

namespace pentaprism {
namespace {

bool begin(const LocalTriangle& T, const Footprint& picture, CullSetup& setup) {
    const SegmentDomain domain = segment_domain(T, picture.domain);
    if (domain.empty()) return false;
    setup.as<HullPolygon>() = hull_polygon(T, domain, {picture.x0, picture.x1, picture.y0, picture.y1});
    return true;
}
bool prepare(const LocalTriangle&, const Footprint& f, CullState& state) {
    return state.setup->as<HullPolygon>().meets(f.x0, f.x1, f.y0, f.y1);
}

}  // namespace

extern const CullTest hull_test;
const CullTest hull_test{"hull",        "McGuire, Enderton, Shirley, Luebke 2010, hull of the swept triangle",
                         prepare,       keeps_every_sample,
                         Grain::kPixel, begin};

}  // namespace pentaprism
