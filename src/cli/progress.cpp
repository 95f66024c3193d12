#include "cli/progress.h"

#include <algorithm>
#include <cstdio>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "cli/interrupt.h"
#include "cli/messages.h"
#include "cli/options.h"
#include "cli/values.h"

namespace pentaprism::cli {
namespace {

using Seconds = std::chrono::duration<double>;

/// How often a line may come: a terminal is looked at, a log is kept.
double seconds_between(ProgressStyle style) {
    switch (style) {
        case ProgressStyle::kTty:
            return 0.1;
        case ProgressStyle::kNdjson:
            return 0.5;
        default:
            return 10.0;
    }
}

std::string clock_text(double seconds) {
    const auto whole = static_cast<std::int64_t>(std::clamp(seconds, 0.0, 3.6e8) + 0.5);
    const std::int64_t hours = whole / 3600, minutes = whole / 60 % 60;
    if (hours > 0) return fmt::format("{}:{:02}:{:02}", hours, minutes, whole % 60);
    return fmt::format("{:02}:{:02}", minutes, whole % 60);
}

void print_plain(const std::string& line) {
    const std::string text = one_line(line) + "\n";
    std::fwrite(text.data(), 1, text.size(), stderr);
}

void print_event(const nlohmann::ordered_json& event) {
    print_plain(event.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
}

}  // namespace

void add_verbosity_options(CLI::App& command, Verbosity& verbosity) {
    const std::string group = "Messages";
    add_value(command, group, "--progress", "auto|tty|plain|ndjson|none",
              "On stderr (default auto: tty on a terminal, else plain)", [&](const std::string& text) {
                  verbosity.progress = parse_choice<ProgressStyle>("--progress", text,
                                                                   {{"auto", ProgressStyle::kAuto},
                                                                    {"tty", ProgressStyle::kTty},
                                                                    {"plain", ProgressStyle::kPlain},
                                                                    {"ndjson", ProgressStyle::kNdjson},
                                                                    {"none", ProgressStyle::kNone}});
              });
    add_value(command, group, "--log-level", "error|warning|info|debug", "Messages on stderr (default warning)",
              [](const std::string& text) {
                  set_log_level(parse_choice<LogLevel>("--log-level", text,
                                                       {{"error", LogLevel::kError},
                                                        {"warning", LogLevel::kWarning},
                                                        {"info", LogLevel::kInfo},
                                                        {"debug", LogLevel::kDebug}}));
              });
    command
        .add_flag_callback(
            "-q,--quiet",
            [&] {
                verbosity.quiet = true;
                set_log_level(LogLevel::kError);
            },
            "Errors alone: no warnings and, unless --progress asks for it, no progress")
        ->group(group);
}

ProgressStyle resolve_style(const Verbosity& verbosity) {
    if (verbosity.progress != ProgressStyle::kAuto) return verbosity.progress;
    if (verbosity.quiet) return ProgressStyle::kNone;
    return ::isatty(STDERR_FILENO) ? ProgressStyle::kTty : ProgressStyle::kPlain;
}

Progress part_of(const Progress& progress, int pass, int passes) {
    return [&progress, pass, passes](double done) { return !progress || progress((pass + done) / passes); };
}

ProgressReporter::ProgressReporter(const Verbosity& verbosity, std::size_t frames)
    : style_(resolve_style(verbosity)), frames_(frames) {}

ProgressReporter::~ProgressReporter() {
    if (style_ == ProgressStyle::kTty) set_status_line("");
}

void ProgressReporter::begin_frame(std::int64_t frame) {
    frame_ = frame;
    frame_start_ = Clock::now();
    if (style_ == ProgressStyle::kPlain) last_shown_ = frame_start_;  // a short frame needs no line but its last
    show(0.0);
}

Progress ProgressReporter::callback() {
    return [this](double done) {
        show(done);
        return caught_signal() == 0;
    };
}

double ProgressReporter::elapsed() const {
    return Seconds(Clock::now() - start_).count();
}

double ProgressReporter::seconds_left(double done_of_frame) const {
    const double done = static_cast<double>(finished_) + std::clamp(done_of_frame, 0.0, 1.0);
    const double to_do = static_cast<double>(frames_ - skipped_) - done;
    return done > 0.0 ? elapsed() / done * to_do : -1.0;  // unknown before anything is done
}

void ProgressReporter::show(double done_of_frame) {
    const Clock::time_point now = Clock::now();
    if (style_ == ProgressStyle::kNone || Seconds(now - last_shown_).count() < seconds_between(style_)) return;
    last_shown_ = now;
    const std::size_t place = finished_ + skipped_ + 1;
    const double left = seconds_left(done_of_frame);
    if (style_ == ProgressStyle::kNdjson) {
        nlohmann::ordered_json event{{"event", "progress"}, {"frame", frame_},       {"index", place},
                                     {"frames", frames_},   {"done", done_of_frame}, {"elapsed_s", elapsed()},
                                     {"left_s", nullptr}};
        if (left >= 0.0) event["left_s"] = left;
        print_event(event);
        return;
    }
    const std::string line = fmt::format("frame {} ({} of {}) {:3.0f}%, {}", frame_, place, frames_,
                                         100.0 * done_of_frame, left < 0.0 ? "starting" : clock_text(left) + " left");
    if (style_ == ProgressStyle::kTty) set_status_line(line);
    if (style_ == ProgressStyle::kPlain) print_plain(line);
}

void ProgressReporter::end_frame(const std::string& result) {
    ++finished_;
    const double took = Seconds(Clock::now() - frame_start_).count();
    const double left = seconds_left(0.0);
    if (style_ == ProgressStyle::kNdjson) {
        print_event({{"event", "frame"},
                     {"frame", frame_},
                     {"index", finished_ + skipped_},
                     {"frames", frames_},
                     {"file", result},
                     {"seconds", took},
                     {"elapsed_s", elapsed()},
                     {"left_s", left}});
    } else if (style_ == ProgressStyle::kPlain) {
        const std::string rest = finished_ + skipped_ < frames_ ? ", " + clock_text(left) + " left" : "";
        print_plain(fmt::format("frame {} ({} of {}) {}, {:.2f} s{}", frame_, finished_ + skipped_, frames_, result,
                                took, rest));
    } else if (style_ == ProgressStyle::kTty) {
        show(0.0);
    }
}

void ProgressReporter::skip_frame(std::int64_t frame, const std::string& why) {
    ++skipped_;
    if (style_ == ProgressStyle::kNdjson) {
        print_event(
            {{"event", "skip"}, {"frame", frame}, {"index", finished_ + skipped_}, {"frames", frames_}, {"file", why}});
    } else if (style_ == ProgressStyle::kPlain) {
        print_plain(fmt::format("frame {} ({} of {}) {} exists, skipped", frame, finished_ + skipped_, frames_, why));
    }
}

}  // namespace pentaprism::cli
