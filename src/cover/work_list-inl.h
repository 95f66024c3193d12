// Which vectors of samples may hit a triangle: its work list. Strata of (u, v, t) stand in the lanes; for each stratum
// the blocks of 4x4 pixels in which its samples can hit are the bits of a mask (docs/develop/algorithms.md 4.11).

#if defined(PENTAPRISM_COVER_WORK_LIST_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef PENTAPRISM_COVER_WORK_LIST_INL_H
#undef PENTAPRISM_COVER_WORK_LIST_INL_H
#else
#define PENTAPRISM_COVER_WORK_LIST_INL_H
#endif

#include <algorithm>
#include <bit>

#include "cover/half_planes-inl.h"
#include "cover/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pentaprism {
namespace HWY_NAMESPACE {

// Bits of the columns and rows of blocks that the ranges touch; ranges in block units, already clamped to 0..7.
constexpr std::uint64_t column_mask(int column0, int column1) {
    return column0 > column1 ? 0 : ((0xffull >> (7 - column1)) & (0xffull << column0)) * 0x0101010101010101ull;
}
constexpr std::uint64_t row_mask(int row0, int row1) {
    return row0 > row1 ? 0 : (~0ull >> (8 * (7 - row1))) & (~0ull << (8 * row0));
}

// Blocks of the cell, of `size` pixels a side, that the pixel rectangle touches.
inline std::uint64_t blocks_of(const BinnedTriangle& binned, const Tile& tile, int size) {
    const int left = tile.cell_x() * kCellSize, top = tile.cell_y() * kCellSize;
    const int x0 = std::max<int>(binned.x0, tile.x0) - left, x1 = std::min<int>(binned.x1, tile.x1) - left - 1;
    const int y0 = std::max<int>(binned.y0, tile.y0) - top, y1 = std::min<int>(binned.y1, tile.y1) - top - 1;
    return column_mask(x0 / size, x1 / size) & row_mask(y0 / size, y1 / size);
}

// Largest value of affine functions of (u, v, t) over strata: what the half-planes of triangle k allow.
class StratumLimits {
  public:
    // `segment`, `segments`: the strata's times are cut to that part of the shutter.
    HWY_INLINE StratumLimits(const TileState& state, float segment, float segments) : state_(state) {
        if (segments == 1.0f) {
            t_[0] = state.t[0], t_[1] = state.t[1];
            for (int first = 0; first < state.stratum_count; first += kWidth) groups_[group_count_++] = first;
            return;
        }
        const F f;
        constexpr float kWiden = 1e-6f;  // the segment's ends are rounded
        const Vec begin = hn::Set(f, segment / segments - kWiden), end = hn::Set(f, (segment + 1) / segments + kWiden);
        t_[0] = cut_[0], t_[1] = cut_[1];
        for (int first = 0; first < state.stratum_count; first += kWidth) {
            const Vec t0 = hn::Max(hn::Load(f, state.t[0] + first), begin);
            const Vec t1 = hn::Min(hn::Load(f, state.t[1] + first), end);
            if (hn::AllTrue(f, hn::Gt(t0, t1))) continue;
            groups_[group_count_++] = first;
            hn::Store(t0, f, cut_[0] + first);
            hn::Store(t1, f, cut_[1] + first);
        }
    }

    // Vectors of strata (the first of each) some of which have time in the segment.
    int group_count() const { return group_count_; }
    int group(int g) const { return groups_[g]; }
    // Lanes that have.
    HWY_INLINE Mask in_time(int first) const {
        const F f;
        return hn::Le(hn::Load(f, t_[0] + first), hn::Load(f, t_[1] + first));
    }

    // All blocks of strata that have time in the segment, none of the others.
    void all_blocks_in_time(std::uint64_t* masks) const {
        std::fill(masks, masks + kMaxStrata, 0);
        for (int g = 0; g < group_count_; ++g)
            for (int s = groups_[g]; s < groups_[g] + kWidth; ++s) masks[s] = t_[0][s] <= t_[1][s] ? ~0ull : 0;
    }

