// ut-vt-lines: one line above and one below in the (u, t) and (v, t) squares, for each tile.
//
// The first test of Munkberg & Akenine-Moller 2012, Hyperplane Culling for Stochastic Rasterization: a line in (u, t)
// that has the whole triangle on one side refuses the samples on the other. Known to us by its abstract and claims; the
// original finds its lines by a separating-line search, we take the first affine function of the pair that bounds the
// dual-space corner values (cull_lines.h has form and proof).

#include "cull/cull_lines.h"

namespace pentaprism {
namespace {

bool prepare(const LocalTriangle& T, const Footprint& footprint, CullState& state) {
    return state.as<LineBounds>().prepare(T, footprint);
}

bool keeps(const CullState& state, const LocalSample& sample) {
    const LineBounds& bounds = state.as<LineBounds>();
    const float u = sample.u - bounds.u0, v = sample.v - bounds.v0, s = bounds.time(sample.t) - bounds.s0;
    return !(bounds.sides[0].first.at(u, s) < 0 || bounds.sides[1].first.at(u, s) < 0 ||
             bounds.sides[2].first.at(v, s) < 0 || bounds.sides[3].first.at(v, s) < 0);
}

}  // namespace

extern const CullTest ut_vt_lines_test;
const CullTest ut_vt_lines_test{"ut-vt-lines", "Munkberg & Akenine-Moller 2012, Hyperplane Culling, first test",
                                prepare, keeps, Grain::kTile};

}  // namespace pentaprism
