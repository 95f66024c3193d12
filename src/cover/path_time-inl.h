// Samples in time: which segment of a triangle's path each belongs to, and when in it. Compiled once for each CPU
// target (see cover_vectors.cpp).
//
// A path of many segments meets vectors that span several of them. Tested for one segment after the other, each time
// most of the lanes would be those of other segments; so they are tested once, and each lane looks the numbers of its
// own segment up in a register that holds those of all.

#if defined(PENTAPRISM_COVER_PATH_TIME_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef PENTAPRISM_COVER_PATH_TIME_INL_H
#undef PENTAPRISM_COVER_PATH_TIME_INL_H
#else
#define PENTAPRISM_COVER_PATH_TIME_INL_H
#endif

#include "cover/blur_batch-inl.h"
#include "cover/front_to_back.h"
#include "cover/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pentaprism {
namespace HWY_NAMESPACE {

enum class Moves {
    kNot,
    kStraight,
    kInPieces,    // one of several segments: samples of the others are not ours
    kAlongPieces  // several segments that follow each other: each sample has its own
};
template <Moves kMoves>
constexpr bool kSegments = kMoves == Moves::kInPieces || kMoves == Moves::kAlongPieces;

// A triangle in one segment of its path or, with Moves::kAlongPieces, in several.
struct Tested {
    const BlurBatch& batch;
    int k, count;  // the segments: of the batch, within one vector of its lanes; all reach the camera plane, or none
    const LocalTriangle& T;  // the first
};

// Segment k of the batch with its box.
inline LocalTriangle at_camera_plane(const TileState& state, const BlurBatch& batch, int k) {
    const BinnedTriangle& binned = *batch.binned[k];
    return localize(state.work.frame, binned.triangle, binned.segment, state.centre, state.work.scale);
}

// How many segments from k on may be tested at once.
inline int count_segments(const TileState& state, const BlurBatch& batch, int k) {
    if (!crosses_segments(*batch.part[k], state.vector_span)) return 1;
    const int end = std::min(batch.count, (k / kWidth + 1) * kWidth);
    const auto follows = [&](int next) {
        const BinnedTriangle &one = *batch.binned[next - 1], &other = *batch.binned[next];
        return batch.behind[next] == batch.behind[k] && other.triangle == one.triangle &&
               other.segment == one.segment + 1;
    };
    int next = k + 1;
    while (next < end && follows(next)) ++next;
    return next - k;
}

template <Moves kMoves>
struct PathTime {
    HWY_INLINE PathTime(F f, const Tested& tested, const float* t) : tau(hn::Zero(f)) {
        if constexpr (kMoves != Moves::kNot) tau = hn::Load(f, t);
        if constexpr (kSegments<kMoves>) {
            const Vec segments = hn::Set(f, tested.batch.segments[tested.k]);
            const Vec first = hn::Set(f, tested.batch.segment[tested.k]);
            if constexpr (kMoves == Moves::kAlongPieces) {
                const Vec segment = hn::Floor(hn::Mul(tau, segments));  // a power of two: exact
                const Vec place = hn::Sub(segment, first);
                ours = hn::And(hn::Ge(place, hn::Zero(f)), hn::Lt(place, hn::Set(f, static_cast<float>(tested.count))));
                const int first_lane = tested.k % kWidth;
                const auto lane = hn::Add(hn::ConvertTo(I(), place), hn::Set(I(), first_lane));
                lanes = hn::IndicesFromVec(f, hn::And(lane, hn::Set(I(), kWidth - 1)));
                vector = tested.k - first_lane;
                tau = hn::MulSub(tau, segments, segment);
            } else {
                tau = hn::MulSub(tau, segments, first);
                ours = hn::And(hn::Ge(tau, hn::Zero(f)), hn::Lt(tau, hn::Set(f, 1.0f)));
            }
        }
    }

    // Of each sample's segment; `row`: of a batch.
    HWY_INLINE Vec look_up(F f, const float* row) const {
        return hn::TableLookupLanes(hn::Load(f, row + vector), lanes);
    }

    Vec tau;      // in the segment: 0 at its beginning, 1 at its end
    Mask ours{};  // samples of the tested segments; the others' numbers are any

  private:
    decltype(hn::IndicesFromVec(F(), hn::Vec<I>())) lanes{};
    int vector = 0;  // lanes of the batch before it
};

}  // namespace HWY_NAMESPACE
}  // namespace pentaprism
HWY_AFTER_NAMESPACE();

#endif
