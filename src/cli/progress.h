#pragma once
// How far the work is, on stderr: over all frames, with the time left.

#include <CLI/App.hpp>
#include <chrono>
#include <cstdint>
#include <pentaprism/render.h>
#include <string>

namespace pentaprism::cli {

enum class ProgressStyle { kAuto, kTty, kPlain, kNdjson, kNone };

/// -q, --log-level and --progress.
struct Verbosity {
    ProgressStyle progress = ProgressStyle::kAuto;
    bool quiet = false;
};
void add_verbosity_options(CLI::App& command, Verbosity& verbosity);

/// What kAuto comes down to: by -q and by what stderr is.
ProgressStyle resolve_style(const Verbosity& verbosity);

/// Part `pass` of `passes` of a frame.
Progress part_of(const Progress& progress, int pass, int passes);

class ProgressReporter {
  public:
    ProgressReporter(const Verbosity& verbosity, std::size_t frames);
    ~ProgressReporter();
    ProgressReporter(const ProgressReporter&) = delete;
    ProgressReporter& operator=(const ProgressReporter&) = delete;

    void begin_frame(std::int64_t frame);
    /// For render_frame() and its like; says stop after a signal.
    Progress callback();
    void end_frame(const std::string& result);
    /// A frame that needs no work does not count for the time left.
    void skip_frame(std::int64_t frame, const std::string& why);

  private:
    using Clock = std::chrono::steady_clock;
    void show(double done_of_frame);
    double elapsed() const;
    double seconds_left(double done_of_frame) const;

    ProgressStyle style_;
    std::size_t frames_, finished_ = 0, skipped_ = 0;
    std::int64_t frame_ = 0;
    Clock::time_point start_ = Clock::now(), frame_start_ = start_, last_shown_{};
};

}  // namespace pentaprism::cli
