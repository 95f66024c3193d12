// facing: a single-sided triangle that shows its back to all samples of a footprint.
//
// Munkberg & Akenine-Moller 2011, Backface Culling for Motion Blur and Depth of Field: the determinant as a Bernstein
// polynomial in t (bound/facing.h, docs/develop/algorithms.md 3.6 for form, proof and slack). Binning already drops
// what shows its back to the whole shutter and lens; over a bucket's part of them it also refuses triangles that turn
// over. Two-sided triangles are always kept.

#include "bound/facing.h"

#include "cull/cull_test.h"

namespace pentaprism {
namespace {

bool prepare(const LocalTriangle& T, const Footprint& footprint, CullState&) {
    const SegmentDomain domain = segment_domain(T, footprint.domain);
    if (domain.empty()) return false;
    return T.two_sided || facing(T, domain) != Facing::kBack;
}

}  // namespace

extern const CullTest facing_test;
const CullTest facing_test{"facing", "Munkberg & Akenine-Moller 2011, Backface Culling", prepare, keeps_every_sample,
                           Grain::kBucket};

}  // namespace pentaprism
