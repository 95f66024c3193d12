// Up to sixteen moving, defocused triangles of a tile, set up with triangles in the lanes: sheared to the middle of the
// cell as localize() does it, bit for bit, with their half-planes. The twin for still pictures: still_batch-inl.h.
// Compiled once for each CPU target (see cover_vectors.cpp).

#if defined(PENTAPRISM_COVER_BLUR_BATCH_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef PENTAPRISM_COVER_BLUR_BATCH_INL_H
#undef PENTAPRISM_COVER_BLUR_BATCH_INL_H
#else
#define PENTAPRISM_COVER_BLUR_BATCH_INL_H
#endif

#include <cmath>

#include "cover/half_planes-inl.h"
#include "cover/lanes-inl.h"
#include "cover/shear-inl.h"
#include "frame/opacity.h"

HWY_BEFORE_NAMESPACE();
namespace pentaprism {
namespace HWY_NAMESPACE {

struct BlurBatch {
    static constexpr int kSize = kLanes;
    int count = 0;
    const BinnedTriangle* binned[kSize];
    const Part* part[kSize];
    float nearest[kSize];  // depth
    HWY_ALIGN float segments[kSize], segment[kSize];
    HWY_ALIGN glm::vec4 points[3][2][kSize];  // at both ends of the segment
    HWY_ALIGN float z[3][2][kSize];           // of orthographic cameras
    // As LocalTriangle has them.
    HWY_ALIGN float qx[3][kSize], qy[3][kSize], qw[3][kSize], qc[3][kSize], qz[3][kSize];
    HWY_ALIGN float dx[3][kSize], dy[3][kSize], dw[3][kSize], dc[3][kSize], dz[3][kSize];
    HWY_ALIGN float box[4][kSize];  // asked, and filled in, only where `behind`
    // Not 0: reaches the camera plane, where half-planes mean nothing; moves; is out of focus somewhere.
    HWY_ALIGN std::int32_t behind[kSize], moves[kSize], defocus[kSize];
    HalfPlanes planes;
};

inline void append(BlurBatch& batch, const Frame& frame, const BinnedTriangle& binned, float nearest) {
    const int k = batch.count++;
    const Part& part = frame.parts[frame.part_of[binned.triangle]];
    batch.binned[k] = &binned;
    batch.part[k] = &part;
    batch.nearest[k] = nearest;
    batch.segments[k] = static_cast<float>(part.moves ? part.segments : 1);
    batch.segment[k] = static_cast<float>(part.moves ? binned.segment : 0);
    const std::size_t start = part.moves ? std::size_t{binned.segment} * part.vertex_count : 0;
    const std::size_t step = part.moves ? part.vertex_count : 0;
    for (int i = 0; i < 3; ++i)
        for (int end = 0; end < 2; ++end) {
            const std::size_t p = frame.corners[3 * std::size_t{binned.triangle} + i] + start + end * step;
            batch.points[i][end][k] = frame.points[p];
            if (!frame.view.perspective) batch.z[i][end][k] = frame.depths[p];
        }
}

// Fills in all that append() left open.
HWY_NOINLINE inline void prepare(BlurBatch& batch, const TileWork& work, const CellCentre& centre) {
    const F f;
    const I i32;
    const View& view = work.frame.view;
    const float ratio = static_cast<float>(view.lens.ratio);
    const Vec scale = hn::Set(f, work.scale), w_near = hn::Set(f, rounded_up(view.w_near())), zero = hn::Zero(f);
    for (int lane = 0; lane < batch.count; lane += kWidth) {
        CornerLanes C;
        Vec least_w = hn::Set(f, INFINITY);
        Mask moves = hn::Gt(hn::Load(f, batch.segments + lane), hn::Set(f, 1.0f)), defocus = hn::Lt(least_w, zero);
        for (int i = 0; i < 3; ++i) {
            Vec x[2], y[2], w[2], c[2], z[2];
            for (int end = 0; end < 2; ++end) {
                hn::LoadInterleaved4(f, &batch.points[i][end][lane].x, x[end], y[end], w[end], c[end]);
                x[end] = hn::Mul(x[end], scale);
                y[end] = hn::Mul(y[end], scale);
                c[end] = hn::Mul(c[end], scale);
                z[end] = view.perspective ? w[end] : hn::Load(f, batch.z[i][end] + lane);
                least_w = hn::Min(least_w, w[end]);
            }
            const Vec qx = sheared(f, x[0], w[0], centre.x), qy = sheared(f, y[0], w[0], centre.y);
            const Vec dx = sheared_change(f, x, w, centre.x), dy = sheared_change(f, y, w, centre.y);
            const Vec dw = change(f, w), dc = change(f, c), dz = change(f, z);
            hn::Store(qx, f, batch.qx[i] + lane);
            hn::Store(qy, f, batch.qy[i] + lane);
            hn::Store(w[0], f, batch.qw[i] + lane);
            hn::Store(c[0], f, batch.qc[i] + lane);
            hn::Store(z[0], f, batch.qz[i] + lane);
            hn::Store(dx, f, batch.dx[i] + lane);
            hn::Store(dy, f, batch.dy[i] + lane);
            hn::Store(dw, f, batch.dw[i] + lane);
            hn::Store(dc, f, batch.dc[i] + lane);
            hn::Store(dz, f, batch.dz[i] + lane);
            for (const Vec& d : {dx, dy, dw, dc, dz}) moves = hn::Or(moves, hn::Ne(d, zero));
            for (const Vec& d : {c[0], dc}) defocus = hn::Or(defocus, hn::Ne(d, zero));
            C.x[i][0] = qx, C.y[i][0] = qy, C.w[i][0] = w[0], C.c[i][0] = c[0];
            C.x[i][1] = hn::Add(qx, dx), C.y[i][1] = hn::Add(qy, dy);
            C.w[i][1] = hn::Add(w[0], dw), C.c[i][1] = hn::Add(c[0], dc);
            least_w = hn::Min(least_w, C.w[i][1]);
        }
        const auto flag = [&](Mask mask) HWY_ATTR { return hn::BitCast(i32, hn::VecFromMask(f, mask)); };
        hn::Store(flag(hn::Lt(least_w, w_near)), i32, batch.behind + lane);
        hn::Store(flag(moves), i32, batch.moves + lane);
        hn::Store(flag(defocus), i32, batch.defocus + lane);
        make_half_planes(f, C, ratio, hn::Load(f, batch.segments + lane), hn::Load(f, batch.segment + lane),
                         batch.planes, lane);
    }
}

// Triangle k as the exact test takes it: equals localize() but for the box of one at the camera plane.
inline LocalTriangle local_triangle(const BlurBatch& batch, int k, const Frame& frame) {
    LocalTriangle T;
    for (int i = 0; i < 3; ++i) {
        T.qx[i] = batch.qx[i][k], T.qy[i] = batch.qy[i][k], T.qw[i] = batch.qw[i][k], T.qc[i] = batch.qc[i][k];
        T.dx[i] = batch.dx[i][k], T.dy[i] = batch.dy[i][k], T.dw[i] = batch.dw[i][k], T.dc[i] = batch.dc[i][k];
        T.qz[i] = batch.qz[i][k], T.dz[i] = batch.dz[i][k];
    }
    T.segments = batch.segments[k];
    T.segment = batch.segment[k];
    T.w_near = static_cast<float>(frame.view.w_near());
    T.z_near = static_cast<float>(frame.view.depth_near);
    T.z_far = static_cast<float>(frame.view.depth_far);
    T.triangle = batch.binned[k]->triangle;
    T.two_sided = batch.part[k]->two_sided;
    T.behind = batch.behind[k] != 0;
    T.alpha_tested = opacity_class(frame, T.triangle) != OpacityClass::kSolid;
    T.orthographic = !frame.view.perspective;
    return T;
}

}  // namespace HWY_NAMESPACE
}  // namespace pentaprism
HWY_AFTER_NAMESPACE();

#endif
