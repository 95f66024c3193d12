#pragma once
// The two inner loops of the micropolygon path, on the CPU target in use. Both are bounds: they may let more through
// than necessary, on some targets than on others, and never less; cover/exact.h decides.

#include <cstdint>
#include <span>

#include "cover/dice.h"
#include "sample/sample_table.h"

namespace pentaprism {

/// One vector of samples that a micropolygon is asked for: its place in SampleTable::cell(), and its stratum's box.
struct MicroJob {
    std::uint32_t vector;
    std::uint16_t box;
    std::uint16_t lanes;  ///< result: bit i: sample i may hit
};

struct MicropolygonKernels {
    /// For each stratum the box of the micropolygon over that part of the lens and the shutter ("interval" bounds), cut
    /// to the whole box; x0 > x1 where the stratum has no time in the piece's segment.
    void (*strata_boxes)(const Micropolygon& micro, std::span<const Domain> domains, LocalBox* boxes);

    /// Fills `lanes` of each job. Returns how many samples lie in their stratum's box and in the piece's
    /// part of the shutter: those that are tested.
    std::int64_t (*find_lanes)(const LocalTriangle& piece, const SampleVector* samples, const LocalBox* boxes,
                               std::span<MicroJob> jobs);
};

/// Of cpu_isa().
MicropolygonKernels micropolygon_kernels();

}  // namespace pentaprism
