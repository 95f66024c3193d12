// Clusters: sixteen small triangles that blur over nearly the same blocks. Their strata are bounded and their vectors
// listed once for all of them; then each vector asks all sixteen, with triangles in the lanes, what would cost a list
// each. Which triangles are worth it: cover/front_to_back.h. Compiled once for each CPU target (see cover_vectors.cpp).

#if defined(PENTAPRISM_COVER_CLUSTER_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef PENTAPRISM_COVER_CLUSTER_INL_H
#undef PENTAPRISM_COVER_CLUSTER_INL_H
#else
#define PENTAPRISM_COVER_CLUSTER_INL_H
#endif

#include "cover/blur_batch-inl.h"
#include "cover/work_list-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pentaprism {
namespace HWY_NAMESPACE {

// The vectors that a cluster may hit. Bit k of `triangles`: triangle k may.
struct ClusterList {
    AlignedVector<Job> jobs;
    AlignedVector<std::uint32_t> triangles;
    AlignedVector<float> farthest;
    std::size_t count = 0;
};

// Calls visit(lane) for each vector of the sixteen triangles.
template <class Visit>
HWY_INLINE void for_lanes(const Visit& visit) {
    for (int lane = 0; lane < kLanes; lane += kWidth) visit(lane);
}

// A plane that holds what plane p of each of the triangles holds, at the times from t0 to t1: slopes between theirs,
// and as far out as their differences over the lens and the shutter ask.
HWY_INLINE void enclose_plane(const HalfPlanes& H, int p, float t0, float t1, float ratio, HalfPlanes& out) {
    const F f;
    const auto middle = [&](const float* values) HWY_ATTR {
        Vec least = hn::Load(f, values), most = least;
        for_lanes([&](int lane) HWY_ATTR {
            least = hn::Min(least, hn::Load(f, values + lane));
            most = hn::Max(most, hn::Load(f, values + lane));
        });
        return 0.5f * (hn::GetLane(hn::MinOfLanes(f, least)) + hn::GetLane(hn::MaxOfLanes(f, most)));
    };
    const float e = middle(H.e[p]), ku = middle(H.ku[p]), kv = middle(H.kv[p]);
    Vec most = hn::Set(f, -INFINITY);
    for_lanes([&](int lane) HWY_ATTR {
        const Vec de = hn::Sub(hn::Load(f, H.e[p] + lane), hn::Set(f, e));
        const Vec in_time = hn::Max(hn::Mul(de, hn::Set(f, t0)), hn::Mul(de, hn::Set(f, t1)));
        const Vec over_u = hn::Abs(hn::Sub(hn::Load(f, H.ku[p] + lane), hn::Set(f, ku)));
        const Vec over_v = hn::Abs(hn::Sub(hn::Load(f, H.kv[p] + lane), hn::Set(f, kv)));
        const Vec over_lens = hn::MulAdd(hn::Set(f, ratio), over_v, over_u);
        most = hn::Max(most, hn::Add(hn::Load(f, H.f[p] + lane), hn::Add(in_time, over_lens)));
    });
    const float limit = hn::GetLane(hn::MaxOfLanes(f, most));
    const float size = std::abs(limit) + std::abs(e) + std::abs(ku) + ratio * std::abs(kv) + kCellSize;
    out.nx[p][0] = H.nx[p][0], out.ny[p][0] = H.ny[p][0];
    out.e[p][0] = e, out.ku[p][0] = ku, out.kv[p][0] = kv;
    out.f[p][0] = limit + 32.0f * kUnitRoundoff * size;
}

// The half-planes of the cluster's triangles over one stratum: the largest n.h that they allow the middle of a block.
class StratumPlanes {
  public:
    // `loose`: f of each plane with room for rounding and half a block.
    StratumPlanes(const HalfPlanes& H, const float (&loose)[HalfPlanes::kCount][kLanes]) : H_(H), loose_(loose) {}

