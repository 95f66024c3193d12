// clip-space-affine: two lines above and two below in the (u, t) and (v, t) squares.
//
// What the second stage of Wu 2013 (Clip Space Sample Culling for Stochastic Rasterization) is after, linear bounds of
// t by u, without its divisions, poles and cases of sign: the bilinear bounds of docs/develop/algorithms.md 4.1
// replaced by the affine functions closest above them (4.6.4 and cull_lines.h have form and proof). Such lines can be
// solved for t, so that samples sorted by t are enumerated; tested one by one they are a little looser than
// improved-dual-space and cost a little more.

#include "cull/cull_lines.h"

namespace pentaprism {
namespace {

bool prepare(const LocalTriangle& T, const Footprint& footprint, CullState& state) {
    return state.as<LineBounds>().prepare(T, footprint);
}

bool keeps(const CullState& state, const LocalSample& sample) {
    const LineBounds& bounds = state.as<LineBounds>();
    const float u = sample.u - bounds.u0, v = sample.v - bounds.v0, s = bounds.time(sample.t) - bounds.s0;
    for (int side = 0; side < 4; ++side) {
        const float lens = side < 2 ? u : v;
        if (bounds.sides[side].first.at(lens, s) < 0 || bounds.sides[side].second.at(lens, s) < 0) return false;
    }
    return true;
}

}  // namespace

extern const CullTest clip_space_affine_test;
const CullTest clip_space_affine_test{"clip-space-affine", "after Wu 2013, as affine pairs of the dual-space bounds",
                                      prepare, keeps};

}  // namespace pentaprism
