#pragma once
// The inner loops of cover_vectors(), each by itself on work recorded from a frame: for kernel_bench.

#include <cstdint>
#include <memory>

#include "cover/cover.h"

namespace pentaprism::bench {

/// Tiles of a frame, as far as the fast path gets with them without looking at depths: the triangles of each in batches
/// of sixteen, their lists of vectors, those within the edges. Each function goes once through all of it.
class CoverKernels {
  public:
    virtual ~CoverKernels() = default;
    virtual void set_up() = 0;              ///< sixteen triangles at a time: shear, seven half-planes each
    virtual void list() = 0;                ///< boxes of strata and lists of vectors
    virtual void ask_half_planes() = 0;     ///< of the edges
    virtual void start_depths() = 0;        ///< nothing is hit yet; before each test_exactly()
    virtual void test_exactly() = 0;        ///< exact test, depth, opacity, writes
    std::int64_t triangles = 0;             ///< set up: pairs of tile and triangle
    std::int64_t listed = 0, kept = 0;      ///< vectors: listed, of them within the edges
    std::int64_t samples = 0, covered = 0;  ///< of those kept
};

/// Every `stride`th of the tiles that lie wholly in the picture, in the cells' own size. Null where there is no vector
/// code, as with PENTAPRISM_ISA=scalar. Frame, samples and bins must outlive it.
std::unique_ptr<CoverKernels> record_cover_kernels(const Frame& frame, const SampleTable& samples, const Bins& bins,
                                                   int stride);

}  // namespace pentaprism::bench
