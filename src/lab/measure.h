#pragma once
// One posed frame, every method in turn: what each counted, lost and took.

#include <functional>
#include <pentaprism/bench.h>

#include "peer/posed_picture.h"
#include "render/visibility.h"

namespace pentaprism {

/// The hits of a whole picture, tile by tile: what other methods' hits are compared with.
class ReferenceHits {
  public:
    ReferenceHits(std::size_t tiles) : tiles_(tiles) {}
    Hits& tile(std::size_t i) { return tiles_[i]; }
    const Hits& tile(std::size_t i) const { return tiles_[i]; }
    std::int64_t bytes() const;

  private:
    std::vector<Hits> tiles_;
};

/// Called with what is going on; false stops with Error(kRender) "interrupted".
using KeepGoing = std::function<bool(const std::string& what)>;

struct MeasureOptions {
    std::vector<std::string> methods;
    MethodSettings method;  ///< its `culling` is set for each method
    int runs = 5;
    double seconds = 4.0;
};

/// Fills everything of the rows but scene and effect. Rows come in the order of `methods`.
std::vector<BenchRow> measure_methods(const PosedPicture& picture, const MeasureOptions& options, BenchCell& cell,
                                      const KeepGoing& keep_going);

}  // namespace pentaprism
