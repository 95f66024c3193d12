#include "cli/step_progress.h"

#include <cstdio>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "cli/interrupt.h"
#include "cli/messages.h"

namespace pentaprism::cli {
namespace {

/// A terminal is looked at, a log is kept.
double seconds_between(ProgressStyle style) {
    return style == ProgressStyle::kTty ? 0.1 : style == ProgressStyle::kNdjson ? 0.5 : 5.0;
}

}  // namespace

StepProgress::StepProgress(const Verbosity& verbosity) : style_(resolve_style(verbosity)) {
    if (style_ == ProgressStyle::kPlain) last_shown_ = start_;  // what is soon over needs no line
}

StepProgress::~StepProgress() {
    if (style_ == ProgressStyle::kTty) set_status_line("");
}

bool StepProgress::show(const std::string& what, double done) {
    const Clock::time_point now = Clock::now();
    const bool due = std::chrono::duration<double>(now - last_shown_).count() >= seconds_between(style_);
    if (style_ != ProgressStyle::kNone && due && what != shown_) {
        last_shown_ = now;
        shown_ = what;
        const double elapsed = std::chrono::duration<double>(now - start_).count();
        const std::string line = one_line(fmt::format("{:3.0f}% {}", 100.0 * done, what));
        if (style_ == ProgressStyle::kTty) {
            set_status_line(line);
        } else {
            const nlohmann::ordered_json event{
                {"event", "progress"}, {"step", what}, {"done", done}, {"elapsed_s", elapsed}};
            const std::string text = (style_ == ProgressStyle::kNdjson
                                          ? event.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace)
                                          : fmt::format("{}, {:.0f} s", line, elapsed)) +
                                     "\n";
            std::fwrite(text.data(), 1, text.size(), stderr);
        }
    }
    return caught_signal() == 0;
}

}  // namespace pentaprism::cli
