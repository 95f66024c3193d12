// improved-dual-space-as-printed: trilinear slices of the triangle's whole range on the screen.
//
// Laine & Karras 2011, Improved Dual-Space Bounds for Simultaneous Motion and Defocus Blur, as the paper computes them:
// the corner values of max X_i and min X_i once for a triangle, at the two ends of its screen bounds; for a tile they
// are interpolated linearly at both of its edges, and the larger (for max) or smaller (for min) is taken. That costs
// less for each tile than improved_dual_space.cpp, which evaluates the vertices again, and is a little looser: the
// maximum of affine functions is convex, so its chord lies above it.
//
// Two things the paper does not say. A chord is a bound between its ends only, so a tile is cut to the triangle's range
// first and refused if it lies outside. A range without width cannot be divided by, so it is widened.
//
// Rounding: as in improved_dual_space.cpp, of the magnitude at the farthest end of the range.

#include "bound/local_bounds.h"
#include "cull/cull_axis.h"

namespace pentaprism {
namespace {

struct AxisSetup {
    double g0, g1;        // the triangle's range, cut to the picture
    double bounds[2][8];  // max[2][2], min[2][2] at both ends
};
struct Setup {
    AxisSetup x, y;
    SegmentDomain domain;
};

bool begin_axis(const Axis& axis, double g0, double g1, double lens0, double lens1, AxisSetup& out) {
    if (!(g0 <= g1)) return false;
    constexpr double kLeast = 1e-3;  // pixels
    out.g0 = g0 - kLeast;
    out.g1 = g1 + kLeast;
    const double reach = std::max(std::abs(out.g0), std::abs(out.g1));
    const double slack =
        32.0 * kUnitRoundoff * magnitude(axis, std::max(std::abs(lens0), std::abs(lens1)), std::max(17.0, reach));
    for (int end = 0; end < 2; ++end) {
        const double g = end == 0 ? out.g0 : out.g1;
        const CornerBounds m = corner_bounds(axis, {g, g, lens0, lens1}, 0.0);
        for (int k = 0; k < 4; ++k) {
            out.bounds[end][k] = m.max[k / 2][k % 2] + slack;
            out.bounds[end][4 + k] = m.min[k / 2][k % 2] - slack;
        }
    }
    return true;
}

bool begin(const LocalTriangle& T, const Footprint& picture, CullSetup& memory) {
    Setup& setup = memory.as<Setup>();
    setup.domain = segment_domain(T, picture.domain);
    if (setup.domain.empty()) return false;
    const LocalBox box = local_bounds(T, setup.domain, {picture.x0, picture.x1, picture.y0, picture.y1});
    Axis x, y;
    axes_at_ends(T, setup.domain.s0, setup.domain.s1, x, y);
    return begin_axis(x, std::max(box.x0, picture.x0), std::min(box.x1, picture.x1), setup.domain.u0, setup.domain.u1,
                      setup.x) &&
           begin_axis(y, std::max(box.y0, picture.y0), std::min(box.y1, picture.y1), setup.domain.v0, setup.domain.v1,
                      setup.y);
}

// False: the footprint lies outside the triangle's range.
bool slice(const AxisSetup& axis, double g0, double g1, CornerBounds& m) {
    g0 = std::max(g0, axis.g0);
    g1 = std::min(g1, axis.g1);
    if (!(g0 <= g1)) return false;
    const double width = axis.g1 - axis.g0, f0 = (g0 - axis.g0) / width, f1 = (g1 - axis.g0) / width;
    for (int k = 0; k < 8; ++k) {
        const double low = axis.bounds[0][k], step = axis.bounds[1][k] - low;
        const double at0 = low + f0 * step, at1 = low + f1 * step;
        if (k < 4)
            m.max[k / 2][k % 2] = std::max(at0, at1);
        else
            m.min[(k - 4) / 2][k % 2] = std::min(at0, at1);
    }
    return true;
}

bool prepare(const LocalTriangle& T, const Footprint& footprint, CullState& state) {
    const Setup& setup = state.setup->as<Setup>();
    CornerBounds x, y;
    if (!slice(setup.x, footprint.x0, footprint.x1, x) || !slice(setup.y, footprint.y0, footprint.y1, y)) return false;
    if (x.refused() || y.refused()) return false;
    state.as<Slices>() = Slices(T, setup.domain, x, y);
    return true;
}

bool keeps(const CullState& state, const LocalSample& sample) {
    return state.as<Slices>().keep(sample);
}

}  // namespace

extern const CullTest improved_dual_space_as_printed_test;
const CullTest improved_dual_space_as_printed_test{"improved-dual-space-as-printed",
                                                   "Laine & Karras 2011, trilinear slices of the whole range",
                                                   prepare,
                                                   keeps,
                                                   Grain::kTile,
                                                   begin};

}  // namespace pentaprism
