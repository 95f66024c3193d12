// Visibility alone against Embree in the best configuration found for the frame at hand: packets of 16 rays over blocks
// of 4x4 pixels, rays alike in lens position and time together, still geometry apart from moving geometry, the
// hierarchy with the lowest sum of build and trace. Both sides leave triangle and depth of every sample in one tile's
// buffer.

#include <algorithm>
#include <ctime>
#include <functional>
#include <limits>
#include <pentaprism/error.h>
#include <pentaprism/verify.h>

#include "base/parallel.h"
#include "peer/posed_picture.h"
#include "render/visibility.h"

#ifdef PENTAPRISM_HAVE_EMBREE
#include "trace/embree_tracer.h"
#endif

namespace pentaprism {

#ifdef PENTAPRISM_HAVE_EMBREE
namespace {

// On one thread the processor's time counts, so that other programs on the machine do not; on several the clock's.
double milliseconds(const std::function<void()>& work) {
    const auto now = [] {
        timespec time{};
        clock_gettime(thread_count() == 1 ? CLOCK_PROCESS_CPUTIME_ID : CLOCK_MONOTONIC, &time);
        return 1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec);
    };
    const double start = now();
    work();
    return now() - start;
}

double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    const std::size_t n = values.size();
    return n % 2 ? values[n / 2] : 0.5 * (values[n / 2 - 1] + values[n / 2]);
}

/// Calls trace(tile, hits) for all tiles from all threads; a buffer is used again and again, as the renderer does.
template <class Trace>
void trace_picture(const std::vector<Tile>& tiles, Trace trace) {
    parallel_for(tiles.size(), [&](std::size_t i) {
        thread_local Hits hits;
        trace(tiles[i], hits);
    });
}

struct EmbreeTimes {
    double build_ms = 0.0, trace_ms = 0.0;
    double sum() const { return build_ms + trace_ms; }
};

class Contest {
  public:
    explicit Contest(const PosedPicture& picture, const MethodSettings& method) : picture_(picture), method_(method) {}

    double run_ours() {
        return milliseconds([&] {
            const View& view = picture_.frame.view;
            const Visibility visibility(picture_.frame, picture_.samples, method_, {0, view.width, 0, view.height});
            tiles_ = visibility.tiles();
            trace_picture(tiles_, [&](const Tile& tile, Hits& hits) {
                CoverCounts counts;
                visibility.cover(tile, hits, counts);
            });
        });
    }

    /// After run_ours(), which says what the tiles are.
    EmbreeTimes run_embree(const EmbreeOptions& options) {
        EmbreeTimes times;
        std::unique_ptr<EmbreeTracer> embree;
        times.build_ms =
            milliseconds([&] { embree = std::make_unique<EmbreeTracer>(picture_.frame, picture_.samples, options); });
        times.trace_ms = milliseconds([&] {
            trace_picture(tiles_, [&](const Tile& tile, Hits& hits) {
                hits.reset(picture_.samples.slots());
                embree->trace(tile, hits);
            });
        });
        return times;
    }

    EmbreeOptions best_options() {
        const Frame& frame = picture_.frame;
        const bool moves = std::any_of(frame.parts.begin(), frame.parts.end(), [](const Part& p) { return p.moves; });
        EmbreeOptions best;
        double least = std::numeric_limits<double>::infinity();
        for (const char* device : {"", "tri_accel_mb=bvh8.triangle4vmb"}) {
            if (*device && !moves) continue;
            for (const bool fast_build : {false, true}) {
                EmbreeOptions options;
                options.for_speed = true;
                options.fast_build = fast_build;
                options.device = device;
                const double sum = run_embree(options).sum();
                if (sum < least) {
                    least = sum;
                    best = options;
                }
            }
        }
        return best;
    }

  private:
    const PosedPicture& picture_;
    MethodSettings method_;
    std::vector<Tile> tiles_;
};

std::string describe(const EmbreeOptions& options) {
    return embree_version() + (options.device.empty() ? "" : " " + options.device) +
           (options.fast_build ? " fast build" : "");
}

}  // namespace

PeerTimes time_against_embree(const Scene& scene, const RenderSettings& settings, double frame, int runs) {
    set_thread_count(settings.method.threads);
    const PosedPicture picture = pose_picture(scene, settings, frame);
    Contest contest(picture, settings.method);
    contest.run_ours();  // warms up
    const EmbreeOptions options = contest.best_options();

    std::vector<double> ours, build, trace;
    for (int run = 0; run < std::max(1, runs); ++run) {
        ours.push_back(contest.run_ours());
        const EmbreeTimes times = contest.run_embree(options);
        build.push_back(times.build_ms);
        trace.push_back(times.trace_ms);
    }
    PeerTimes times;
    times.scene = scene.name;
    times.peer = describe(options);
    times.width = picture.frame.view.width;
    times.height = picture.frame.view.height;
    times.spp = picture.samples.spp();
    times.threads = thread_count();
    times.runs = static_cast<int>(ours.size());
    times.build_ms = median(build);
    times.trace_ms = median(trace);
    times.ours_ms = median(ours);
    return times;
}

#else

PeerTimes time_against_embree(const Scene&, const RenderSettings&, double, int) {
    throw Error(ErrorKind::kBackend, "this build has no Embree to time against; install libembree-dev and build again");
}

#endif

}  // namespace pentaprism
