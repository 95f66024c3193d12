#pragma once
// Two ways to find the visible triangle of every sample, compared sample by sample, and every difference judged.

#include <functional>
#include <pentaprism/verify.h>

#include "cover/hits.h"
#include "peer/judge.h"

namespace pentaprism {

/// Fills the hits of one tile (reset already). Thread-safe.
using TileTracer = std::function<void(const Tile& tile, Hits& hits)>;

struct CompareOptions {
    int tile_size = 32;
    std::int64_t brute_force_samples =
        20000;  ///< about so many samples, spread by a hash, meet every triangle in double
    std::function<void(const Verdict&)> on_disagreement;  ///< called for each one, in order of tiles
};

/// Traces the whole picture with `ours` and, if it is not empty, with `reference`. Fills the numbers of the report;
/// `scene` and `reference` are the caller's. Throws Error(kRender) "interrupted" when `progress` returns false.
VerifyReport compare_tracers(const Frame& frame, const SampleTable& table, const TileTracer& ours,
                             const TileTracer& reference, const CompareOptions& options, const Progress& progress = {});

}  // namespace pentaprism
