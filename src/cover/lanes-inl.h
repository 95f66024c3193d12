// Sixteen samples at a time: the types of the vector kernels, and the state of a tile that they share. Compiled once
// for each CPU target (see cover_vectors.cpp).

#if defined(PENTAPRISM_COVER_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef PENTAPRISM_COVER_LANES_INL_H
#undef PENTAPRISM_COVER_LANES_INL_H
#else
#define PENTAPRISM_COVER_LANES_INL_H
#endif

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

// One vector of samples: slot * kBlocksPerCell + block.
using Job = std::uint32_t;

// The tile's state that lives longer than a triangle.
struct TileState {
    TileState(const TileWork& w, Hits& h, CoverCounts& c)
        : work(w), hits(h), counts(c), centre(cell_centre(w.frame.view, w.tile.cell_x(), w.tile.cell_y())) {}

    const TileWork& work;
    Hits& hits;
    CoverCounts& counts;
    CellCentre centre;
    std::span<const SampleTable::Stratum> strata;
    std::uint64_t tile_blocks = 0;          // blocks of the cell that belong to the tile
    const SampleVector* samples = nullptr;  // of the cell, by job
    AlignedVector<float> farthest;          // by job: largest depth stored so far
    std::vector<Job> jobs;
    float tile_farthest = INFINITY;  // no smaller than any of `farthest`
    // Least [0] and greatest [1] coordinates of the strata, padded to whole vectors with empty ones.
    HWY_ALIGN float u[2][kMaxStrata], v[2][kMaxStrata], t[2][kMaxStrata];
    int stratum_count = 0;
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
