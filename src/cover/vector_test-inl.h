// The two passes over a triangle's work list: the edges' half-planes refuse vectors that hit nothing, then the exact
// test, the same decisions as cover/exact.cpp bit for bit, with depth and writes. Compiled once for each CPU target
// (see cover_vectors.cpp).

#if defined(PENTAPRISM_COVER_VECTOR_TEST_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef PENTAPRISM_COVER_VECTOR_TEST_INL_H
#undef PENTAPRISM_COVER_VECTOR_TEST_INL_H
#else
#define PENTAPRISM_COVER_VECTOR_TEST_INL_H
#endif

#include "cover/exact.h"
#include "cover/lanes-inl.h"
#include "cover/path_time-inl.h"
#include "cover/vector_opacity-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pentaprism {
namespace HWY_NAMESPACE {

// What of the general test a triangle needs. Adding u*0 or t*0 is exact: the shorter kernels give the same bits.
enum class Seen { kFront, kBack, kBoth };  // the sides that some sample may see
template <Moves kMovesT, bool kDefocusT, Seen kSeenT, bool kFineT>
struct Kind {
    static constexpr bool kFine = kFineT;  // the samples are those of FineLens
    static constexpr Moves kMoves = kMovesT;
    static constexpr bool kMotion = kMovesT != Moves::kNot, kDefocus = kDefocusT;
    static constexpr Seen kSeen = kSeenT;
};

// Pass 1: keeps the vectors of the work list that have a sample of the tested segments inside the half-planes of all
// three edges.
template <Moves kMoves, bool kDefocus, bool kFine>
std::size_t keep_within_edges(TileState& state, const Tested& tested, std::size_t job_count) {
    const F f;
    constexpr int kEdge = HalfPlanes::kEdges;
    const HalfPlanes& H = tested.batch.planes;
    Vec nx[3], ny[3], ku[3], kv[3], e[3], limit[3];  // of one segment
    for (int k = 0; k < 3; ++k) {
        nx[k] = hn::Set(f, H.nx[kEdge + k][tested.k]);
        ny[k] = hn::Set(f, H.ny[kEdge + k][tested.k]);
        ku[k] = hn::Set(f, H.ku[kEdge + k][tested.k]);
        kv[k] = hn::Set(f, H.kv[kEdge + k][tested.k]);
        e[k] = hn::Set(f, H.e[kEdge + k][tested.k]);
        limit[k] = hn::Set(f, H.f[kEdge + k][tested.k]);
    }
    Job* HWY_RESTRICT jobs = state.jobs.data();
    const SampleVector* HWY_RESTRICT samples = state.arrangement.samples;
    const JobPlaces<kFine> places(state);
    std::size_t count = 0;
    for (std::size_t j = 0; j < job_count; ++j) {
        const Job job = jobs[j];
        const SampleVector& s = samples[places.vector(job)];
        bool any = false;
        for (int lane = 0; lane < kLanes; lane += kWidth) {
            const PathTime<kMoves> time(f, tested, s.t + lane);
            const auto at = [&](const Vec(&one)[3], const float(&rows)[HalfPlanes::kCount][kLanes], int k) HWY_ATTR {
                if constexpr (kMoves == Moves::kAlongPieces) return time.look_up(f, rows[kEdge + k]);
                return one[k];
            };
            const Vec x = hn::Load(f, s.x + lane), y = hn::Load(f, s.y + lane);
            Vec room[3];  // to the edge
            for (int k = 0; k < 3; ++k) {
                Vec r = at(limit, H.f, k);
                if constexpr (kMoves != Moves::kNot) r = hn::MulAdd(at(e, H.e, k), hn::Load(f, s.t + lane), r);
                if constexpr (kDefocus)
                    r = hn::MulAdd(at(ku, H.ku, k), hn::Load(f, s.u + lane),
                                   hn::MulAdd(at(kv, H.kv, k), hn::Load(f, s.v + lane), r));
                room[k] = hn::NegMulAdd(at(nx, H.nx, k), x, hn::NegMulAdd(at(ny, H.ny, k), y, r));
            }
            const Vec least = hn::Min(hn::Min(room[0], room[1]), room[2]);
            Mask inside = hn::Ge(least, hn::Zero(f));
            if constexpr (kSegments<kMoves>) inside = hn::And(inside, time.ours);
            any |= !hn::AllFalse(f, inside);
        }
        jobs[count] = job;
        count += any;
    }
    return count;
}

// A triangle of one segment, read once: for all that the compiler knows, writing a depth could change it.
template <class K>
struct Corners {
    Corners(F f, const LocalTriangle& T) {
        for (int i = 0; i < 3; ++i) {
            x[i] = hn::Set(f, T.qx[i]), y[i] = hn::Set(f, T.qy[i]), w[i] = hn::Set(f, T.qw[i]);
            if constexpr (K::kDefocus) c[i] = hn::Set(f, T.qc[i]);
            if constexpr (K::kMotion) {
                dx[i] = hn::Set(f, T.dx[i]), dy[i] = hn::Set(f, T.dy[i]), dw[i] = hn::Set(f, T.dw[i]);
                if constexpr (K::kDefocus) dc[i] = hn::Set(f, T.dc[i]);
            }
        }
    }
    Vec x[3], y[3], w[3], c[3], dx[3], dy[3], dw[3], dc[3];
};

// Where the three vertices are seen from sixteen samples (docs/develop/algorithms.md 1.5).
struct Deltas {
    Vec x[3], y[3], w[3], z[3];
};

// `kSpecial`: of a triangle that may be orthographic.
template <class K, bool kSpecial>
HWY_INLINE Deltas deltas(F f, const Tested& tested, const Corners<K>& C, const PathTime<K::kMoves>& time,
                         const SampleVector& s, int lane) {
    Deltas D;
    const BlurBatch& B = tested.batch;
    const auto at = [&](const Vec(&one)[3], const float(&rows)[3][kLanes], int i) HWY_ATTR {
        if constexpr (K::kMoves == Moves::kAlongPieces) return time.look_up(f, rows[i]);
        return one[i];
    };
    const Vec hx = hn::Load(f, s.x + lane), hy = hn::Load(f, s.y + lane);
    for (int i = 0; i < 3; ++i) {
        Vec x = at(C.x, B.qx, i), y = at(C.y, B.qy, i), w = at(C.w, B.qw, i);
        if constexpr (K::kMotion) {
            x = hn::MulAdd(time.tau, at(C.dx, B.dx, i), x);
            y = hn::MulAdd(time.tau, at(C.dy, B.dy, i), y);
            w = hn::MulAdd(time.tau, at(C.dw, B.dw, i), w);
        }
        if constexpr (K::kDefocus) {
            Vec c = at(C.c, B.qc, i);
            if constexpr (K::kMotion) c = hn::MulAdd(time.tau, at(C.dc, B.dc, i), c);
            x = hn::MulAdd(hn::Load(f, s.u + lane), c, x);
            y = hn::MulAdd(hn::Load(f, s.v + lane), c, y);
        }
        D.x[i] = hn::NegMulAdd(hx, w, x);
        D.y[i] = hn::NegMulAdd(hy, w, y);
        D.w[i] = D.z[i] = w;
        if constexpr (kSpecial)
            if (tested.T.orthographic) {
                const auto read = [&](const float(&one)[3], const float(&rows)[3][kLanes]) HWY_ATTR {
                    return K::kMoves == Moves::kAlongPieces ? time.look_up(f, rows[i]) : hn::Set(f, one[i]);
                };
                D.z[i] = hn::MulAdd(time.tau, read(tested.T.dz, B.dz), read(tested.T.qz, B.qz));
            }
    }
    return D;
}

HWY_INLINE Vec edge(const Deltas& D, int i, int j) {
    return hn::Sub(hn::Mul(D.x[i], D.y[j]), hn::Mul(D.x[j], D.y[i]));
}

struct Edges {
    Vec e[3];
};
HWY_INLINE Edges edges(const Deltas& D) {
    return {{edge(D, 1, 2), edge(D, 2, 0), edge(D, 0, 1)}};
}

// Lanes that are inside all edges for certain, and those with a sample exactly on an edge and outside of none: the
// scalar test decides these.
//
// `inside` needs none of the exact test's other questions. Products and differences round monotonically, so e_k > 0
// says that the cross product of the float positions is positive: the origin is a convex combination of them with
// positive weights e_k, hence (N) holds, and the sum of e_k is not 0.
struct Decision {
    Mask inside, tied;
};
template <class K>
HWY_INLINE Decision decide(F f, const Edges& E, const PathTime<K::kMoves>& time) {
    const Vec zero = hn::Zero(f);
    Decision decision;
    if constexpr (K::kSeen == Seen::kBack) {
        const Vec most = hn::Max(hn::Max(E.e[0], E.e[1]), E.e[2]);
        decision = {hn::Lt(most, zero), hn::Eq(most, zero)};
    } else {
        const Vec least = hn::Min(hn::Min(E.e[0], E.e[1]), E.e[2]);
        decision = {hn::Gt(least, zero), hn::Eq(least, zero)};
    }
    if constexpr (K::kSeen == Seen::kBoth) {
        const Vec most = hn::Max(hn::Max(E.e[0], E.e[1]), E.e[2]);
        decision = {hn::Or(decision.inside, hn::Lt(most, zero)), hn::Or(decision.tied, hn::Eq(most, zero))};
    }
    if constexpr (kSegments<K::kMoves>)
        decision = {hn::And(decision.inside, time.ours), hn::And(decision.tied, time.ours)};
    return decision;
}

// What the scalar test says of the lanes in `tied`; returns those it accepts, with their depth.
HWY_NOINLINE inline Mask decide_ties(F f, const CellCentre& centre, const LocalTriangle& T, const SampleVector& s,
                                     int lane, Mask tied, Vec& depth) {
    HWY_ALIGN std::int32_t ask[kLanes];
    HWY_ALIGN float depths[kLanes];
    const I i;
    hn::Store(hn::VecFromMask(i, hn::RebindMask(i, tied)), i, ask);
    hn::Store(depth, f, depths);
    for (int k = 0; k < kWidth; ++k) {
        if (ask[k] == 0) continue;
        const LocalSample sample{s.x[lane + k], s.y[lane + k], s.u[lane + k], s.v[lane + k], s.t[lane + k]};
        const SampleHit hit = cover_sample(T, sample, centre);
        ask[k] = hit.hit ? -1 : 0;
        if (hit.hit) depths[k] = hit.depth;
    }
    depth = hn::Load(f, depths);
    return hn::RebindMask(f, hn::Lt(hn::Load(i, ask), hn::Zero(i)));
}

// The same for all segments: the scalar test, too, leaves other segments' samples alone.
inline Mask decide_ties(F f, const TileState& state, const Tested& tested, const SampleVector& s, int lane, Mask tied,
                        Vec& depth) {
    Mask hit = decide_ties(f, state.centre, tested.T, s, lane, tied, depth);
    for (int k = tested.k + 1; k < tested.k + tested.count; ++k) {
        const LocalTriangle T = tested.T.behind ? at_camera_plane(state, tested.batch, k)
                                                : local_triangle(tested.batch, k, state.work.frame);
        hit = hn::Or(hit, decide_ties(f, state.centre, T, s, lane, tied, depth));
    }
    return hit;
}

// Lanes within the screen bounds of a triangle that reaches the camera plane.
HWY_INLINE Mask in_box(F f, const CellCentre& centre, const Vec (&box)[4], Vec hx, Vec hy) {
    const Vec gx = hn::Add(hn::Set(f, centre.x), hx), gy = hn::Add(hn::Set(f, centre.y), hy);
    return hn::And(hn::And(hn::Ge(gx, box[0]), hn::Le(gx, box[1])), hn::And(hn::Ge(gy, box[2]), hn::Le(gy, box[3])));
}
HWY_INLINE Mask in_box(F f, const CellCentre& centre, const LocalTriangle& T, Vec hx, Vec hy) {
    const Vec box[4] = {hn::Set(f, T.box[0]), hn::Set(f, T.box[1]), hn::Set(f, T.box[2]), hn::Set(f, T.box[3])};
    return in_box(f, centre, box, hx, hy);
}
// The box of each sample's segment.
template <Moves kMoves>
HWY_INLINE Mask in_box(F f, const CellCentre& centre, const Tested& tested, const PathTime<kMoves>& time, Vec hx,
                       Vec hy) {
    if constexpr (kMoves == Moves::kAlongPieces) {
        Vec box[4];
        for (int side = 0; side < 4; ++side) box[side] = time.look_up(f, tested.batch.box[side]);
        return in_box(f, centre, box, hx, hy);
    }
    return in_box(f, centre, tested.T, hx, hy);
}

// Whether a corner at depth z that moves by dz may lie beyond near or far.
inline bool may_leave_depth_range(const LocalTriangle& T, float z, float dz) {
    return !(z >= T.z_near && z + dz >= T.z_near && z <= T.z_far && z + dz <= T.z_far);
}
// Whether near and far distance must be asked: depths lie between those of the corners, which move monotonically.
inline bool may_leave_depth_range(const LocalTriangle& T) {
    bool may = false;
    for (int i = 0; i < 3; ++i)
        may = may || (T.orthographic ? may_leave_depth_range(T, T.qz[i], T.dz[i])
                                     : may_leave_depth_range(T, T.qw[i], T.dw[i]));
    return may;
}
// In any of its segments.
inline bool may_leave_depth_range(const Tested& tested) {
    const LocalTriangle& T = tested.T;
    const auto& q = T.orthographic ? tested.batch.qz : tested.batch.qw;
    const auto& d = T.orthographic ? tested.batch.dz : tested.batch.dw;
    bool may = may_leave_depth_range(T);
    for (int k = tested.k + 1; k < tested.k + tested.count; ++k)
        for (int i = 0; i < 3; ++i) may = may || may_leave_depth_range(T, q[i][k], d[i][k]);
    return may;
}

// The samples in the lanes of a job, from `lane` on.
template <bool kFine>
class LanesOfJob {
  public:
    LanesOfJob(const TileState& state, Job job, int lane)
        : tile_(state.work.tile),
          indices_(state.indices),
          places_(state.arrangement.places),
          first_(static_cast<std::uint32_t>(JobPlaces<kFine>(state).vector(job) * kLanes) +
                 static_cast<std::uint32_t>(lane)),
          block_(job % kBlocksPerCell),
          samples_per_block_(state.samples_per_block) {}

