#pragma once
// Patterns in which many pixels share one lens position and time, as older methods have it: N triples (u, v, t) serve
// the whole picture, and a triangle stands still for each of them.
//
// kAccumulation: the accumulation buffer (Haeberli & Akeley 1990). N = spp passes; sample `index` of every pixel has
// triple `index`. kInterleaved: InterleaveUVT (Fatahalian, Luong, Boulos, Akeley, Mark, Hanrahan 2009). The pixels of a
// block of K x K share N = K * K * spp triples, each of which belongs to one sample of the block. K is the smallest
// power of two, at least 2, that makes N at least 64: N is 64 for 1, 4 and 16 samples a pixel, as in the paper, and 4 *
// spp above that. Unlike theirs, our blocks differ: which pixel takes which triples is permuted for each row and column
// of blocks. (x, y) are each pixel's own in both; a pass of the accumulation buffer usually has one (x, y) for all.

#include <cstdint>
#include <vector>

namespace pentaprism {

enum class SamplePattern : std::uint8_t {
    kFree,  ///< each pixel has its own lens positions and times
    kAccumulation,
    kInterleaved
};

/// A triple before the map to the lens: u, v are 32-bit fractions of the unit square; t lies in interval `stratum_t` of
/// N, jitter_t / 2^24 of the way.
struct RawTriple {
    std::uint32_t u, v, stratum_t, jitter_t;
};

class SharedTriples {
  public:
    /// `pattern` is not kFree; spp from 1 to 4096.
    SharedTriples(SamplePattern pattern, int spp, std::uint32_t seed);

    /// N.
    int count() const { return count_; }
    /// K: in each aligned block of K x K pixels, every triple belongs to exactly one sample.
    int block_side() const { return side_; }
    /// Triples are numbered by time: number i has a time in [i / N, (i + 1) / N).
    RawTriple triple(int number) const;
    /// Of sample `index` of pixel (px, py). One sample of a pixel in each interval of 1 / spp of the shutter.
    int triple_of(int px, int py, int index) const;

  private:
    int side_, count_;
    std::uint32_t seed_;
};

}  // namespace pentaprism
