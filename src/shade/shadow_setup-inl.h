// Sixteen triangles of a cell of a shadow map at once: their corners sheared to the cell's middle, how far their planes
// recede, and bounds on where in each row of texels they may be. Compiled once for each CPU target (shadow_raster.cpp).

#if defined(PENTAPRISM_SHADOW_SETUP_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef PENTAPRISM_SHADOW_SETUP_INL_H
#undef PENTAPRISM_SHADOW_SETUP_INL_H
#else
#define PENTAPRISM_SHADOW_SETUP_INL_H
#endif

#include "shade/light_view-inl.h"
#include "shade/shadow_raster.h"

HWY_BEFORE_NAMESPACE();
namespace pentaprism {
namespace HWY_NAMESPACE {

// Texels to each side, between a point and a sample that it asks, as a rule.
constexpr float kReach = 0.5f;

// Motion segments of triangles, x and y in texels. [corner][lane] or [lane]
struct ShadowSetup {
    alignas(64) float x[3][kLanes], y[3][kLanes], z[3][kLanes];
    alignas(64) float dx[3][kLanes], dy[3][kLanes], dz[3][kLanes];  // what a segment adds; 0 where nothing moves
    alignas(64) float nearest[kLanes];
    alignas(64) float recedes[kLanes];  // how much deeper their planes are within kReach
    // Texels of their boxes in the cell, first and last.
    alignas(64) std::int32_t x0[kLanes], x1[kLanes], y0[kLanes], y1[kLanes];
    // x - slope * y of all their points, of the slope of each side. [side][lane]
    alignas(64) float slope[3][kLanes], low[3][kLanes], high[3][kLanes];
};

// Columns of texels in a row, first and last.
struct ShadowSpans {
    alignas(64) std::int32_t first[kCellSize], last[kCellSize];
};

HWY_INLINE Vec difference_of_products(Vec a, Vec b, Vec c, Vec d) {
    return hn::Sub(hn::Mul(a, b), hn::Mul(c, d));
}

HWY_INLINE Vec least_of(const Vec v[6]) {
    return hn::Min(hn::Min(hn::Min(v[0], v[1]), hn::Min(v[2], v[3])), hn::Min(v[4], v[5]));
}

HWY_INLINE Vec most_of(const Vec v[6]) {
    return hn::Max(hn::Max(hn::Max(v[0], v[1]), hn::Max(v[2], v[3])), hn::Max(v[4], v[5]));
}

// The boxes of the triangles in the cell: no texel less than Casters::Boxes says.
HWY_INLINE void find_rects(F f, const ShadowCellWork& work, const std::uint32_t* list, int first, ShadowSetup& out) {
    constexpr int kFloats = sizeof(Casters::Boxes) / sizeof(float);
    static_assert(kFloats * sizeof(float) == sizeof(Casters::Boxes));
    constexpr float kSlack = 0x1p-12f;  // texels
    const I d;
    const hn::Vec<I> number = hn::BitCast(d, hn::LoadU(U(), list + first));
    const hn::Vec<I> index = hn::Add(hn::Mul(hn::ShiftRight<4>(number), hn::Set(d, kFloats)),
                                     hn::And(number, hn::Set(d, Casters::kLanes - 1)));
    static_assert(Casters::kLanes == 16);
    const Casters::Boxes& boxes = work.casters.boxes[0];
    const Vec scale = hn::Set(f, work.scale), size = hn::Set(f, static_cast<float>(kCellSize));
    const float half = 0.5f * static_cast<float>(work.width);
    const Vec left = hn::Set(f, static_cast<float>(work.cx * kCellSize) - half),
              top = hn::Set(f, half - static_cast<float>(work.cy * kCellSize));
    const auto texel = [&](Vec from_edge, float slack) HWY_ATTR {
        const Vec in_cell = hn::Add(from_edge, hn::Set(f, slack));
        return hn::ConvertTo(d, hn::Floor(hn::Min(hn::Max(in_cell, hn::Set(f, -1.0f)), size)));
    };
    const auto texels = [&](const float* field) HWY_ATTR { return hn::Mul(hn::GatherIndex(f, field, index), scale); };
    const hn::Vec<I> zero = hn::Zero(d), last = hn::Set(d, kCellSize - 1);
    hn::Store(hn::Max(zero, texel(hn::Sub(texels(boxes.x0), left), -kSlack)), d, out.x0 + first);
    hn::Store(hn::Min(last, texel(hn::Sub(texels(boxes.x1), left), kSlack)), d, out.x1 + first);
    hn::Store(hn::Max(zero, texel(hn::Sub(top, texels(boxes.y1)), -kSlack)), d, out.y0 + first);
    hn::Store(hn::Min(last, texel(hn::Sub(top, texels(boxes.y0)), kSlack)), d, out.y1 + first);
}

// Slopes of the sides and what lies between: the triangle does, whenever. Nothing is known of triangles that reach
// behind the light.
HWY_INLINE void find_strips(F f, const Vec x[6], const Vec y[6], Mask known, int first, ShadowSetup& out) {
    constexpr float kSteepest = 32.0f, kSlack = 0x1p-6f, kRounding = 0x1p-16f;
    const auto size_of = [&](const Vec v[6]) HWY_ATTR { return hn::Max(hn::Abs(least_of(v)), hn::Abs(most_of(v))); };
    const Vec size_x = size_of(x), size_y = size_of(y), infinite = hn::Set(f, INFINITY);
    for (int k = 0; k < 3; ++k) {
        const int p = k, q = (k + 1) % 3;
        const auto side = [&](const Vec v[6])
                              HWY_ATTR { return hn::Sub(hn::Add(v[q], v[q + 3]), hn::Add(v[p], v[p + 3])); };
        const Vec slope = hn::Div(side(x), side(y));
        const Mask usable = hn::And(known, hn::Le(hn::Abs(slope), hn::Set(f, kSteepest)));
        Vec across[6];
        for (int i = 0; i < 6; ++i) across[i] = hn::Sub(x[i], hn::Mul(slope, y[i]));
        const Vec size = hn::Add(size_x, hn::Mul(hn::Abs(slope), size_y));
        const Vec slack = hn::Add(hn::Set(f, kSlack), hn::Mul(hn::Set(f, kRounding), size));
        hn::Store(hn::IfThenElseZero(usable, slope), f, out.slope[k] + first);
        hn::Store(hn::IfThenElse(usable, hn::Sub(least_of(across), slack), hn::Neg(infinite)), f, out.low[k] + first);
        hn::Store(hn::IfThenElse(usable, hn::Add(most_of(across), slack), infinite), f, out.high[k] + first);
    }
}

// How much deeper the plane through these corners is kReach texels to each side.
HWY_INLINE Vec receding_of(F f, const Vec x[3], const Vec y[3], const Vec z[3]) {
    const Vec ax = hn::Sub(x[1], x[0]), ay = hn::Sub(y[1], y[0]), az = hn::Sub(z[1], z[0]);
    const Vec bx = hn::Sub(x[2], x[0]), by = hn::Sub(y[2], y[0]), bz = hn::Sub(z[2], z[0]);
    const Vec area = hn::Abs(difference_of_products(ax, by, bx, ay));
    const Vec rise =
        hn::Add(hn::Abs(difference_of_products(az, by, bz, ay)), hn::Abs(difference_of_products(bz, ax, az, bx)));
    const Vec recedes = hn::Div(hn::Mul(hn::Set(f, kReach), rise), area);
    return hn::IfThenElseZero(hn::IsFinite(recedes), recedes);  // else seen edge-on
}

// Places in WorldMotion::points of the corners when their segments begin and end.
struct ShadowCorners {
    alignas(64) std::int32_t open[3][kLanes], close[3][kLanes];
    HWY_NOINLINE void find(const ShadowCellWork& work, const std::uint32_t* list) {
        const WorldMotion& world = *work.casters.world;
        for (int lane = 0; lane < kLanes; ++lane) {
            const Casters::Boxes& boxes = work.casters.boxes[list[lane] / kLanes];
            const std::uint32_t at = list[lane] % kLanes, triangle = boxes.triangle(at);
            const Part& part = world.part_of(triangle);
            const std::array<std::uint32_t, 3> corner = world.corners(triangle);
            const std::uint32_t knot = boxes.segment[at] * part.vertex_count, step = part.moves ? part.vertex_count : 0;
            for (int k = 0; k < 3; ++k) {
                open[k][lane] = static_cast<std::int32_t>(corner[k] + knot);
                close[k][lane] = static_cast<std::int32_t>(corner[k] + knot + step);
            }
        }
    }
};

// `list`: kLanes of the cell's boxes.
HWY_NOINLINE void set_up(const ShadowCellWork& work, const std::uint32_t* list, ShadowSetup& out) {
    const F f;
    const I d;
    const LightView& view = work.casters.view;
    const bool perspective = view.perspective;
    const float middle = 0.5f * static_cast<float>(work.width) - 0.5f * kCellSize;
    const Vec centre_x = hn::Set(f, static_cast<float>(work.cx * kCellSize) - middle);
    const Vec centre_y = hn::Set(f, middle - static_cast<float>(work.cy * kCellSize));
    const Vec scale = hn::Set(f, work.scale), half = hn::Set(f, 0.5f);
    ShadowCorners corners;
    corners.find(work, list);
    for (int first = 0; first < kLanes; first += kWidth) {
        find_rects(f, work, list, first, out);
        Vec mid_x[3], mid_y[3], mid_z[3], seen_x[6], seen_y[6], depths[6];
        for (int k = 0; k < 3; ++k) {
            Vec x[2], y[2], z[2];
            for (int end = 0; end < 2; ++end) {
                const hn::Vec<I> at = hn::Load(d, (end == 0 ? corners.open : corners.close)[k] + first);
                const PlacedPoints p = placed(f, view, work.casters.world->points, at);
                const Vec w = perspective ? p.z : hn::Set(f, 1.0f);
                x[end] = difference_of_products(p.x, scale, centre_x, w);
                y[end] = difference_of_products(p.y, scale, centre_y, w);
                z[end] = depths[k + 3 * end] = p.z;
                seen_x[k + 3 * end] = perspective ? hn::Div(x[end], w) : x[end];
                seen_y[k + 3 * end] = perspective ? hn::Div(y[end], w) : y[end];
            }
            const auto write = [&](const Vec v[2], float* to, float* change_to) HWY_ATTR {
                const Vec change = hn::Sub(v[1], v[0]);
                hn::Store(v[0], f, to + first);
                hn::Store(change, f, change_to + first);
                return hn::Add(v[0], hn::Mul(half, change));
            };
            mid_x[k] = write(x, out.x[k], out.dx[k]);
            mid_y[k] = write(y, out.y[k], out.dy[k]);
            mid_z[k] = write(z, out.z[k], out.dz[k]);
            if (!perspective) continue;
            const Vec inverse = hn::Div(hn::Set(f, 1.0f), mid_z[k]);
            mid_x[k] = hn::Mul(mid_x[k], inverse);
            mid_y[k] = hn::Mul(mid_y[k], inverse);
        }
        hn::Store(receding_of(f, mid_x, mid_y, mid_z), f, out.recedes + first);
        const Vec nearest = least_of(depths);
        const Vec size = hn::Max(hn::Abs(nearest), hn::Abs(most_of(depths)));
        hn::Store(hn::Sub(nearest, hn::Mul(hn::Set(f, kDepthRounding), size)), f, out.nearest + first);
        const Mask before_light = hn::Gt(nearest, hn::Set(f, perspective ? 0.0f : -INFINITY));
        find_strips(f, seen_x, seen_y, before_light, first, out);
    }
}

// Where the triangle in this lane may be in the rows of its box: what all three strips leave of the box.
HWY_NOINLINE void find_spans(const ShadowSetup& setup, int lane, ShadowSpans& spans) {
    const F f;
    const I d;
    const Vec half = hn::Set(f, 0.5f * kCellSize);
    const hn::Vec<I> x0 = hn::Set(d, setup.x0[lane]), x1 = hn::Set(d, setup.x1[lane]);
    for (int row = setup.y0[lane] / kWidth * kWidth; row <= setup.y1[lane]; row += kWidth) {
        const Vec top = hn::Sub(half, hn::ConvertTo(f, hn::Iota(d, row))), bottom = hn::Sub(top, hn::Set(f, 1.0f));
        Vec left = hn::Set(f, -INFINITY), right = hn::Set(f, INFINITY);
        for (int k = 0; k < 3; ++k) {
            const Vec slope = hn::Set(f, setup.slope[k][lane]);
            const Vec at_top = hn::Mul(slope, top), at_bottom = hn::Mul(slope, bottom);
            left = hn::Max(left, hn::Add(hn::Set(f, setup.low[k][lane]), hn::Min(at_top, at_bottom)));
            right = hn::Min(right, hn::Add(hn::Set(f, setup.high[k][lane]), hn::Max(at_top, at_bottom)));
        }
        const auto column = [&](Vec x) HWY_ATTR {
            const Vec in_cell = hn::Min(hn::Max(hn::Add(x, half), hn::Set(f, -1.0f)), hn::Set(f, kCellSize));
            return hn::ConvertTo(d, hn::Floor(in_cell));
        };
        hn::Store(hn::Max(x0, column(left)), d, spans.first + row);
        hn::Store(hn::Min(x1, column(right)), d, spans.last + row);
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace pentaprism
HWY_AFTER_NAMESPACE();

#endif
