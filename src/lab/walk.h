#pragma once
// One posed frame, and every method's way over its tiles: counted, compared, timed.

#include <functional>
#include <memory>
#include <pentaprism/bench.h>

#include "base/pool.h"
#include "render/visibility.h"

namespace pentaprism {

/// Called with what is going on; false stops the work with Error(kRender) "interrupted".
using KeepGoing = std::function<bool(const std::string& what)>;

/// What happened to a method where. `lost`: samples of each pixel whose hit is not that of the reference.
struct MethodMap {
    std::string method;
    CoverMap cover;
    std::vector<std::uint32_t> lost;
};

/// The settings of a method of the laboratory: a value of `--culling` or of `--visibility`. Throws Error(kUsage) for
/// what is neither.
MethodSettings settings_of(const std::string& method, MethodSettings settings);

/// Decides coverage and depth by other arithmetic than the exact test, so that depths differ in their last bits.
bool has_own_arithmetic(const std::string& method);

class FrameWalk {
  public:
    /// Frame and samples must outlive the walk, and the methods it is asked for must be ones that take such samples
    /// (render/visibility.h, make_samples). Of a picture on which the triangles' boxes hold more than
    /// `most_tests` samples, only as many tiles are walked as hold about so many, spread evenly; 0: no limit.
    FrameWalk(const Frame& frame, const SampleTable& samples, const MethodSettings& settings, std::int64_t most_tests,
              KeepGoing keep_going);

    /// Part of the picture's tiles that is walked.
    double share() const { return share_; }

    /// Samples of the tiles that are walked.
    std::int64_t samples() const;

    /// Keeps the hits of `none`, found by the processor. Before count().
    void make_reference();
    std::int64_t reference_bytes() const;

    struct Counts {
        CoverCounts cover;
        std::int64_t lost = 0;  ///< samples that differ from the reference: any bit of triangle or depth, or,
                                ///< where the arithmetic is another, the triangle
        double frame_ms = 0.0;
        std::string gl_pipeline;  ///< as Visibility's
    };
    /// `map`, of the whole picture, may be null.
    Counts count(const std::string& method, MethodMap* map);

    struct Timed {
        double ms = 0.0;  ///< of a whole frame: bounds and bins, and the tiles' time over share()
        CoverCounts cover;
    };
    Timed time_frame(const std::string& method);

    /// The same of all that comes before exact tests (BenchRow::setup_ms): nothing is tested. Of another backend than
    /// the processor, the upload alone.
    Timed time_setup(const std::string& method);

    /// Motion, blur and coverage of the whole picture.
    BenchCell describe();

  private:
    using TileWorkBody = std::function<void(std::size_t i, Hits& hits)>;
    Visibility visibility_of(const std::string& method) const;
    Visibility processors_own(const std::string& method) const;  // whatever the backend that is measured
    void choose_tiles(std::int64_t most_tests);
    double for_each_tile(const std::string& what, const TileWorkBody& body);

    const Frame& frame_;
    const SampleTable& samples_;
    MethodSettings settings_;
    KeepGoing keep_going_;
    double share_ = 1.0;
    std::vector<Tile> tiles_;
    std::vector<Hits> reference_;
    Pool<Hits> buffers_;
};

}  // namespace pentaprism