    HWY_INLINE void set(const TileState& state, int stratum, float begin, float end) {
        const F f;
        const float t0 = std::max(state.t[0][stratum], begin), t1 = std::min(state.t[1][stratum], end);
        const Axis t(f, t0, t1), u(f, state.u[0][stratum], state.u[1][stratum]),
            v(f, state.v[0][stratum], state.v[1][stratum]);
        for (int p = 0; p < HalfPlanes::kCount; ++p)
            for_lanes([&](int lane) HWY_ATTR {
                Vec limit = t.most(f, H_.e[p] + lane, hn::Load(f, loose_[p] + lane));
                if (p != HalfPlanes::kAbove && p != HalfPlanes::kBelow) limit = u.most(f, H_.ku[p] + lane, limit);
                if (p != HalfPlanes::kRight && p != HalfPlanes::kLeft) limit = v.most(f, H_.kv[p] + lane, limit);
                hn::Store(limit, f, limit_[p] + lane);
            });
    }

    // Which triangles may hit samples of the block whose middle is (x, y): one bit each.
    HWY_INLINE std::uint32_t may_hit(float x, float y) const {
        const F f;
        const Vec px = hn::Set(f, x), py = hn::Set(f, y);
        std::uint32_t bits = 0;
        for_lanes([&](int lane) HWY_ATTR {
            const auto limit = [&](int p) HWY_ATTR { return hn::Load(f, limit_[p] + lane); };
            Vec room = hn::Min(hn::Sub(limit(HalfPlanes::kRight), px), hn::Add(limit(HalfPlanes::kLeft), px));
            room =
                hn::Min(room, hn::Min(hn::Sub(limit(HalfPlanes::kAbove), py), hn::Add(limit(HalfPlanes::kBelow), py)));
            for (int p = HalfPlanes::kEdges; p < HalfPlanes::kCount; ++p)
                room = hn::Min(room, hn::NegMulAdd(hn::Load(f, H_.nx[p] + lane), px,
                                                   hn::NegMulAdd(hn::Load(f, H_.ny[p] + lane), py, limit(p))));
            bits |= static_cast<std::uint32_t>(bits_of(f, hn::Ge(room, hn::Zero(f)))) << lane;
        });
        return bits;
    }

  private:
    // An interval, for the largest value of a linear function on it.
    struct Axis {
        HWY_INLINE Axis(F f, float least, float most)
            : middle(hn::Set(f, 0.5f * (least + most))), half(hn::Set(f, 0.5f * (most - least))) {}
        HWY_INLINE Vec most(F f, const float* slopes, Vec at_zero) const {
            const Vec slope = hn::Load(f, slopes);
            return hn::MulAdd(slope, middle, hn::MulAdd(hn::Abs(slope), half, at_zero));
        }
        Vec middle, half;
    };

