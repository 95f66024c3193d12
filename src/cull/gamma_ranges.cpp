// gamma-ranges: screen bounds by dividing by w, for cameras without a near plane.
//
// Laine & Karras 2011, Improved Dual-Space Bounds, figure 4 (GetGammaRanges), with the case of w = 0 that the figure
// lacks (bound/local_bounds.h; docs/develop/algorithms.md 3.4 has the proof). It proves where the real triangle can be
// seen; of a triangle that reaches the camera plane and is thin, the exact test in float may accept samples whose depth
// is rounding noise, but never outside the fifteen-edge box, so that is kept, too. Looser than the fifteen-edge box,
// which knows the near distance: useful only to compare.

#include "bound/local_bounds.h"
#include "cull/cull_test.h"

namespace pentaprism {
namespace {

struct Setup {
    LocalBox ranges, exact;
};

bool begin(const LocalTriangle& T, const Footprint& picture, CullSetup& memory) {
    const SegmentDomain domain = segment_domain(T, picture.domain);
    if (domain.empty()) return false;
    Setup& setup = memory.as<Setup>();
    setup.ranges = gamma_ranges(T, domain);
    setup.exact = T.behind ? local_bounds(T, domain, {picture.x0, picture.x1, picture.y0, picture.y1}) : LocalBox();
    return !setup.ranges.empty() || !setup.exact.empty();
}
bool prepare(const LocalTriangle&, const Footprint& f, CullState& state) {
    const Setup& setup = state.setup->as<Setup>();
    return setup.ranges.meets(f.x0, f.x1, f.y0, f.y1) || setup.exact.meets(f.x0, f.x1, f.y0, f.y1);
}

}  // namespace

extern const CullTest gamma_ranges_test;
const CullTest gamma_ranges_test{
    "gamma-ranges", "Laine & Karras 2011, GetGammaRanges", prepare, keeps_every_sample, Grain::kPixel, begin};

}  // namespace pentaprism
