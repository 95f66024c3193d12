// Which vectors of samples may hit a triangle: its work list. Strata of (u, v, t) stand in the lanes; for each stratum
// the blocks of 4x4 pixels in which its samples can hit are the bits of a mask (docs/develop/algorithms.md 4.11).

#if defined(PENTAPRISM_COVER_WORK_LIST_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef PENTAPRISM_COVER_WORK_LIST_INL_H
#undef PENTAPRISM_COVER_WORK_LIST_INL_H
#else
#define PENTAPRISM_COVER_WORK_LIST_INL_H
#endif

#include <algorithm>
#include <array>
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

// The same by 8 * first + last; 64: nothing.
using MaskTable = std::array<std::uint64_t, 65>;
constexpr MaskTable mask_table(std::uint64_t (*mask)(int, int)) {
    MaskTable table{};
    for (int i = 0; i < 64; ++i) table[i] = mask(i / 8, i % 8);
    return table;
}
constexpr MaskTable kColumns = mask_table(column_mask), kRows = mask_table(row_mask);

// Blocks of the cell that the pixel rectangle touches.
inline std::uint64_t blocks_of(const BinnedTriangle& binned, const Tile& tile) {
    const int left = tile.cell_x() * kCellSize, top = tile.cell_y() * kCellSize;
    const int x0 = std::max<int>(binned.x0, tile.x0) - left, x1 = std::min<int>(binned.x1, tile.x1) - left - 1;
    const int y0 = std::max<int>(binned.y0, tile.y0) - top, y1 = std::min<int>(binned.y1, tile.y1) - top - 1;
    return column_mask(x0 / kBlockSize, x1 / kBlockSize) & row_mask(y0 / kBlockSize, y1 / kBlockSize);
}

inline float block_x(int block) {
    return static_cast<float>(block % kCellBlocks * kBlockSize - kCellSize / 2);
}
inline float block_y(int block) {
    return static_cast<float>(kCellSize / 2 - block / kCellBlocks * kBlockSize);
}

// The half-planes over strata: for a sample of stratum s that is hit, n.h <= limit[plane][s].
struct StratumLimits {
    HWY_ALIGN float limit[HalfPlanes::kCount][kMaxStrata];
    HWY_ALIGN std::int32_t outside[kMaxStrata];        // -1: has no time in this segment
    int groups[kMaxStrata / kWidth], group_count = 0;  // vectors of strata (the first of each) some of which have
};

HWY_INLINE void bound_strata(const TileState& state, const LocalTriangle& T, const HalfPlanes& H, int planes,
                             StratumLimits& out) {
    const F f;
    const I i;
    constexpr float kWiden = 1e-6f;  // the segment's ends are rounded
    const Vec begin = hn::Set(f, T.segment / T.segments - kWiden),
              end = hn::Set(f, (T.segment + 1) / T.segments + kWiden);
    HWY_ALIGN float t[2][kMaxStrata];  // of the strata, within the segment
    for (int first = 0; first < state.stratum_count; first += kWidth) {
        const Vec t0 = hn::Max(hn::Load(f, state.t[0] + first), begin);
        const Vec t1 = hn::Min(hn::Load(f, state.t[1] + first), end);
        const Mask outside = hn::Gt(t0, t1);
        if (hn::AllTrue(f, outside)) continue;
        out.groups[out.group_count++] = first;
        hn::Store(t0, f, t[0] + first);
        hn::Store(t1, f, t[1] + first);
        hn::Store(hn::BitCast(i, hn::VecFromMask(f, outside)), i, out.outside + first);
    }
    for (int p = 0; p < planes; ++p) {
        // Signs are unpredictable: they choose an array, not a path.
        const float *const te = t[H.e[p] > 0], *const tu = state.u[H.ku[p] > 0], *const tv = state.v[H.kv[p] > 0];
        const Vec e = hn::Set(f, H.e[p]), ku = hn::Set(f, H.ku[p]), kv = hn::Set(f, H.kv[p]), c = hn::Set(f, H.f[p]);
        for (int g = 0; g < out.group_count; ++g) {
            const int first = out.groups[g];
            const Vec limit = hn::MulAdd(ku, hn::Load(f, tu + first), hn::MulAdd(e, hn::Load(f, te + first), c));
            hn::Store(hn::MulAdd(kv, hn::Load(f, tv + first), limit), f, out.limit[p] + first);
        }
    }
}

// Blocks between left and right, above and below.
HWY_INLINE void boxes_of_strata(const TileState& state, const StratumLimits& limits, std::uint64_t* masks) {
    const F f;
    const I i;
    const Vec half = hn::Set(f, kCellSize / 2), to_blocks = hn::Set(f, 1.0f / kBlockSize);
    const Vec zero = hn::Zero(f), seven = hn::Set(f, kCellBlocks - 1);
    HWY_ALIGN std::int32_t columns[kMaxStrata], rows[kMaxStrata];
    const auto block = [&](Vec v)
                           HWY_ATTR { return hn::ConvertTo(i, hn::Min(hn::Max(hn::Mul(v, to_blocks), zero), seven)); };
    for (int g = 0; g < limits.group_count; ++g) {
        const int first = limits.groups[g];
        // From the cell's top left corner, y down.
        const Vec x0 = hn::Sub(half, hn::Load(f, limits.limit[HalfPlanes::kLeft] + first));
        const Vec x1 = hn::Add(half, hn::Load(f, limits.limit[HalfPlanes::kRight] + first));
        const Vec y0 = hn::Sub(half, hn::Load(f, limits.limit[HalfPlanes::kAbove] + first));
        const Vec y1 = hn::Add(half, hn::Load(f, limits.limit[HalfPlanes::kBelow] + first));
        // Reject before clamping: a clamped bound would keep or lose the cell's last half pixel.
        const Vec size = hn::Set(f, kCellSize);
        const Mask within =
            hn::And(hn::And(hn::Le(x0, size), hn::Ge(x1, zero)), hn::And(hn::Le(y0, size), hn::Ge(y1, zero)));
        const auto in_time = hn::Eq(hn::Load(i, limits.outside + first), hn::Zero(i));
        const auto keep = hn::And(hn::RebindMask(i, within), in_time);
        hn::Store(hn::IfThenElse(keep, hn::Add(hn::ShiftLeft<3>(block(x0)), block(x1)), hn::Set(i, 64)), i,
                  columns + first);
        hn::Store(hn::Add(hn::ShiftLeft<3>(block(y0)), block(y1)), i, rows + first);
    }
    if (limits.group_count * kWidth < state.stratum_count) std::fill(masks, masks + state.stratum_count, 0);
    for (int g = 0; g < limits.group_count; ++g) {
        const int last = std::min(limits.groups[g] + kWidth, state.stratum_count);
        for (int s = limits.groups[g]; s < last; ++s) masks[s] = kColumns[columns[s]] & kRows[rows[s]];
    }
}

