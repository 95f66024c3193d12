// Visibility alone against Embree in the best configuration found for the frame at hand: which is looked for on a part
// of its tiles, one choice after the other (how rays are handed over, geometry, hierarchy, its build). Both sides leave
// triangle and depth of every sample in one tile's buffer.

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

std::string describe(const EmbreeOptions& options) {
    std::string text = embree_version();
    if (!options.device.empty()) text += " " + options.device;
    constexpr const char* kRays[] = {"packets of 16", "packets of 8",   "packets of 4",
                                     "single rays",   "stream of rays", "stream of packets of 16"};
    text += std::string(" ") + kRays[static_cast<int>(options.rays)];
    if (options.build == EmbreeBuild::kLow) text += ", fast build";
    if (options.build == EmbreeBuild::kHigh) text += ", best build";
    if (!options.coherent) text += ", incoherent";
    if (options.layout == EmbreeLayout::kTogether) text += ", still and moving together";
    if (options.layout == EmbreeLayout::kParts) text += ", a geometry for each part";
    if (options.robust_speed) text += ", robust";
    return text;
}

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
    EmbreeTimes run_embree(const EmbreeOptions& options, std::size_t every_tile = 1) {
        EmbreeTimes times;
        std::unique_ptr<EmbreeTracer> embree;
        times.build_ms =
            milliseconds([&] { embree = std::make_unique<EmbreeTracer>(picture_.frame, picture_.samples, options); });
        times.trace_ms = trace(*embree, every_tile);
        return times;
    }

    /// After run_ours(). `tried`: each configuration that was timed.
    EmbreeOptions best_options(std::vector<PeerTrial>& tried) {
        const Frame& frame = picture_.frame;
        const bool moves = std::any_of(frame.parts.begin(), frame.parts.end(), [](const Part& p) { return p.moves; });
        const bool rests = std::any_of(frame.parts.begin(), frame.parts.end(), [](const Part& p) { return !p.moves; });
        EmbreeOptions best;
        best.for_speed = true;
        double least = trial(best, tried);
        // The best of `choices` in one respect, the others as found best so far.
        const auto choose = [&](auto EmbreeOptions::*what, auto choices) {
            for (const auto& choice : choices) {
                if (choice == best.*what) continue;
                EmbreeOptions options = best;
                options.*what = choice;
                const double sum = trial(options, tried);
                if (sum >= kBetter * least) continue;
                least = sum;
                best = options;
            }
        };
        using Devices = std::vector<std::string>;
        choose(&EmbreeOptions::device, moves
                                           ? Devices{"tri_accel_mb=bvh8.triangle4vmb", "tri_accel_mb=bvh8.triangle4imb",
                                                     "tri_accel_mb=bvh4.triangle4vmb", "tri_accel_mb=bvh4.triangle4imb"}
                                           : Devices{"tri_accel=bvh8.triangle4", "tri_accel=bvh8.triangle4v",
                                                     "tri_accel=bvh4.triangle4", "tri_accel=bvh4.triangle4v"});
        choose(&EmbreeOptions::build, std::vector{EmbreeBuild::kLow, EmbreeBuild::kHigh});
        choose(&EmbreeOptions::rays, std::vector{EmbreeRays::kPacket8, EmbreeRays::kPacket4, EmbreeRays::kSingle,
                                                 EmbreeRays::kStream, EmbreeRays::kPacketStream16});
        choose(&EmbreeOptions::coherent, std::vector{false});
        choose(&EmbreeOptions::layout, moves && rests ? std::vector{EmbreeLayout::kTogether, EmbreeLayout::kParts}
                                                      : std::vector{EmbreeLayout::kParts});
        return best;
    }

    /// Build and trace of the whole frame, the trace judged by a part of the tiles.
    double trial(const EmbreeOptions& options, std::vector<PeerTrial>& tried) {
        EmbreeTimes least{std::numeric_limits<double>::infinity(), 0.0};
        for (int run = 0; run < 2; ++run) {
            const EmbreeTimes times = run_embree(options, kTrialTiles);
            if (times.sum() < least.sum()) least = times;
        }
        tried.push_back({describe(options), least.build_ms, least.trace_ms});
        return least.sum();
    }

    /// Its hierarchy of this very frame refitted instead of built: the least that a renderer of sequences may hope for.
    EmbreeTimes run_refit(EmbreeOptions options) {
        options.dynamic = true;
        EmbreeTracer embree(picture_.frame, picture_.samples, options);
        embree.refit();
        EmbreeTimes times;
        times.build_ms = milliseconds([&] { embree.refit(); });
        times.trace_ms = trace(embree, kTrialTiles);
        return times;
    }

  private:
    // Of the whole frame, from every n-th tile.
    double trace(const EmbreeTracer& embree, std::size_t every_tile) const {
        std::vector<Tile> tiles;
        for (std::size_t i = every_tile / 2; i < tiles_.size(); i += every_tile) tiles.push_back(tiles_[i]);
        const double ms = milliseconds([&] {
            trace_picture(tiles, [&](const Tile& tile, Hits& hits) {
                hits.reset(picture_.samples.slots(), tile);
                embree.trace(tile, hits);
            });
        });
        return ms * static_cast<double>(tiles_.size()) / static_cast<double>(std::max<std::size_t>(1, tiles.size()));
    }

    // Odd, so that the tiles do not stand in columns.
    static constexpr std::size_t kTrialTiles = 11;
    static constexpr double kBetter = 0.98;  // less is chance

    const PosedPicture& picture_;
    MethodSettings method_;
    std::vector<Tile> tiles_;
};

}  // namespace

PeerTimes time_against_embree(const Scene& scene, const RenderSettings& settings, double frame, int runs,
                              bool every_trial) {
    set_thread_count(settings.method.threads);
    const PosedPicture picture = pose_picture(scene, settings, frame);
    Contest contest(picture, settings.method);
    contest.run_ours();  // warms up
    PeerTimes times;
    const EmbreeOptions options = contest.best_options(times.trials);
    if (every_trial) {
        EmbreeOptions robust = options;
        robust.robust_speed = true;
        contest.trial(robust, times.trials);
        const EmbreeTimes refitted = contest.run_refit(options);
        times.trials.push_back({describe(options) + ", refitted", refitted.build_ms, refitted.trace_ms});
    }

    std::vector<double> ours, build, trace;
    for (int run = 0; run < std::max(1, runs); ++run) {
        ours.push_back(contest.run_ours());
        const EmbreeTimes times = contest.run_embree(options);
        build.push_back(times.build_ms);
        trace.push_back(times.trace_ms);
    }
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

PeerTimes time_against_embree(const Scene&, const RenderSettings&, double, int, bool) {
    throw Error(ErrorKind::kBackend, "this build has no Embree to time against; install libembree-dev and build again");
}

#endif

}  // namespace pentaprism