    const HalfPlanes& H_;
    const float (&loose_)[HalfPlanes::kCount][kLanes];
    HWY_ALIGN float limit_[HalfPlanes::kCount][kLanes];
};

// Room for half a block's width and for rounding: a few operations on numbers of this size.
HWY_INLINE void loosen(const HalfPlanes& H, float ratio, float block_size, float (&loose)[HalfPlanes::kCount][kLanes]) {
    const F f;
    const Vec lens = hn::Set(f, std::max(1.0f, ratio));
    for (int p = 0; p < HalfPlanes::kCount; ++p)
        for_lanes([&](int lane) HWY_ATTR {
            const auto reach = [&](const float* values) HWY_ATTR { return hn::Abs(hn::Load(f, values + lane)); };
            const Vec direction = hn::Add(reach(H.nx[p]), reach(H.ny[p])), limit = hn::Load(f, H.f[p] + lane);
            Vec size = hn::Add(hn::Abs(limit), reach(H.e[p]));
            size = hn::MulAdd(lens, hn::Add(reach(H.ku[p]), reach(H.kv[p])), size);
            size = hn::MulAdd(hn::Set(f, kCellSize), direction, size);
            const Vec room = hn::MulAdd(hn::Set(f, 0.5f * block_size), direction, limit);
            hn::Store(hn::MulAdd(hn::Set(f, 32.0f * kUnitRoundoff), size, room), f, loose[p] + lane);
        });
}

// Lists what the batch, full and in front of the camera plane, all of one segment, may hit and what is not hidden.
HWY_NOINLINE inline void list_cluster(TileState& state, const BlurBatch& batch, std::uint64_t blocks,
                                      ClusterList& list) {
    const F f;
    constexpr float kWiden = 1e-6f;  // the segment's ends are rounded
    const float begin = batch.segment[0] / batch.segments[0] - kWiden,
                end = (batch.segment[0] + 1.0f) / batch.segments[0] + kWiden;
    const float ratio = static_cast<float>(state.work.frame.view.lens.ratio);
    const HalfPlanes& H = batch.planes;
    HalfPlanes box;
    for (int p = 0; p < HalfPlanes::kEdges; ++p) enclose_plane(H, p, begin, end, ratio, box);
    boxes_of_strata(state, box, 0, StratumLimits(state, batch.segment[0], batch.segments[0]), state.masks);

    HWY_ALIGN float loose[HalfPlanes::kCount][kLanes];
    loosen(H, ratio, state.block_size, loose);
    StratumPlanes planes(H, loose);
    const Vec near = hn::Set(f, *std::min_element(batch.nearest, batch.nearest + batch.count));
    const BlockGroups groups(blocks);
    list.count = 0;
    for (const Stratum& s : state.arrangement.strata) {
        std::uint64_t wanted = state.masks[s.stratum] & s.blocks & blocks;
        if (wanted == 0) continue;
        wanted &= shown_blocks(state, s.slot, groups, near);
        if (wanted == 0) continue;
        planes.set(state, s.stratum, begin, end);
        for (; wanted != 0; wanted &= wanted - 1) {
            const int block = std::countr_zero(wanted);
            const Job job = state.job(s.slot, block);
            const std::uint32_t bits = planes.may_hit(state.left_of(block) + 0.5f * state.block_size,
                                                      state.top_of(block) - 0.5f * state.block_size);
            list.jobs[list.count] = job;
            list.triangles[list.count] = bits;
            list.farthest[list.count] = state.farthest[job];
            list.count += bits != 0;
        }
    }
    for (int i = 0; i < kLanes; ++i) list.jobs[list.count + i] = list.triangles[list.count + i] = 0;  // a whole vector
}

// Copies the vectors of triangle k, whose nearest depth is `nearest`, that are not hidden to the tile's work list;
// returns how many.
HWY_NOINLINE inline std::size_t jobs_of_triangle(TileState& state, const ClusterList& list, int k, float nearest) {
    Job* HWY_RESTRICT jobs = state.jobs.data();
    std::size_t count = 0;
    if constexpr (kWidth == kLanes) {
        const F f;
        const U u;
        const auto bit = hn::Set(u, 1u << k);
        const Vec near = hn::Set(f, nearest);
        for (std::size_t i = 0; i < list.count; i += kLanes) {
            const auto listed = hn::Load(u, &list.jobs[i]);
            const Vec farthest = hn::Load(f, &list.farthest[i]);
            const auto shown = hn::RebindMask(u, hn::Le(near, farthest));
            const auto wanted = hn::And(shown, hn::TestBit(hn::Load(u, &list.triangles[i]), bit));
            hn::StoreU(hn::Compress(listed, wanted), u, jobs + count);
            count += hn::CountTrue(u, wanted);
        }
    } else {  // a vector's Compress is slow elsewhere
        for (std::size_t i = 0; i < list.count; ++i) {
            jobs[count] = list.jobs[i];
            count += (list.triangles[i] >> k & 1u) & static_cast<std::uint32_t>(nearest <= list.farthest[i]);
        }
    }
    return count;
}

}  // namespace HWY_NAMESPACE
}  // namespace pentaprism
HWY_AFTER_NAMESPACE();

#endif
