// `pentaprism verify SCENE`: every sample of a frame against an independent reference.

#include <fmt/format.h>
#include <memory>
#include <nlohmann/json.hpp>
#include <pentaprism/error.h>
#include <pentaprism/frames.h>
#include <pentaprism/verify.h>

#include "cli/commands.h"
#include "cli/interrupt.h"
#include "cli/messages.h"
#include "cli/options.h"
#include "cli/progress.h"
#include "cli/values.h"

namespace pentaprism::cli {
namespace {

using Json = nlohmann::ordered_json;

// What float32 rounding may do at edges; anything away from an edge is a mistake of ours.
constexpr double kMostWrongPerMillion = 1.0;

struct VerifyCommand {
    std::string scene;
    RenderSettings settings;
    std::int64_t frame = 0;
    int runs = 0;
    bool json = false;
    Verbosity verbosity;
};

Json to_json(const VerifyReport& report) {
    return {{"scene", report.scene},
            {"width", report.width},
            {"height", report.height},
            {"spp", report.spp},
            {"samples", report.samples},
            {"reference", report.reference},
            {"disagreements", report.disagreements},
            {"per_million", report.per_million},
            {"ours_wrong", report.ours_wrong},
            {"away_from_edge", report.away_from_edge},
            {"worst_margin", report.worst_margin},
            {"worst_depth_error", report.worst_depth_error},
            {"brute_force_samples", report.brute_force_samples},
            {"brute_force_disagreements", report.brute_force_disagreements}};
}

Json to_json(const PeerTimes& times) {
    return {{"scene", times.scene},     {"peer", times.peer},         {"width", times.width},
            {"height", times.height},   {"spp", times.spp},           {"threads", times.threads},
            {"runs", times.runs},       {"build_ms", times.build_ms}, {"trace_ms", times.trace_ms},
            {"ours_ms", times.ours_ms}, {"ratio", times.ratio()}};
}

std::string to_text(const VerifyReport& r) {
    std::string text = fmt::format("{}: {}x{}, {} samples per pixel, against {}\n", one_line(r.scene), r.width,
                                   r.height, r.spp, r.reference);
    text += fmt::format("  {:<24} {}\n", "samples", r.samples);
    text += fmt::format("  {:<24} {}\n", "disagreements", r.disagreements);
    text += fmt::format("  {:<24} {} ({:.3f} per million)\n", "of them ours are wrong", r.ours_wrong, r.per_million);
    text += fmt::format("  {:<24} {}\n", "away from every edge", r.away_from_edge);
    text += fmt::format("  {:<24} {:.3g} pixel\n", "farthest from an edge", r.worst_margin);
    text += fmt::format("  {:<24} {:.3g}\n", "worst depth error", r.worst_depth_error);
    if (r.brute_force_samples > 0) {
        text += fmt::format("  {:<24} {} of {} disagree\n", "brute force", r.brute_force_disagreements,
                            r.brute_force_samples);
    }
    return text;
}

std::string to_text(const PeerTimes& t) {
    return fmt::format(
        "  {:<24} {} {:.1f} ms build + {:.1f} ms trace, ours {:.1f} ms: ratio {:.2f} ({} threads, median of {})\n",
        "time", t.peer, t.build_ms, t.trace_ms, t.ours_ms, t.ratio(), t.threads, t.runs);
}

int judge(const VerifyReport& report) {
    const double per_million =
        report.samples > 0 ? 1e6 * static_cast<double>(report.ours_wrong) / static_cast<double>(report.samples) : 0.0;
    if (report.away_from_edge == 0 && per_million <= kMostWrongPerMillion) return 0;
    print_error(fmt::format(
        "{}: {} of {} samples are wrong ({:.3f} per million, at most {} is allowed), {} of them away from "
        "every edge (none is allowed)",
        report.scene, report.ours_wrong, report.samples, per_million, kMostWrongPerMillion, report.away_from_edge));
    return static_cast<int>(ErrorKind::kRender);
}

void refuse_unused(const RenderSettings& settings) {
    const auto refuse = [](const char* why) { throw Error(ErrorKind::kUsage, why); };
    if (settings.image.target_error)
        refuse("--target-error: verify looks at --spp samples of each pixel; leave it out");
    if (settings.image.crop) refuse("--crop: verify looks at whole pictures; leave it out");
    if (settings.method.transparency == Transparency::kABuffer)
        refuse("--transparency a-buffer: verify looks at the one surface that a sample shows; leave it out");
}

int verify(VerifyCommand& command) {
    complete_settings(command.settings);
    refuse_unused(command.settings);
    const Scene scene = load_scene(command.scene);
    for (const std::string& warning : scene.warnings) print_warning(warning);
    throw_if_interrupted();
    const auto frame = static_cast<double>(command.frame);
    VerifyReport report;
    {
        ProgressReporter progress(command.verbosity, 1);
        progress.begin_frame(command.frame);
        report = verify_frame(scene, command.settings, frame, progress.callback());
        throw_if_interrupted();
        progress.end_frame("checked");
    }
    Json json = to_json(report);
    std::string text = to_text(report);
    if (command.runs > 0) {
        const PeerTimes times = time_against_embree(scene, command.settings, frame, command.runs);
        json["peers"] = Json::array({to_json(times)});
        text += to_text(times);
    }
    print_result(command.json ? json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n" : text);
    return judge(report);
}

}  // namespace

void add_verify(CLI::App& program, Run& run) {
    CLI::App* command = program.add_subcommand("verify", "Check every sample against an independent ray tracer");
    const auto state = std::make_shared<VerifyCommand>();
    add_scene_argument(*command, state->scene);
    command->add_flag("--json", state->json, "One JSON document on stdout");
    add_value(
        *command, "Options", "--time", "RUNS", "Time visibility against Embree, too: medians of this many runs",
        [state](const std::string& text) { state->runs = static_cast<int>(parse_whole("--time", text, 1, 1000)); });
    add_value(*command, "Animation", "--frame", "N", "The frame (default 0)",
              [state](const std::string& text) { state->frame = parse_whole("--frame", text, 0, 999'999'999); });
    add_render_options(*command, state->settings);
    add_verbosity_options(*command, state->verbosity);
    command->callback([state, &run] { run = [state] { return verify(*state); }; });
}

}  // namespace pentaprism::cli
