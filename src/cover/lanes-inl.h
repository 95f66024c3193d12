// Sixteen samples at a time: the types of the vector kernels, and the state of a tile that they share. Compiled once
// for each CPU target (see cover_vectors.cpp).

#if defined(PENTAPRISM_COVER_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef PENTAPRISM_COVER_LANES_INL_H
#undef PENTAPRISM_COVER_LANES_INL_H
#else
#define PENTAPRISM_COVER_LANES_INL_H
#endif

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <hwy/highway.h>
#include <type_traits>
#include <vector>

#include "cover/cover.h"

HWY_BEFORE_NAMESPACE();
namespace pentaprism {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using F = hn::CappedTag<float, kLanes>;
using Vec = hn::Vec<F>;
using Mask = hn::Mask<F>;
using I = hn::RebindToSigned<F>;
using U = hn::RebindToUnsigned<F>;
constexpr int kWidth = static_cast<int>(hn::MaxLanes(F()));  // lanes of one Vec
using U64 = hn::Repartition<std::uint64_t, F>;
using Vec64 = hn::Vec<U64>;
constexpr int kWidth64 = static_cast<int>(hn::MaxLanes(U64()));
constexpr float kUnitRoundoff = 1.0f / 16777216.0f;
constexpr int kMaxStrata = 64;

// One bit for each lane. Stored as wide as it is loaded again, so that it need not go through memory.
HWY_INLINE std::uint64_t bits_of(F f, Mask mask) {
    using Bits = std::conditional_t<(kWidth > 8), std::uint16_t, std::uint8_t>;
    std::uint8_t bytes[8];
    hn::StoreMaskBits(f, mask, bytes);
    Bits bits;
    std::memcpy(&bits, bytes, sizeof bits);
    return bits;
}

// Writes first + lane for the lanes whose bit is set; returns how many. Writes up to sixteen.
HWY_INLINE std::size_t write_lanes(std::uint32_t first, std::uint32_t lanes, std::uint32_t* HWY_RESTRICT jobs) {
    if constexpr (kWidth == kLanes) {
        const U u;
        const auto bits = static_cast<std::uint64_t>(lanes);
        const auto mask = hn::LoadMaskBits(u, reinterpret_cast<const std::uint8_t*>(&bits));
        hn::StoreU(hn::Compress(hn::Add(hn::Iota(u, 0), hn::Set(u, first)), mask), u, jobs);
    } else {  // a vector's Compress is slow elsewhere: eight at a time, wanted or not
        std::uint32_t m = lanes;
        for (int i = 0; i < 8; ++i, m &= m - 1) jobs[i] = first + static_cast<std::uint32_t>(std::countr_zero(m));
        if (m != 0)
            for (int i = 8; i < kLanes; ++i, m &= m - 1)
                jobs[i] = first + static_cast<std::uint32_t>(std::countr_zero(m));
    }
    return static_cast<std::size_t>(std::popcount(lanes));
}

// One vector of samples: slot * kBlocksPerCell + block.
using Job = std::uint32_t;

// Which strata the vectors of each slot belong to, with slots in lanes. A slot's blocks may lie in several strata:
// round r holds the r-th of each slot. Index [round * slots + slot].
struct SlotStrata {
    explicit SlotStrata(std::span<const SampleTable::Stratum> strata, int slot_count) {
        std::vector<int> strata_of_slot(slot_count);
        for (const SampleTable::Stratum& s : strata) rounds = std::max(rounds, ++strata_of_slot[s.slot]);
        slots = (slot_count + kLanes - 1) / kLanes * kLanes;
        stratum.assign(static_cast<std::size_t>(rounds) * slots, 0);
        blocks.assign(stratum.size(), 0);
        std::fill(strata_of_slot.begin(), strata_of_slot.end(), 0);
        for (const SampleTable::Stratum& s : strata) {
            const std::size_t at = static_cast<std::size_t>(strata_of_slot[s.slot]++) * slots + s.slot;
            stratum[at] = s.stratum;
            blocks[at] = s.blocks;
        }
        consecutive = slot_count == slots;
        for (std::size_t at = 0; at < stratum.size(); ++at)
            consecutive = consecutive && stratum[at] == stratum[at / kWidth64 * kWidth64] + std::int64_t(at % kWidth64);
    }
    int rounds = 0, slots = 0;  // slots: whole vectors
    bool consecutive = false;   // lanes of a vector are in strata that follow each other
    AlignedVector<std::int64_t> stratum;
    AlignedVector<std::uint64_t> blocks;
};

// The tile's state that lives longer than a triangle.
struct TileState {
    TileState(const TileWork& w, Hits& h, CoverCounts& c)
        : work(w),
          hits(h),
          counts(c),
          centre(cell_centre(w.frame.view, w.tile.cell_x(), w.tile.cell_y())),
          slot_strata(w.samples.strata(w.tile.cell_x(), w.tile.cell_y()), w.samples.slots()),
          masks_of_slots(slot_strata.slots) {}

    const TileWork& work;
    Hits& hits;
    CoverCounts& counts;
    CellCentre centre;
    SlotStrata slot_strata;
    AlignedVector<std::uint64_t> masks_of_slots;  // room for list_jobs()
    std::uint64_t tile_blocks = 0;                // blocks of the cell that belong to the tile
    const SampleVector* samples = nullptr;        // of the cell, by job
    AlignedVector<float> farthest;                // by job: largest depth stored so far
    std::vector<Job> jobs;
    float tile_farthest = INFINITY;  // no smaller than any of `farthest`
    // Least [0] and greatest [1] coordinates of the strata, padded to whole vectors with empty ones.
    HWY_ALIGN float u[2][kMaxStrata], v[2][kMaxStrata], t[2][kMaxStrata];
    int stratum_count = 0;
    std::span<const SampleTable::Stratum> strata;    // which vectors lie in them
    HWY_ALIGN std::uint64_t masks[kMaxStrata] = {};  // room: blocks of each stratum
    HWY_ALIGN float column_of_block[kBlocksPerCell], row_of_block[kBlocksPerCell];

    // Place of a job in SampleTable::cell() and, times kLanes, in Hits.
    std::size_t place(Job job) const {
        return (job % kBlocksPerCell) * static_cast<std::size_t>(slots) + job / kBlocksPerCell;
    }
    int slots = 0;
};

}  // namespace HWY_NAMESPACE
}  // namespace pentaprism
HWY_AFTER_NAMESPACE();

#endif