    SampleOfPixel operator()(int k) const {
        std::uint32_t place = first_ + static_cast<std::uint32_t>(k), block = block_;
        if constexpr (kFine) place = places_[place], block = place / samples_per_block_;
        const std::uint32_t lane = place % kLanes;
        const std::uint32_t px = block % kCellBlocks * kBlockSize + lane % kBlockSize;
        const std::uint32_t py = block / kCellBlocks * kBlockSize + lane / kBlockSize;
        return {tile_.cell_x() * kCellSize + static_cast<int>(px), tile_.cell_y() * kCellSize + static_cast<int>(py),
                indices_[place]};
    }

  private:
    const Tile& tile_;
    std::span<const std::uint16_t> indices_;
    std::span<const std::uint32_t> places_;
    std::uint32_t first_, block_, samples_per_block_;
};

// Pass 2: the exact test, depth, opacity and writes. `kSpecial`: of a triangle that is asked for more than edges and
// depth, or may be.
template <class K, bool kSpecial>
void write_hits(TileState& state, const Tested& tested, std::size_t count) {
    const F f;
    const U u;
    const Vec zero = hn::Zero(f);
    const LocalTriangle& T = tested.T;
    const Corners<K> corners(f, T);
    const bool ask_range = kSpecial && may_leave_depth_range(tested);
    const auto triangle = hn::Set(u, T.triangle);
    const OpacityTerms terms =
        kSpecial && T.alpha_tested && count != 0 ? opacity_terms(state.work.frame, T.triangle) : OpacityTerms();
    std::int64_t covered = 0;
    const Job* HWY_RESTRICT jobs = state.jobs.data();
    const SampleVector* HWY_RESTRICT samples = state.arrangement.samples;
    float* HWY_RESTRICT farthest_of_jobs = state.farthest.data();
    const JobPlaces<K::kFine> places(state);
    for (std::size_t j = 0; j < count; ++j) {
        const Job job = jobs[j];
        const SampleVector& s = samples[places.vector(job)];
        const std::size_t entry = places.entry(job);
        float* HWY_RESTRICT depths = places.depth + entry;
        std::uint32_t* HWY_RESTRICT triangles = places.triangle + entry;
        Vec farthest = zero;
        for (int lane = 0; lane < kLanes; lane += kWidth) {
            const PathTime<K::kMoves> time(f, tested, s.t + lane);
            const Deltas D = deltas<K, kSpecial>(f, tested, corners, time, s, lane);
            const Edges E = edges(D);
            const Decision decision = decide<K>(f, E, time);
            Mask hit = decision.inside;
            if (kSpecial && T.behind)
                hit = hn::And(hit,
                              in_box(f, state.centre, tested, time, hn::Load(f, s.x + lane), hn::Load(f, s.y + lane)));
            const Vec sum = hn::Add(hn::Add(E.e[0], E.e[1]), E.e[2]);
            Vec depth = hn::Add(hn::Add(hn::Mul(E.e[0], D.z[0]), hn::Mul(E.e[1], D.z[1])), hn::Mul(E.e[2], D.z[2]));
            depth = hn::Div(depth, sum);
            depth = hn::Min(hn::Max(depth, hn::Min(hn::Min(D.z[0], D.z[1]), D.z[2])),
                            hn::Max(hn::Max(D.z[0], D.z[1]), D.z[2]));
            if (kSpecial && ask_range)
                hit = hn::And(hit, hn::And(hn::Ge(depth, hn::Set(f, T.z_near)), hn::Le(depth, hn::Set(f, T.z_far))));
            if (HWY_UNLIKELY(!hn::AllFalse(f, decision.tied)))
                hit = hn::Or(hit, decide_ties(f, state, tested, s, lane, decision.tied, depth));
            covered += static_cast<std::int64_t>(hn::CountTrue(f, hit));
            const Vec stored = hn::Load(f, depths + lane);
            const auto stored_triangle = hn::Load(u, triangles + lane);
            const Mask equal = hn::And(hit, hn::Eq(depth, stored));
            hit = hn::And(hit, hn::Lt(depth, stored));
            if (HWY_UNLIKELY(!hn::AllFalse(f, equal))) {
                const Mask lower =
                    hn::RebindMask(f, hn::Lt(hn::BitCast(I(), triangle), hn::BitCast(I(), stored_triangle)));
                hit = hn::Or(hit, hn::And(equal, lower));
            }
            if (kSpecial && T.alpha_tested && !hn::AllFalse(f, hit))
                hit = decide_opacity(f, state.work, T.triangle, terms, E.e, sum, hit,
                                     LanesOfJob<K::kFine>(state, job, lane));
            const Vec nearest = hn::IfThenElse(hit, depth, stored);
            hn::Store(nearest, f, depths + lane);
            hn::Store(hn::IfThenElse(hn::RebindMask(u, hit), triangle, stored_triangle), u, triangles + lane);
            farthest = hn::Max(farthest, nearest);
        }
        farthest_of_jobs[job] = hn::GetLane(hn::MaxOfLanes(f, farthest));
    }
    state.counts.tested += static_cast<std::int64_t>(count) * kLanes;
    state.counts.covered += covered;
}

template <class K>
void write_hits(TileState& state, const Tested& tested, std::size_t count) {
    const LocalTriangle& T = tested.T;
    if (T.behind || T.orthographic || T.alpha_tested || may_leave_depth_range(tested))
        write_hits<K, true>(state, tested, count);
    else
        write_hits<K, false>(state, tested, count);
}

template <class K>
void cover_jobs(TileState& state, const Tested& tested, bool ask_edges, std::size_t jobs) {
    // Vectors that lie in one segment need not be asked which.
    constexpr Moves kAlone = K::kMoves == Moves::kInPieces ? Moves::kStraight : K::kMoves;
    if (ask_edges && tested.batch.segments[tested.k] * state.vector_span <= 1.0f)
        jobs = keep_within_edges<kAlone, K::kDefocus, K::kFine>(state, tested, jobs);
    else if (ask_edges)
        jobs = keep_within_edges<K::kMoves, K::kDefocus, K::kFine>(state, tested, jobs);
    write_hits<K>(state, tested, jobs);
}

}  // namespace HWY_NAMESPACE
}  // namespace pentaprism
HWY_AFTER_NAMESPACE();

#endif
