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

// One vector of samples: slot * blocks of the cell + block, blocks row by row.
using Job = std::uint32_t;

// Which strata the vectors of each slot belong to, with slots in lanes. A slot's blocks may lie in several strata:
// round r holds the r-th of each slot. Index [round * slots + slot].
struct SlotStrata {
    explicit SlotStrata(std::span<const Stratum> strata, int slot_count) {
        std::vector<int> strata_of_slot(slot_count);
        for (const Stratum& s : strata) rounds = std::max(rounds, ++strata_of_slot[s.slot]);
        slots = (slot_count + kLanes - 1) / kLanes * kLanes;
        stratum.assign(static_cast<std::size_t>(rounds) * slots, 0);
        blocks.assign(stratum.size(), 0);
        std::fill(strata_of_slot.begin(), strata_of_slot.end(), 0);
        for (const Stratum& s : strata) {
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

// How the samples of a cell stand in vectors: as in SampleTable, or as in FineLens.
struct Arrangement {
    int block_size, slots;        // pixels a side of a block; vectors of it
    const SampleVector* samples;  // [block * slots + slot], or, where `places` is not empty, [slot * blocks + block]
    std::span<const Domain> domains;
    std::span<const Stratum> strata;
    std::span<const std::uint32_t> places;  // of each lane its place in SampleTable::cell(); empty: the same order
};

// As in SampleTable.
struct ArrangementOfTable {
    explicit ArrangementOfTable(const TileWork& work) {
        const int cx = work.tile.cell_x(), cy = work.tile.cell_y();
        const SampleTable& table = work.samples;
        arrangement = {kBlockSize,
                       table.slots(),
                       table.cell(cx, cy, vectors_).data(),
                       table.domains(cx, cy, domains_),
                       table.strata(cx, cy),
                       {}};
    }
    Arrangement arrangement;

  private:
    std::vector<SampleVector> vectors_;
    std::vector<Domain> domains_;
};

// The tile's state that lives longer than a triangle.
struct TileState {
    TileState(const TileWork& w, const Arrangement& a, Hits& h, CoverCounts& c)
        : work(w),
          arrangement(a),
          hits(h),
          counts(c),
          centre(cell_centre(w.frame.view, w.tile.cell_x(), w.tile.cell_y())),
          slot_strata(a.strata, a.slots),
          masks_of_slots(slot_strata.slots),
          stratum_count(static_cast<int>(a.domains.size())),
          block_size(static_cast<float>(a.block_size)),
          per_block(1.0f / block_size),
          middle(0.5f * kCellSize * per_block),
          blocks_a_side(kCellSize / a.block_size),
          samples_per_block(static_cast<std::uint32_t>(w.samples.slots() * kLanes)),
          indices(w.samples.indices_of_cell(w.tile.cell_x(), w.tile.cell_y())) {
        for (int s = 0; s < kMaxStrata; ++s) {
            const Domain d = s < stratum_count ? a.domains[s] : Domain{0, 0, 0, 0, 2, -2};
            u[0][s] = d.u0, v[0][s] = d.v0, t[0][s] = d.t0;
            u[1][s] = d.u1, v[1][s] = d.v1, t[1][s] = d.t1;
            vector_span = std::max(vector_span, d.t1 - d.t0);
        }
        for (int b = 0; b < kBlocksPerCell; ++b) {
            const int column = b % kCellBlocks, row = b / kCellBlocks;
            column_of_block[b] = static_cast<float>(column);
            row_of_block[b] = static_cast<float>(row);
        }
    }

    const TileWork& work;
    Arrangement arrangement;
    Hits& hits;  // blocks that `places` rearrange in the arrangement's order
    CoverCounts& counts;
    CellCentre centre;
    SlotStrata slot_strata;
    AlignedVector<std::uint64_t> masks_of_slots;  // room for list_jobs()
    std::uint64_t tile_blocks = 0;                // blocks of the cell that belong to the tile
    AlignedVector<float> farthest;                // by job: largest depth stored so far
    std::vector<Job> jobs;
    float tile_farthest = INFINITY;  // no smaller than any of `farthest`
    // Least [0] and greatest [1] coordinates of the strata, padded to whole vectors with empty ones.
    HWY_ALIGN float u[2][kMaxStrata], v[2][kMaxStrata], t[2][kMaxStrata];
    int stratum_count;
    float vector_span = 0;                           // of the shutter: the longest stratum
    HWY_ALIGN std::uint64_t masks[kMaxStrata] = {};  // room: blocks of each stratum
    float block_size, per_block, middle;             // pixels a side, one over it, the cell's middle in blocks
    HWY_ALIGN float column_of_block[kBlocksPerCell], row_of_block[kBlocksPerCell];
    int blocks_a_side;
    std::uint32_t samples_per_block;         // in SampleTable
    std::span<const std::uint16_t> indices;  // of samples in their pixels, in the order of SampleTable::cell()

    // Corner of a block, pixels from the middle of the cell, y up.
    float left_of(int block) const { return block_size * column_of_block[block] - 0.5f * kCellSize; }
    float top_of(int block) const { return 0.5f * kCellSize - block_size * row_of_block[block]; }

    // `block`: 8 * row + column, as in masks.
    Job job(int slot, int block) const {
        return static_cast<Job>((slot * blocks_a_side + block / kCellBlocks) * blocks_a_side + block % kCellBlocks);
    }
    int slots() const { return arrangement.slots; }
};

// Where the samples and hits of jobs are. A copy: for all that the compiler knows, writing a hit could change the
// tile's state. `kFine`: of an arrangement whose `places` are not empty.
template <bool kFine>
struct JobPlaces {
    explicit JobPlaces(const TileState& state)
        : depth(state.hits.depth.data()),
          triangle(state.hits.triangle.data()),
          hits(state.hits),
          slots(static_cast<std::uint32_t>(state.arrangement.slots)) {}

    // The vector of a job in the arrangement.
    HWY_INLINE std::size_t vector(Job job) const {
        if constexpr (kFine) return job;
        return job % kBlocksPerCell * slots + job / kBlocksPerCell;
    }
    // Its first entry in `depth` and `triangle`, those of Hits. Rearranged tiles are whole cells.
    HWY_INLINE std::size_t entry(Job job) const {
        if constexpr (kFine) return std::size_t{job} * kLanes;
        return hits.first(static_cast<int>(job % kBlocksPerCell)) + job / kBlocksPerCell * kLanes;
    }

    float* depth;
    std::uint32_t* triangle;

  private:
    const Hits& hits;
    std::uint32_t slots;
};

}  // namespace HWY_NAMESPACE
}  // namespace pentaprism
HWY_AFTER_NAMESPACE();

#endif
