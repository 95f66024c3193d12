// `pentaprism bench [SCENE...]`: the laboratory: every culling test on scenes, side by side.

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fmt/format.h>
#include <limits>
#include <memory>
#include <pentaprism/bench.h>
#include <pentaprism/error.h>
#include <pentaprism/image.h>
#include <tuple>

#include "cli/commands.h"
#include "cli/interrupt.h"
#include "cli/messages.h"
#include "cli/options.h"
#include "cli/step_progress.h"
#include "cli/values.h"

namespace pentaprism::cli {
namespace {

namespace fs = std::filesystem;

struct BenchCommand {
    std::vector<std::string> scenes, effects, methods;
    bool quick = false, json = false, embree = false;
    std::optional<std::pair<int, int>> resolution;
    std::optional<std::int64_t> spp, frame, seed, threads, runs, tests;
    std::optional<double> seconds, fps;
    Backend backend = Backend::kCpu;
    GlPipeline gl_pipeline = GlPipeline::kAuto;
    fs::path folder;
    Verbosity verbosity;
};

std::vector<std::string> split(const std::string& option, const std::string& text) {
    std::vector<std::string> names;
    for (std::size_t start = 0; start <= text.size();) {
        const std::size_t end = std::min(text.find(',', start), text.size());
        if (end == start) throw Error(ErrorKind::kUsage, fmt::format("{}: '{}' has an empty name", option, text));
        names.push_back(text.substr(start, end - start));
        start = end + 1;
    }
    return names;
}

/// The library speaks of --culling, of which most methods are values.
void check_methods(const std::vector<std::string>& methods) {
    const std::vector<std::string> known = bench_methods();
    for (const std::string& method : methods) {
        if (std::find(known.begin(), known.end(), method) != known.end()) continue;
        try {
            check_culling(method);
        } catch (const Error& error) {
            const std::string said = error.what(), option = "--culling";
            throw Error(error.kind(), said.rfind(option, 0) == 0 ? "--methods" + said.substr(option.size()) : said);
        }
    }
}

BenchPlan plan_of(const BenchCommand& command) {
    BenchPlan plan = command.quick ? quick_bench_plan() : full_bench_plan();
    RenderSettings& settings = plan.settings;
    if (!command.scenes.empty()) plan.scenes = command.scenes;
    plan.effects = command.effects;
    plan.methods = command.methods;
    if (command.resolution) std::tie(settings.image.width, settings.image.height) = *command.resolution;
    if (command.spp) settings.image.spp = static_cast<int>(*command.spp);
    if (command.frame) plan.frame = static_cast<double>(*command.frame);
    if (command.fps) settings.animation.fps = *command.fps;
    if (command.seed) settings.method.seed = static_cast<std::uint32_t>(*command.seed);
    if (command.threads) settings.method.threads = static_cast<int>(*command.threads);
    settings.method.backend = command.backend;
    settings.method.gl_pipeline = command.gl_pipeline;
    if (command.runs) plan.runs = static_cast<int>(*command.runs);
    if (command.tests) plan.most_tests = *command.tests;
    if (command.seconds) plan.seconds = *command.seconds;
    plan.images = !command.folder.empty();
    check_methods(plan.methods);
    complete_settings(settings);
    if (command.embree) {
        plan.peer_threads = {1};
        if (settings.method.threads != 1) plan.peer_threads.push_back(settings.method.threads);
    }
    return plan;
}

/// A folder that cannot be made or written to is said before an hour of measuring.
void prepare_folder(const fs::path& folder) {
    std::error_code error;
    fs::create_directories(folder, error);
    if (error || !fs::is_directory(folder))
        throw Error(ErrorKind::kOutput, fmt::format("--report {}: cannot make this folder ({})", folder.string(),
                                                    error ? error.message() : "a file has its name"));
    write_text_file(folder / ".pentaprism", "");
    fs::remove(folder / ".pentaprism", error);
}

void write_report(const fs::path& folder, const BenchReport& report) {
    write_text_file(folder / "bench.json", bench_json(report));
    write_text_file(folder / "bench.csv", bench_csv(report));
    write_text_file(folder / "bench.tex", bench_latex(report));
    write_text_file(folder / "index.html", bench_html(report));
}

int bench(const BenchCommand& command) {
    const BenchPlan plan = plan_of(command);
    if (!command.folder.empty()) prepare_folder(command.folder);
    BenchReport report;
    {
        StepProgress progress(command.verbosity);
        report = run_bench(plan, [&](const BenchStep& step) { return progress.show(step.what, step.done); });
    }
    throw_if_interrupted();
    if (!command.folder.empty()) write_report(command.folder, report);
    print_result(command.json ? bench_json(report) : bench_table(report));
    if (!command.json && !command.folder.empty())
        print_result(fmt::format("\nthe report is {}\n", (command.folder / "index.html").string()));
    return 0;
}

void add_what(CLI::App& command, BenchCommand& bench) {
    const std::string group = "What is measured";
    command.add_option("SCENE", bench.scenes, "Scenes (default: the built-in ones that the literature measured)")
        ->type_name("");
    command.add_flag("--quick", bench.quick, "Two scenes at 160x120, 4 samples per pixel: under a minute")
        ->group(group);
    std::string effects, methods;
    for (const BenchEffect& effect : bench_effects()) effects += (effects.empty() ? "" : ", ") + effect.name;
    for (const std::string& method : bench_methods()) methods += (methods.empty() ? "" : ", ") + method;
    add_value(command, group, "--effects", "LIST",
              "Amounts of blur, with commas; also by other factors, such as both-x8 (default all): " + effects,
              [&](const std::string& text) { bench.effects = split("--effects", text); });
    add_value(
        command, group, "--methods", "LIST",
        "Values of render --culling or --visibility, and combinations, with commas (default all but micropolygon): " +
            methods,
        [&](const std::string& text) { bench.methods = split("--methods", text); });
    add_value(command, group, "--backend", "cpu|gl",
              "What is measured: the processor, or OpenGL, compared with the processor's hits (default cpu)",
              [&](const std::string& text) { bench.backend = parse_backend(text); });
    add_value(command, group, "--gl-pipeline", "auto|geometry|compute",
              "How --backend gl does it: the papers' geometry shader, or tiles in compute shaders (default auto)",
              [&](const std::string& text) { bench.gl_pipeline = parse_gl_pipeline(text); });
    add_value(command, group, "--peer", "embree", "Time visibility against this ray tracer, too",
              [&](const std::string& text) {
                  bench.embree = parse_choice<bool>("--peer", text, {{"embree", true}});
              });
    add_value(command, group, "-r,--resolution", "WxH", "Size in pixels (default 1024x768; --quick 160x120)",
              [&](const std::string& text) { bench.resolution = parse_size("--resolution", text); });
    add_value(command, group, "-s,--spp", "N", "Samples per pixel, 1 to 4096 (default 16; --quick 4)",
              [&](const std::string& text) { bench.spp = parse_whole("--spp", text, 1, 4096); });
    add_value(command, group, "--frame", "N", "The frame (default 24 of a built-in scene, 0 of a file)",
              [&](const std::string& text) { bench.frame = parse_whole("--frame", text, 0, 999'999'999); });
    add_value(command, group, "--fps", "N", "Frames per second (default 24)",
              [&](const std::string& text) { bench.fps = parse_number("--fps", text); });
    add_value(command, group, "--seed", "N", "Seed of the sample pattern (default 0)",
              [&](const std::string& text) { bench.seed = parse_whole("--seed", text, 0, 0xffffffff); });
}

void add_how(CLI::App& command, BenchCommand& bench) {
    const std::string group = "How it is measured";
    add_value(command, group, "--runs", "N", "Timed runs of each method, in turn; medians count (default 5; --quick 3)",
              [&](const std::string& text) { bench.runs = parse_whole("--runs", text, 1, 1000); });
    add_value(command, group, "--seconds", "S",
              "A slower method gets as many runs as fit in S seconds, at least one (default 4; --quick 0.05)",
              [&](const std::string& text) {
                  bench.seconds = parse_number("--seconds", text);
                  if (!(*bench.seconds >= 0.0 && *bench.seconds <= 1e6))
                      throw Error(ErrorKind::kUsage, fmt::format("--seconds: {} is not from 0 to 1e6", text));
              });
    add_value(command, group, "--tests", "N",
              "Where the triangles' boxes hold over N samples, a part of the tiles is measured; 0: always all (default "
              "32000000; --quick 1000000)",
              [&](const std::string& text) {
                  bench.tests = parse_whole("--tests", text, 0, std::numeric_limits<std::int64_t>::max());
              });
    add_value(command, group, "-t,--threads", "N", "Processors to use (default: PENTAPRISM_THREADS, else all)",
              [&](const std::string& text) { bench.threads = parse_whole("--threads", text, 1, 1024); });
    const std::string outputs = "Outputs";
    add_value(command, outputs, "--report", "DIR",
              "Folder for index.html (tables, plots, pictures, heat maps), bench.json, bench.csv and bench.tex",
              [&](const std::string& text) { bench.folder = text; });
    command.add_flag("--json", bench.json, "One JSON document on stdout")->group(outputs);
}

}  // namespace

void add_bench(CLI::App& program, Run& run) {
    CLI::App* command = program.add_subcommand("bench", "Measure every culling test on scenes, side by side");
    const auto state = std::make_shared<BenchCommand>();
    add_what(*command, *state);
    add_how(*command, *state);
    add_verbosity_options(*command, state->verbosity);
    command->callback([state, &run] { run = [state] { return bench(*state); }; });
}

}  // namespace pentaprism::cli
