#pragma once
// The 5D sample points of a picture: the only place randomness is made. A sample is a pure function of (pixel, index,
// seed); the table holds one period of it, arranged as the vectors that the coverage test reads.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/aligned.h"
#include "base/uninitialized.h"
#include "camera/view.h"
#include "sample/cats_eye.h"
#include "sample/fine_lens.h"
#include "sample/sample_times.h"
#include "sample/sample_vector.h"
#include "sample/shared_triples.h"

namespace pentaprism {

/// One sample. x, y: offset in the pixel from its top left corner, in [0, 1), multiples of 1/256, y down. (u, v): in
/// the unit disk, v up and already times Lens::ratio. t in [0, 1), a multiple of 2^-24.
struct SamplePoint {
    float x = 0, y = 0, u = 0, v = 0, t = 0;
};

/// Which coordinates the samples of one vector share closely: those that blur. kTime groups as kMotion does samples
/// that are those of the other groupings: shadow maps, of which pictures of any blur make use.
enum class Grouping : std::uint8_t { kStill, kMotion, kDefocus, kBoth, kTime };

/// The samples of a cell by their lens position and time, for patterns that share these among pixels.
struct SharedSamples {
    struct Triple {
        float u, v, t;
    };
    int block_side = 1;               ///< K: a triple has one sample in each block of K x K pixels
    int side = 0;                     ///< blocks a side of the cell: 32 / K
    std::span<const Triple> triples;  ///< by time
    /// [(triple * side + row) * side + column]: the sample in block (column, row) of the cell. x, y as in SampleVector;
    /// place: vector * kLanes + lane in cell(). x and y begin on a cache line.
    std::span<const float> x, y;
    std::span<const std::uint32_t> place;
};

/// The samples of a cell pixel by pixel, for pictures in which nothing blurs: [(block * kLanes + lane) * spp + index],
/// block and lane as in SampleVector; x, y as there, each pixel's on cache lines of its own.
struct PixelSamples {
    std::span<const float> x, y;
};

class SampleTable {
  public:
    /// Cost and memory: period^2 * spp * 20 bytes, at most about 90 MB; shared patterns 12 bytes a sample more. These
    /// arrange samples by index, whatever the grouping, and know no rolling shutter, no cat's eye and no other sampler.
    SampleTable(int spp, std::uint32_t seed, const Lens& lens, Grouping grouping,
                SamplePattern pattern = SamplePattern::kFree, SampleTimes times = {}, CatsEye eye = {},
                Sampler sampler = Sampler::kStratified);

    int spp() const { return spp_; }
    std::uint32_t seed() const { return seed_; }
    int slots() const { return spp_; }  ///< vectors of a block
    Grouping grouping() const { return grouping_; }
    SamplePattern pattern() const { return pattern_; }

    /// Index i of a pixel has a time in the i-th of spp() equal intervals of the shutter; but of kMotion, the indices
    /// from a multiple of four on share the four intervals there in an order of the pixel's own.
    bool is_in_order_of_time() const { return in_order_of_time_; }

    /// Blocks are addressed in the whole picture: block (bx, by) covers pixels [4 bx, 4 bx + 4) x [4 by, 4 by + 4).
    /// A rolling shutter and a cat's eye give each place times and lens points of its own: its vectors are written into
    /// `room`, which serves again.
    std::span<const SampleVector> block(int bx, int by, std::vector<SampleVector>& room) const;

    /// The same without these: for x and y.
    std::span<const SampleVector> block(int bx, int by) const;

    /// All vectors of a cell: [block * slots + slot], block = 8 * (row in the cell) + column, the order of Hits. Cells
    /// are addressed in the whole picture: cell (cx, cy) covers pixels [32 cx, 32 cx + 32) x ...
    std::span<const SampleVector> cell(int cx, int cy, std::vector<SampleVector>& room) const;

    /// Sample index (0 .. spp - 1) of each lane of each slot of a block: at [slot * kLanes + lane].
    std::span<const std::uint16_t> indices(int bx, int by) const;

    /// The same of all blocks of a cell, in the order of Hits.
    std::span<const std::uint16_t> indices_of_cell(int cx, int cy) const;

    /// The sample itself, for references and replays: reads the table.
    SamplePoint sample(int px, int py, int index) const;

    /// Slot that holds sample `index` of the pixel. Proportional to their number (SampleOrder finds those of a block).
    int slot_of(int px, int py, int index) const;

    /// Strata of (u, v, t): all samples of a stratum in that cell lie in domains(...)[stratum]. Without a rolling
    /// shutter and a cat's eye wherever they are in the picture.
    std::span<const Domain> domains(int cx, int cy, std::vector<Domain>& room) const;

    /// The vectors of a cell by stratum.
    std::span<const Stratum> strata(int cx, int cy) const;

    /// For wide blur, where the grouping is by lens; else, with a rolling shutter and with a cat's eye, empty.
    const FineLens& fine_lens() const { return fine_lens_; }

    /// Index in fine_lens() of the cell at (cx, cy).
    std::size_t cell_index(int cx, int cy) const;

    /// Of a pattern that is not kFree.
    SharedSamples shared(int cx, int cy) const;

    /// Only for Grouping::kStill, free patterns and 16, 32, ... 256 samples per pixel; else empty. Costs 8 bytes a
    /// sample.
    PixelSamples by_pixel(int cx, int cy) const;

  private:
    bool is_placed() const { return times_.roll() || eye_.on(); }
    void place_block(std::span<SampleVector> vectors, int bx, int by) const;
    void fit_lens(int cx, int cy, std::vector<Domain>& domains) const;
    std::size_t block_index(int bx, int by) const;
    void arrange_by_triple(const SharedTriples& shared);
    void arrange_by_pixel();

    int spp_, period_;
    std::uint32_t seed_;
    Grouping grouping_;
    SamplePattern pattern_;
    bool in_order_of_time_;
    SampleTimes times_;
    CatsEye eye_;
    UninitializedVector<SampleVector> vectors_;   // [cell of the period][block][slot]
    UninitializedVector<std::uint16_t> indices_;  // [block][slot][lane]
    std::vector<Domain> domains_;
    std::vector<std::vector<Stratum>> strata_;  // by cell of the period
    FineLens fine_lens_;
    // Shared patterns: [cell of the period], then as in SharedSamples.
    int block_side_ = 1;
    std::vector<SharedSamples::Triple> triples_;
    AlignedVector<float> shared_x_, shared_y_;
    std::vector<std::uint32_t> shared_places_;
    AlignedVector<float> pixel_x_, pixel_y_;  // [cell of the period], then as in PixelSamples
};

}  // namespace pentaprism
