#pragma once
// The samples of one block of pixels in index order, pixel by pixel: the order of what is kept or summed sample by
// sample, so that it does not depend on how the sample table arranges its vectors.

#include <cstdint>
#include <vector>

#include "sample/sample_table.h"

namespace pentaprism {

class SampleOrder {
  public:
    /// Block (bx, by) of the picture. Reuses its memory.
    void read(const SampleTable& table, int bx, int by) {
        spp_ = table.spp();
        slots_.resize(static_cast<std::size_t>(kLanes) * spp_);
        const auto indices = table.indices(bx, by);
        for (int slot = 0; slot < spp_; ++slot)
            for (int lane = 0; lane < kLanes; ++lane)
                slots_[lane * spp_ + indices[slot * kLanes + lane]] = static_cast<std::uint16_t>(slot);
    }
    /// Slot of sample `index` of the pixel in `lane`.
    const std::uint16_t* slots(int lane) const { return &slots_[static_cast<std::size_t>(lane) * spp_]; }

  private:
    int spp_ = 0;
    std::vector<std::uint16_t> slots_;
};

}  // namespace pentaprism