// For each of the 64 blocks whether a condition that compares sixteen of them at a time holds.
template <class Condition>
HWY_INLINE std::uint64_t for_blocks(Condition condition) {
    const F f;
    std::uint64_t mask = 0;
    for (int first = 0; first < kBlocksPerCell; first += kWidth) mask |= bits_of(f, condition(first)) << first;
    return mask;
}

// Blocks beyond an edge, over all of a stratum, are refused: for triangles that fill many blocks.
HWY_NOINLINE inline void refuse_blocks_by_edges(const TileState& state, const HalfPlanes& H,
                                                const StratumLimits& limits, std::uint64_t* masks) {
    const F f;
    HWY_ALIGN float least[3][kBlocksPerCell];  // n.h of the block's corner that lies deepest inside
    for (int k = 0; k < 3; ++k) {
        const float nx = H.nx[HalfPlanes::kEdges + k], ny = H.ny[HalfPlanes::kEdges + k];
        const float origin = nx * (nx > 0 ? -16.0f : -12.0f) + ny * (ny > 0 ? 12.0f : 16.0f);
        for (int block = 0; block < kBlocksPerCell; block += kWidth) {
            const Vec x =
                hn::MulAdd(hn::Set(f, nx * kBlockSize), hn::Load(f, state.column_of_block + block), hn::Set(f, origin));
            hn::Store(hn::NegMulAdd(hn::Set(f, ny * kBlockSize), hn::Load(f, state.row_of_block + block), x), f,
                      least[k] + block);
        }
    }
    for (int s = 0; s < state.stratum_count; ++s) {
        if (masks[s] == 0) continue;
        const Vec l0 = hn::Set(f, limits.limit[HalfPlanes::kEdges][s]),
                  l1 = hn::Set(f, limits.limit[HalfPlanes::kEdges + 1][s]),
                  l2 = hn::Set(f, limits.limit[HalfPlanes::kEdges + 2][s]);
        masks[s] &= for_blocks([&](int first) HWY_ATTR {
            return hn::And(
                hn::And(hn::Le(hn::Load(f, least[0] + first), l0), hn::Le(hn::Load(f, least[1] + first), l1)),
                hn::Le(hn::Load(f, least[2] + first), l2));
        });
    }
}

// Triangles at the camera plane: quotients are invalid there, so each block asks the improved dual-space test.
inline std::uint64_t blocks_at_camera_plane(const LocalTriangle& T, const CullTest& test, float ratio,
                                            std::uint64_t candidates) {
    CullState scratch;
    std::uint64_t kept = 0;
    for (std::uint64_t m = candidates; m != 0; m &= m - 1) {
        const int block = std::countr_zero(m);
        const float x = block_x(block), y = block_y(block);
        const Footprint footprint{x, x + kBlockSize, y - kBlockSize, y, {-1.0f, 1.0f, -ratio, ratio, 0.0f, 1.0f}};
        if (test.prepare(T, footprint, scratch)) kept |= m & -m;
    }
    return kept;
}

// The vectors (block, slot) of the masks that are not hidden, slot by slot. How many bits a mask has is unpredictable,
// so bits are written out eight at a time, wanted or not.
HWY_NOINLINE inline std::size_t list_jobs(TileState& state, const std::uint64_t* masks, std::uint64_t blocks,
                                          float nearest) {
    const F f;
    const Vec near = hn::Set(f, nearest);
    Job* HWY_RESTRICT jobs = state.jobs.data();
    std::size_t count = 0;
    const auto* entry = state.strata.data();
    const auto* const end = entry + state.strata.size();
    while (entry != end) {
        const Job slot = entry->slot;
        std::uint64_t m = 0;
        do m |= masks[entry->stratum] & entry->blocks;
        while (++entry != end && entry->slot == slot);
        m &= blocks;
        if (m == 0) continue;
        const float* farthest = &state.farthest[slot * kBlocksPerCell];
        m &= for_blocks([&](int first) HWY_ATTR { return hn::Le(near, hn::Load(f, farthest + first)); });
        if (m == 0) continue;
        const std::size_t next = count + static_cast<std::size_t>(std::popcount(m));
        do {
            for (int k = 0; k < 8; ++k, m &= m - 1)
                jobs[count + k] = slot * kBlocksPerCell + static_cast<Job>(std::countr_zero(m));
            count += 8;
        } while (m != 0);
        count = next;
    }
    return count;
}

}  // namespace HWY_NAMESPACE
}  // namespace pentaprism
HWY_AFTER_NAMESPACE();

#endif
