#pragma once
// What lets light through in front of what a tile's samples see at last: an A-buffer with a list for each sample
// (Carpenter 1984, The A-buffer; a sample instead of a mask of them, since only at one place of lens and shutter have
// surfaces one order). Lists are short, so that memory is bounded: what does not fit is taken by further passes over
// the triangles, each from where the last one ended (depth peeling of several layers at once, after Everitt 2001 and
// Bavoil, Callahan, Lefohn, Comba, Silva 2007), until nothing is left. Nothing is merged or left out.

#include <cstdint>
#include <span>
#include <vector>

#include "cover/cover.h"

namespace pentaprism {

/// One surface at one sample.
struct Fragment {
    float depth;             ///< as Hits::depth
    std::uint32_t triangle;  ///< decides between equal depths: the lower is nearer
    float opacity;           ///< opacity_at(), above 0, at most 1
};

/// Keeps its memory between tiles; one for each thread.
class Layers {
  public:
    /// `most`: fragments of a sample in one pass, at least 1. By default 8, less where that would take over 64 MB.
    explicit Layers(int most = 0) : wanted_(most) {}

    /// Forgets everything; for that many samples.
    void reset(std::size_t samples);

    /// Before another pass: lists go on behind their last fragment. False: nothing was left out.
    bool next_pass();

    /// Of a sample (its entry in Hits), nearest first. Samples outside the tile have none.
    std::span<const Fragment> fragments(std::size_t sample) const {
        return {&fragments_[sample * most_], count_[sample]};
    }

    /// Takes what is behind the last pass, if it is among the nearest.
    void add(std::size_t sample, const Fragment& fragment);

  private:
    int wanted_;
    std::size_t most_ = 0;
    std::vector<Fragment> fragments_;  // [sample][most_]
    std::vector<std::uint8_t> count_, left_out_;
    std::vector<Fragment> ended_;  // of each sample, the last fragment of the pass before
};

/// One pass over `work.list`, triangles that are see-through, for what is in front of `behind`: what the samples see of
/// all others.
void cover_layers(const TileWork& work, const Culling& culling, const Hits& behind, Layers& layers,
                  CoverCounts& counts);

}  // namespace pentaprism