    // Signs are unpredictable: they choose an array, not a path.
    struct Plane {
        const float *t, *u, *v;
        float e, ku, kv, f;
    };
    HWY_INLINE Plane plane(const HalfPlanes& H, int p, int k) const {
        const float e = H.e[p][k], ku = H.ku[p][k], kv = H.kv[p][k];
        return {t_[e > 0], state_.u[ku > 0], state_.v[kv > 0], e, ku, kv, H.f[p][k]};
    }
    // Of a plane whose direction is that of x or of y, which leaves one lens coordinate out.
    HWY_INLINE static Vec along_x(const Plane& P, int first) {
        const F f;
        const Vec limit = hn::MulAdd(hn::Set(f, P.e), hn::Load(f, P.t + first), hn::Set(f, P.f));
        return hn::MulAdd(hn::Set(f, P.ku), hn::Load(f, P.u + first), limit);
    }
    HWY_INLINE static Vec along_y(const Plane& P, int first) {
        const F f;
        const Vec limit = hn::MulAdd(hn::Set(f, P.e), hn::Load(f, P.t + first), hn::Set(f, P.f));
        return hn::MulAdd(hn::Set(f, P.kv), hn::Load(f, P.v + first), limit);
    }
    HWY_INLINE static Vec in_any_direction(const Plane& P, int first) {
        const F f;
        return hn::MulAdd(hn::Set(f, P.kv), hn::Load(f, P.v + first), along_x(P, first));
    }

