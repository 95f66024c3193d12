#pragma once
// How far a plan of named steps is, on stderr: for commands that are not a sequence of frames.

#include <chrono>
#include <string>

#include "cli/progress.h"

namespace pentaprism::cli {

class StepProgress {
  public:
    explicit StepProgress(const Verbosity& verbosity);
    ~StepProgress();
    StepProgress(const StepProgress&) = delete;
    StepProgress& operator=(const StepProgress&) = delete;

    /// `what` is going on, and `done` (0 to 1) of the whole plan is done. False after a signal: stop.
    bool show(const std::string& what, double done);

  private:
    using Clock = std::chrono::steady_clock;
    ProgressStyle style_;
    std::string shown_;
    Clock::time_point start_ = Clock::now(), last_shown_{};
};

}  // namespace pentaprism::cli
