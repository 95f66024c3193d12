// Up to sixteen still triangles of a tile in the lanes, ready for the exact test: sheared to the middle of the cell as
// localize() does it, with a half-plane along each edge. From these, the pixels in which a sample may be covered, four
// rows of four at a time. Compiled once for each CPU target (see cover_still.cpp).

#if defined(PENTAPRISM_COVER_STILL_BATCH_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef PENTAPRISM_COVER_STILL_BATCH_INL_H
#undef PENTAPRISM_COVER_STILL_BATCH_INL_H
#else
#define PENTAPRISM_COVER_STILL_BATCH_INL_H
#endif

#include <algorithm>
#include <bit>
#include <cmath>

#include "cover/lanes-inl.h"
#include "cover/shear-inl.h"
#include "frame/opacity.h"

HWY_BEFORE_NAMESPACE();
namespace pentaprism {
namespace HWY_NAMESPACE {

struct StillBatch {
    static constexpr int kSize = kLanes;
    int count = 0;
    const BinnedTriangle* binned[kSize];
    HWY_ALIGN std::uint32_t triangle[kSize];
    HWY_ALIGN float nearest[kSize];  // depth
    HWY_ALIGN float sign[kSize];     // 1: the front is asked for, -1: the back
    HWY_ALIGN glm::vec4 points[3][kSize];
    // Corners as a sample at (hx, hy) sees them: (x - hx * w, y - hy * w). Of a triangle whose back is asked for y is
    // negated, and the w that goes with it: the edge functions change their sign and nothing else. z: depth.
    HWY_ALIGN float x[3][kSize], w[3][kSize], y[3][kSize], signed_w[3][kSize], z[3][kSize];
    HWY_ALIGN float least_z[kSize], most_z[kSize];
    // The half-planes, for pixels: in column c and row r of the cell a sample may be covered where
    // room - nx * c + ny * r >= 0. At the camera plane they hold everything.
    HWY_ALIGN float room[3][kSize], nx[3][kSize], ny[3][kSize];
    // Alpha, near or far distance or the camera plane must be asked about: not 0.
    HWY_ALIGN std::int32_t special[kSize];
};

inline void append(StillBatch& batch, const TileWork& work, const BinnedTriangle& binned, float nearest, float sign) {
    const Frame& frame = work.frame;
    const int k = batch.count++;
    batch.binned[k] = &binned;
    batch.triangle[k] = binned.triangle;
    batch.nearest[k] = nearest;
    batch.sign[k] = sign;
    batch.special[k] = opacity_class(frame, binned.triangle) != OpacityClass::kSolid;
    for (int i = 0; i < 3; ++i) {
        const std::uint32_t p = frame.corners[3 * std::size_t{binned.triangle} + i];
        batch.points[i][k] = frame.points[p];
        batch.z[i][k] = frame.view.perspective ? frame.points[p].z : frame.depths[p];
    }
}

// The half-planes as in half_planes-inl.h, whose reasons and slacks hold, where nothing moves: a covered sample has
// n.h <= n.P of the farthest corner. n.h over a pixel is least at the corner that lies deepest inside.
HWY_INLINE void make_edges(F f, StillBatch& batch, int lane, const Vec x[3], const Vec y[3], const Vec w[3],
                           Mask behind) {
    const Vec zero = hn::Zero(f), seventeen = hn::Set(f, 17.0f);
    Vec sx[3], sy[3], scale_x = zero, scale_y = zero, least_w = w[0];
    for (int i = 0; i < 3; ++i) {
        const Vec inverse = hn::Div(hn::Set(f, 1.0f), w[i]);
        sx[i] = hn::Mul(x[i], inverse);
        sy[i] = hn::Mul(y[i], inverse);
        scale_x = hn::Max(scale_x, hn::MulAdd(seventeen, w[i], hn::Abs(x[i])));
        scale_y = hn::Max(scale_y, hn::MulAdd(seventeen, w[i], hn::Abs(y[i])));
        least_w = hn::Min(least_w, w[i]);
    }
    const Vec rounding = hn::Div(hn::Set(f, 40.0f * kUnitRoundoff), least_w);
    const Vec slack_x = hn::Mul(rounding, scale_x), slack_y = hn::Mul(rounding, scale_y);
    const Vec area = hn::Sub(hn::Mul(hn::Sub(sx[1], sx[0]), hn::Sub(sy[2], sy[0])),
                             hn::Mul(hn::Sub(sx[2], sx[0]), hn::Sub(sy[1], sy[0])));
    const Vec outward = hn::CopySign(hn::Set(f, 1.0f), area);
    for (int k = 0; k < 3; ++k) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        const Vec away_x = hn::Mul(outward, hn::Sub(sy[j], sy[i])), away_y = hn::Mul(outward, hn::Sub(sx[i], sx[j]));
        const Vec ax = hn::Abs(away_x), ay = hn::Abs(away_y);
        Vec support = hn::Set(f, -INFINITY);
        for (int corner = 0; corner < 3; ++corner)
            support = hn::Max(support, hn::MulAdd(away_x, sx[corner], hn::Mul(away_y, sy[corner])));
        const Vec size = hn::MulAdd(hn::Set(f, 32.0f), hn::Add(ax, ay), hn::Add(hn::Abs(support), hn::Abs(support)));
        Vec room = hn::MulAdd(ax, slack_x, hn::MulAdd(ay, slack_y, support));
        room = hn::MulAdd(size, hn::Set(f, 32.0f * kUnitRoundoff), room);
        room = hn::Add(room, hn::Set(f, 1e-35f));  // an edge so short that products underflow refuses nothing
        const Vec left = hn::IfThenElse(hn::Gt(away_x, zero), hn::Set(f, -16.0f), hn::Set(f, -15.0f));
        const Vec top = hn::IfThenElse(hn::Gt(away_y, zero), hn::Set(f, 15.0f), hn::Set(f, 16.0f));
        room = hn::NegMulAdd(away_x, left, hn::NegMulAdd(away_y, top, room));
        hn::Store(hn::IfThenElse(behind, hn::Set(f, INFINITY), room), f, batch.room[k] + lane);
        hn::Store(hn::IfThenElse(behind, zero, away_x), f, batch.nx[k] + lane);
        hn::Store(hn::IfThenElse(behind, zero, away_y), f, batch.ny[k] + lane);
    }
}

// Fills in all that append() left open.
HWY_INLINE void prepare(StillBatch& batch, const TileWork& work, const CellCentre& centre) {
    const F f;
    const I i32;
    const View& view = work.frame.view;
    const Vec scale = hn::Set(f, work.scale), w_near = hn::Set(f, rounded_up(view.w_near()));
    const Vec z_near = hn::Set(f, static_cast<float>(view.depth_near)),
              z_far = hn::Set(f, static_cast<float>(view.depth_far));
    for (int lane = 0; lane < batch.count; lane += kWidth) {
        const Vec sign = hn::Load(f, batch.sign + lane);
        Vec x[3], y[3], w[3], least_w, least_z, most_z;
        for (int i = 0; i < 3; ++i) {
            Vec raster_x, raster_y, c;
            hn::LoadInterleaved4(f, &batch.points[i][lane].x, raster_x, raster_y, w[i], c);
            x[i] = sheared(f, hn::Mul(raster_x, scale), w[i], centre.x);
            y[i] = sheared(f, hn::Mul(raster_y, scale), w[i], centre.y);
            const Vec z = hn::Load(f, batch.z[i] + lane);
            least_w = i == 0 ? w[i] : hn::Min(least_w, w[i]);
            least_z = i == 0 ? z : hn::Min(least_z, z);
            most_z = i == 0 ? z : hn::Max(most_z, z);
            hn::Store(x[i], f, batch.x[i] + lane);
            hn::Store(w[i], f, batch.w[i] + lane);
            hn::Store(hn::Mul(sign, y[i]), f, batch.y[i] + lane);
            hn::Store(hn::Mul(sign, w[i]), f, batch.signed_w[i] + lane);
        }
        hn::Store(least_z, f, batch.least_z + lane);
        hn::Store(most_z, f, batch.most_z + lane);
        const Mask behind = hn::Lt(least_w, w_near);
        const Mask within = hn::And(hn::Ge(least_z, z_near), hn::Le(most_z, z_far));
        const Mask ask = hn::Or(behind, hn::Not(within));
        const auto alpha = hn::Load(i32, batch.special + lane);
        hn::Store(hn::Or(alpha, hn::BitCast(i32, hn::VecFromMask(f, ask))), i32, batch.special + lane);
        make_edges(f, batch, lane, x, y, w, behind);
    }
}

// Pixels of the cell, half open.
struct CellRect {
    int x0, x1, y0, y1;
};
inline CellRect rect_of(const BinnedTriangle& binned, const Tile& tile) {
    const int left = tile.cell_x() * kCellSize, top = tile.cell_y() * kCellSize;
    return {std::max<int>(binned.x0, tile.x0) - left, std::min<int>(binned.x1, tile.x1) - left,
            std::max<int>(binned.y0, tile.y0) - top, std::min<int>(binned.y1, tile.y1) - top};
}

// Lanes of the block at (column, row) that lie in the rectangle, which reaches into it.
inline std::uint32_t lanes_in(const CellRect& rect, int column, int row) {
    const int x0 = std::max(rect.x0 - column, 0), x1 = std::min(rect.x1 - column, kBlockSize);
    const int y0 = std::max(rect.y0 - row, 0), y1 = std::min(rect.y1 - row, kBlockSize);
    const std::uint32_t columns = ((0xfu << x0) & (0xfu >> (kBlockSize - x1))) * 0x1111u;
    return columns & (0xffffu << (kBlockSize * y0)) & (0xffffu >> (kBlockSize * (kBlockSize - y1)));
}

// A triangle of the batch and a pixel of the cell (kLanes * block + lane).
constexpr std::uint32_t pixel_job(int k, int pixel) {
    return static_cast<std::uint32_t>(k << 16 | pixel);
}

// Writes the pixels of triangle k that lie within its half-planes and rectangle, in one of `blocks`, and show something
// no nearer than it; `farthest`: by pixel. Returns how many; writes up to sixteen more.
HWY_INLINE std::size_t list_pixels(const StillBatch& batch, int k, const CellRect& rect, std::uint64_t blocks,
                                   const float* farthest, std::uint32_t* HWY_RESTRICT jobs) {
    const F f;
    const I i32;
    const Vec nearest = hn::Set(f, batch.nearest[k]);
    Vec nx[3], ny[3], room[3];
    for (int e = 0; e < 3; ++e) {
        nx[e] = hn::Set(f, batch.nx[e][k]);
        ny[e] = hn::Set(f, batch.ny[e][k]);
        room[e] = hn::Set(f, batch.room[e][k]);
    }
    std::size_t count = 0;
    for (int row = rect.y0 & -kBlockSize; row < rect.y1; row += kBlockSize)
        for (int column = rect.x0 & -kBlockSize; column < rect.x1; column += kBlockSize) {
            const int block = row / kBlockSize * kCellBlocks + column / kBlockSize, first = block * kLanes;
            if ((blocks >> block & 1u) == 0) continue;
            std::uint32_t kept = lanes_in(rect, column, row);
            for (int lane = 0; lane < kLanes; lane += kWidth) {
                const auto lanes = hn::Iota(i32, lane);
                const Vec c = hn::ConvertTo(f, hn::Add(hn::And(lanes, hn::Set(i32, 3)), hn::Set(i32, column)));
                const Vec r = hn::ConvertTo(f, hn::Add(hn::ShiftRight<2>(lanes), hn::Set(i32, row)));
                Vec least = hn::Sub(hn::Load(f, farthest + first + lane), nearest);
                for (int e = 0; e < 3; ++e)
                    least = hn::Min(least, hn::MulAdd(ny[e], r, hn::NegMulAdd(nx[e], c, room[e])));
                kept &= ~(static_cast<std::uint32_t>(bits_of(f, hn::Lt(least, hn::Zero(f)))) << lane);
            }
            count += write_lanes(pixel_job(k, first), kept, jobs + count);
        }
    return count;
}

}  // namespace HWY_NAMESPACE
}  // namespace pentaprism
HWY_AFTER_NAMESPACE();

#endif