  private:
    const TileState& state_;
    const float* t_[2];
    int groups_[kMaxStrata / kWidth], group_count_ = 0;
    HWY_ALIGN float cut_[2][kMaxStrata];
};

// Masks of the blocks in the box of each stratum: sixteen strata from corners of boxes in blocks, each 0..7. Empty
// where `keep` is false.
HWY_INLINE void store_block_masks(Vec column0, Vec column1, Vec row0, Vec row1, Mask keep, std::uint64_t* masks) {
    const U u;
    const hn::Half<U> half;
    const U64 d;
    const auto integer = [&](Vec v) HWY_ATTR { return hn::BitCast(u, hn::ConvertTo(I(), v)); };
    const auto seven = hn::Set(u, kCellBlocks - 1);
    // One bit for each column, in each of four rows.
    const auto from = hn::Shl(hn::Set(u, 0xff), integer(column0)),
               to = hn::Shr(hn::Set(u, 0xff), hn::Sub(seven, integer(column1)));
    const auto columns =
        hn::IfThenElseZero(hn::RebindMask(u, keep), hn::Mul(hn::And(from, to), hn::Set(u, 0x01010101)));
    const auto above = hn::ShiftLeft<3>(integer(row0)), below = hn::ShiftLeft<3>(hn::Sub(seven, integer(row1)));
    const auto store = [&](auto c, auto a, auto b, std::uint64_t* to_masks) HWY_ATTR {
        const Vec64 all = hn::Set(d, ~std::uint64_t{0}), four_rows = hn::PromoteTo(d, c);
        const Vec64 rows = hn::And(hn::Shl(all, hn::PromoteTo(d, a)), hn::Shr(all, hn::PromoteTo(d, b)));
        hn::Store(hn::And(rows, hn::Or(four_rows, hn::ShiftLeft<32>(four_rows))), d, to_masks);
    };
    store(hn::LowerHalf(half, columns), hn::LowerHalf(half, above), hn::LowerHalf(half, below), masks);
    store(hn::UpperHalf(half, columns), hn::UpperHalf(half, above), hn::UpperHalf(half, below), masks + kWidth64);
}

// Blocks between left and right, above and below. `masks` as long as kMaxStrata.
HWY_INLINE void boxes_of_strata(const TileState& state, const HalfPlanes& H, int k, const StratumLimits& limits,
                                std::uint64_t* masks) {
    const F f;
    const StratumLimits::Plane right = limits.plane(H, HalfPlanes::kRight, k),
                               left = limits.plane(H, HalfPlanes::kLeft, k),
                               above = limits.plane(H, HalfPlanes::kAbove, k),
                               below = limits.plane(H, HalfPlanes::kBelow, k);
    const Vec middle = hn::Set(f, state.middle), per_block = hn::Set(f, state.per_block), zero = hn::Zero(f);
    const Vec eight = hn::Set(f, kCellBlocks), seven = hn::Set(f, kCellBlocks - 1);
    const auto clamped = [&](Vec v) HWY_ATTR { return hn::Min(hn::Max(v, zero), seven); };
    if (limits.group_count() * kWidth < state.stratum_count) std::fill(masks, masks + state.stratum_count, 0);
    for (int g = 0; g < limits.group_count(); ++g) {
        const int first = limits.group(g);
        // From the cell's top left corner, y down, in blocks (a power of two: nothing is rounded that was not before).
        const Vec x0 = hn::NegMulAdd(limits.along_x(left, first), per_block, middle);
        const Vec x1 = hn::MulAdd(limits.along_x(right, first), per_block, middle);
        const Vec y0 = hn::NegMulAdd(limits.along_y(above, first), per_block, middle);
        const Vec y1 = hn::MulAdd(limits.along_y(below, first), per_block, middle);
        // Reject before clamping: a clamped bound would keep or lose the cell's last half pixel.
        const Mask keep = hn::And(hn::Le(hn::Max(x0, y0), eight), hn::Ge(hn::Min(x1, y1), zero));
        store_block_masks(clamped(x0), clamped(x1), clamped(y0), clamped(y1), hn::And(keep, limits.in_time(first)),
                          masks + first);
    }
}

// Groups of kLanes blocks, two rows of a cell, that hold the blocks of a mask: [begin, end).
struct BlockGroups {
    explicit BlockGroups(std::uint64_t blocks)
        : begin(blocks == 0 ? 0 : std::countr_zero(blocks) / kLanes),
          end(blocks == 0 ? 0 : (63 - std::countl_zero(blocks)) / kLanes + 1) {}
    int begin, end;
};

// Blocks beyond an edge, over all of a stratum, are refused: for triangles that fill many blocks. `among`: those that
// matter.
HWY_NOINLINE inline void refuse_blocks_by_edges(const TileState& state, const HalfPlanes& H, int k,
                                                const StratumLimits& limits, const BlockGroups& among,
                                                std::uint64_t* masks) {
    const F f;
    constexpr int kEdge = HalfPlanes::kEdges;
    HWY_ALIGN float limit[3][kMaxStrata];
    HWY_ALIGN float least[3][kBlocksPerCell];  // n.h of the block's corner that lies deepest inside
    for (int edge = 0; edge < 3; ++edge) {
        const StratumLimits::Plane plane = limits.plane(H, kEdge + edge, k);
        for (int g = 0; g < limits.group_count(); ++g)
            hn::Store(limits.in_any_direction(plane, limits.group(g)), f, limit[edge] + limits.group(g));
        const float nx = H.nx[kEdge + edge][k], ny = H.ny[kEdge + edge][k];
        const float size = state.block_size;
        const float origin = nx * (nx > 0 ? -16.0f : size - 16.0f) + ny * (ny > 0 ? 16.0f - size : 16.0f);
        for (int block = among.begin * kLanes; block < among.end * kLanes; block += kWidth) {
            const Vec x =
                hn::MulAdd(hn::Set(f, nx * size), hn::Load(f, state.column_of_block + block), hn::Set(f, origin));
            hn::Store(hn::NegMulAdd(hn::Set(f, ny * size), hn::Load(f, state.row_of_block + block), x), f,
                      least[edge] + block);
        }
    }
    for (int s = 0; s < state.stratum_count; ++s) {
        if (masks[s] == 0) continue;
        const Vec l0 = hn::Set(f, limit[0][s]), l1 = hn::Set(f, limit[1][s]), l2 = hn::Set(f, limit[2][s]);
        std::uint64_t within = 0;
        for (int block = among.begin * kLanes; block < among.end * kLanes; block += kWidth) {
            const Mask inside =
                hn::And(hn::And(hn::Le(hn::Load(f, least[0] + block), l0), hn::Le(hn::Load(f, least[1] + block), l1)),
                        hn::Le(hn::Load(f, least[2] + block), l2));
            within |= bits_of(f, inside) << block;
        }
        masks[s] &= within;
    }
}

// Triangles at the camera plane: quotients are invalid there, so the improved dual-space test is asked for 8x8 pixels
// each, which takes as long as testing four vectors of samples.
inline std::uint64_t blocks_at_camera_plane(const LocalTriangle& T, const CullTest& test, float ratio, float block_size,
                                            std::uint64_t candidates) {
    constexpr float kAsked = 8.0f;
    const int step = static_cast<int>(kAsked / block_size);
    CullState scratch;
    std::uint64_t kept = 0;
    for (std::uint64_t m = candidates; m != 0;) {
        const int block = std::countr_zero(m), column = block % kCellBlocks / step, row = block / kCellBlocks / step;
        const std::uint64_t blocks =
            column_mask(column * step, column * step + step - 1) & row_mask(row * step, row * step + step - 1);
        const float x = static_cast<float>(column) * kAsked - 0.5f * kCellSize;
        const float y = 0.5f * kCellSize - static_cast<float>(row) * kAsked;
        const Footprint footprint{x, x + kAsked, y - kAsked, y, {-1.0f, 1.0f, -ratio, ratio, 0.0f, 1.0f}};
        if (test.prepare(T, footprint, scratch)) kept |= candidates & blocks;
        m &= ~blocks;
    }
    return kept;
}

// Blocks of each slot in which its samples can hit, of `blocks`; returns which slots have any, one bit for each.
HWY_INLINE void masks_of_slots(const TileState& state, const std::uint64_t* masks, std::uint64_t blocks,
                               std::uint64_t* slots) {
    const U64 d;
    const hn::RebindToSigned<U64> i64;
    const SlotStrata& S = state.slot_strata;
    const Vec64 wanted = hn::Set(d, blocks);
    for (int slot = 0; slot < S.slots; slot += kWidth64) {
        Vec64 m = hn::Zero(d);
        for (int round = 0; round < S.rounds; ++round) {
            const int at = round * S.slots + slot;
            const Vec64 of_stratum = S.consecutive ? hn::LoadU(d, masks + S.stratum[at])
                                                   : hn::GatherIndex(d, masks, hn::Load(i64, &S.stratum[at]));
            m = hn::Or(m, hn::And(of_stratum, hn::Load(d, &S.blocks[at])));
        }
        hn::Store(hn::And(m, wanted), d, slots + slot);
    }
}

// Bits 8 * row + column of four rows and columns as bits 4 * row + column, and the other way.
constexpr std::uint32_t four_by_four(std::uint64_t blocks) {
    const std::uint64_t pairs = (blocks | blocks >> 4) & 0x00ff00ff;
    return static_cast<std::uint32_t>(pairs | pairs >> 8) & 0xffffu;
}
constexpr std::uint64_t of_eight_by_eight(std::uint32_t bits) {
    const std::uint64_t pairs = (bits | std::uint64_t{bits} << 8) & 0x00ff00ff;
    return (pairs | pairs << 4) & 0x0f0f0f0f;
}
static_assert(four_by_four(0x0804'0201) == 0x8421 && of_eight_by_eight(0x8421) == 0x0804'0201);

// Of the sixteen jobs from `first` on, those that are not hidden: one bit each.
HWY_INLINE std::uint32_t shown(const TileState& state, Job first, Vec near) {
    const F f;
    std::uint32_t bits = 0;
    for (int lane = 0; lane < kLanes; lane += kWidth)
        bits |= static_cast<std::uint32_t>(bits_of(f, hn::Le(near, hn::Load(f, &state.farthest[first + lane]))))
                << lane;
    return bits;
}

// The vectors (block, slot) of the masks that are not hidden, slot by slot. How many bits a mask has is unpredictable,
// so all the lanes of a group of blocks are written, wanted or not.
HWY_NOINLINE inline std::size_t list_jobs(TileState& state, const std::uint64_t* masks, std::uint64_t blocks,
                                          float nearest) {
    const F f;
    const Vec near = hn::Set(f, nearest);
    std::uint64_t* HWY_RESTRICT slots = state.masks_of_slots.data();
    masks_of_slots(state, masks, blocks, slots);
    Job* HWY_RESTRICT jobs = state.jobs.data();
    std::size_t count = 0;
    const int slot_count = state.slots();
    if (state.blocks_a_side < kCellBlocks) {
        for (int slot = 0; slot < slot_count; ++slot)
            if (slots[slot] != 0) {
                const Job first = static_cast<Job>(slot * kLanes);
                count += write_lanes(first, four_by_four(slots[slot]) & shown(state, first, near), jobs + count);
            }
        return count;
    }
    const BlockGroups groups(blocks);
    for (int slot = 0; slot < slot_count; ++slot) {
        const std::uint64_t m = slots[slot];
        if (m == 0) continue;
        for (int g = groups.begin; g < groups.end; ++g) {
            const Job first = static_cast<Job>(slot * kBlocksPerCell + g * kLanes);
            const std::uint32_t wanted = static_cast<std::uint32_t>(m >> g * kLanes) & 0xffffu;
            count += write_lanes(first, wanted & shown(state, first, near), jobs + count);
        }
    }
    return count;
}

// Blocks of a slot, of those in `groups`, that are not hidden.
HWY_INLINE std::uint64_t shown_blocks(const TileState& state, int slot, const BlockGroups& groups, Vec near) {
    if (state.blocks_a_side < kCellBlocks)
        return of_eight_by_eight(shown(state, static_cast<Job>(slot * kLanes), near));
    std::uint64_t blocks = 0;
    for (int g = groups.begin; g < groups.end; ++g)
        blocks |= std::uint64_t{shown(state, static_cast<Job>(slot * kBlocksPerCell + g * kLanes), near)} << g * kLanes;
    return blocks;
}

}  // namespace HWY_NAMESPACE
}  // namespace pentaprism
HWY_AFTER_NAMESPACE();

#endif
