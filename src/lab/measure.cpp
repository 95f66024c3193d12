// Counting and timing are apart: one run of each method counts and compares every hit with that of `none`; then all
// methods are timed in turn, round after round, so that what else the machine does hits them alike, and medians count.

#include "lab/measure.h"

#include <algorithm>
#include <map>
#include <optional>

#include "cull/cull_choice.h"
#include "lab/machine.h"

namespace pentaprism {
namespace {

double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    const std::size_t n = values.size();
    return n % 2 ? values[n / 2] : 0.5 * (values[n / 2 - 1] + values[n / 2]);
}

bool has_own_samples(const MethodSettings& settings) {
    return settings.visibility == VisibilityMethod::kAccumulation ||
           settings.visibility == VisibilityMethod::kInterleaved;
}

BenchRow counted_row(FrameWalk& walk, const std::string& method) {
    reset_peak_memory();
    const FrameWalk::Counts counts = walk.count(method, nullptr);
    BenchRow row;
    row.method = method;
    if (!counts.gl_pipeline.empty()) row.backend = "gl-" + counts.gl_pipeline;
    const MethodSettings settings = settings_of(method, {});
    row.conservative = settings.culling == "auto" || is_conservative(parse_culling(settings.culling));
    row.own_arithmetic = has_own_arithmetic(method);
    row.own_samples = has_own_samples(settings);
    row.samples = walk.samples();
    row.tested = counts.cover.tested;
    row.covered = counts.cover.covered;
    row.footprints = counts.cover.footprints;
    row.kept_footprints = counts.cover.kept_footprints;
    row.asked = counts.cover.asked;
    row.false_culls = counts.lost;
    row.frame_ms = counts.frame_ms;
    row.peak_mb = static_cast<double>(peak_memory() - walk.reference_bytes()) / (1024.0 * 1024.0);
    return row;
}

struct Times {
    std::vector<double> frame, setup;
};

// Methods that share samples share a walk and its reference.
class Walks {
  public:
    Walks(const PosedPicture& picture, const MeasureOptions& options, const KeepGoing& keep_going)
        : picture_(picture), options_(options), keep_going_(keep_going) {}

    FrameWalk& of(const std::string& method) {
        const MethodSettings settings = settings_of(method, options_.method);
        const bool shared = has_own_samples(settings);
        Entry& entry = entries_[shared ? settings.visibility : VisibilityMethod::kStochastic];
        if (entry.walk) return *entry.walk;
        if (shared) entry.samples.emplace(make_samples(picture_.frame, picture_.samples.spp(), settings));
        // A graphics card renders whole pictures: some tiles of one would be timed wrongly.
        const std::int64_t most_tests = options_.method.backend == Backend::kCpu ? options_.most_tests : 0;
        entry.walk = std::make_unique<FrameWalk>(picture_.frame, shared ? *entry.samples : picture_.samples,
                                                 options_.method, most_tests, keep_going_);
        entry.walk->make_reference();
        return *entry.walk;
    }

  private:
    struct Entry {
        std::optional<SampleTable> samples;
        std::unique_ptr<FrameWalk> walk;
    };
    const PosedPicture& picture_;
    const MeasureOptions& options_;
    const KeepGoing& keep_going_;
    std::map<VisibilityMethod, Entry> entries_;
};

}  // namespace

Measurements measure_methods(const PosedPicture& picture, const MeasureOptions& options, const KeepGoing& keep_going) {
    Walks walks(picture, options, keep_going);
    Measurements result;
    result.cell = walks.of("none").describe();
    std::vector<BenchRow>& rows = result.rows;
    for (const std::string& method : options.methods) {
        FrameWalk& walk = walks.of(method);
        rows.push_back(counted_row(walk, method));
        // A frame and its questions make one round, and the counting run has told how long a frame takes.
        const double round_ms = std::max(1e-3, 2.0 * rows.back().frame_ms * walk.share());
        rows.back().runs = static_cast<int>(std::clamp(1000.0 * options.seconds / round_ms, 1.0, 1.0 * options.runs));
    }
    std::vector<Times> times(rows.size());
    for (int round = 0; round < options.runs; ++round)
        for (std::size_t k = 0; k < rows.size(); ++k) {
            const std::size_t i = (k + static_cast<std::size_t>(round)) % rows.size();  // nobody is always the first
            if (round >= rows[i].runs) continue;
            FrameWalk& walk = walks.of(rows[i].method);
            times[i].frame.push_back(walk.time_frame(rows[i].method).ms);
            times[i].setup.push_back(walk.time_setup(rows[i].method).ms);
        }
    for (std::size_t i = 0; i < rows.size(); ++i) {
        rows[i].frame_ms = median(times[i].frame);
        rows[i].setup_ms = std::min(rows[i].frame_ms, median(times[i].setup));
        rows[i].test_ms = rows[i].frame_ms - rows[i].setup_ms;
    }
    return result;
}

}  // namespace pentaprism
