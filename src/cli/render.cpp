// `pentaprism render SCENE -o OUT`: frames to pictures.

#include <chrono>
#include <filesystem>
#include <fmt/format.h>
#include <memory>
#include <nlohmann/json.hpp>
#include <pentaprism/aov.h>
#include <pentaprism/error.h>
#include <pentaprism/frames.h>
#include <pentaprism/image.h>
#include <pentaprism/metadata.h>
#include <pentaprism/render.h>
#include <unistd.h>

#include "cli/commands.h"
#include "cli/frame_output.h"
#include "cli/interrupt.h"
#include "cli/messages.h"
#include "cli/options.h"
#include "cli/progress.h"
#include "cli/values.h"

namespace pentaprism::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

double milliseconds_since(Clock::time_point start) {
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

struct RenderCommand {
    std::string scene;
    RenderSettings settings;
    fs::path out, stats, dataset;
    bool sharp = false;
    std::vector<std::int64_t> frames{0};
    bool overwrite = false, skip_existing = false;
    Verbosity verbosity;
};

/// What can be known of a failing output before hours of rendering is said before.
void check_output_name(const fs::path& file, const char* option) {
    std::error_code ignored;
    const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
    const auto refuse = [&](const std::string& why) {
        throw Error(ErrorKind::kOutput, fmt::format("{} {}: cannot write ({})", option, file.string(), why));
    };
    if (!fs::exists(folder, ignored))
        refuse(fmt::format("the folder {} does not exist; make it first", folder.string()));
    if (!fs::is_directory(folder, ignored)) refuse(fmt::format("{} is not a folder", folder.string()));
    if (::access(folder.c_str(), W_OK | X_OK) != 0)
        refuse(fmt::format("the folder {} cannot be written to", folder.string()));
    if (fs::is_directory(file, ignored)) refuse("it is a folder");
}

void check_names(const RenderCommand& command) {
    if (command.out.empty() && command.dataset.empty())
        throw Error(ErrorKind::kUsage, "--output is required, and must end in .exr or .png (or give --dataset DIR)");
    if (!command.out.empty() && !command.dataset.empty())
        throw Error(ErrorKind::kUsage, "--output and --dataset exclude each other: a data set has names of its own");
    if (!command.stats.empty()) check_output_name(frame_file(command.stats, command.frames.front()), "--stats");
    if (!command.dataset.empty()) {
        if (!command.settings.image.aovs.empty() || command.sharp)
            throw Error(ErrorKind::kUsage, "--dataset holds its own --aov and --sharp; leave them out");
        return;
    }
    if (!is_picture_name(command.out)) {
        throw Error(ErrorKind::kUsage,
                    fmt::format("--output {}: the name must end in .exr or .png", command.out.string()));
    }
    if (!command.settings.image.aovs.empty() && !is_exr_name(command.out))
        throw Error(ErrorKind::kUsage,
                    fmt::format("--aov: only .exr files hold more than a picture, not {}", command.out.string()));
    if (command.frames.size() > 1 && !has_frame_number(command.out)) {
        throw Error(ErrorKind::kUsage,
                    fmt::format("--output {}: {} frames need a place for their number, such as a.####{}",
                                command.out.string(), command.frames.size(), command.out.extension().string()));
    }
    check_output_name(frame_file(command.out, command.frames.front()), "--output");
}

Json to_json(const RenderStats& stats, const RenderCommand& command, std::int64_t frame, const std::string& scene) {
    Json json;
    json["scene"] = scene;
    json["frame"] = frame;
    if (!command.out.empty()) json["file"] = frame_file(command.out, frame).filename().string();
    json["width"] = command.settings.image.width;
    json["height"] = command.settings.image.height;
    json["spp"] = command.settings.image.spp;
    json["times_ms"] = stats.times_ms;
    json["triangles"] = stats.triangles;
    json["moving_triangles"] = stats.moving_triangles;
    json["samples"] = stats.samples;
    json["tested"] = stats.tested;
    json["covered"] = stats.covered;
    json["ste"] = stats.ste();
    json["shaded"] = stats.shaded;
    json["peak_mb"] = stats.peak_mb;
    json["threads"] = stats.threads;
    json["isa"] = stats.isa;
    if (!stats.device.empty()) json["device"] = stats.device;
    return json;
}

std::string to_text(const Json& json) {
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

int render(RenderCommand& command) {
    complete_settings(command.settings);
    check_names(command);
    const Clock::time_point load_start = Clock::now();
    const Scene scene = load_scene(command.scene);
    const double load_ms = milliseconds_since(load_start);
    for (const std::string& warning : scene.warnings) print_warning(warning);
    print_info(fmt::format("{}: {} triangles, read in {:.0f} ms", scene.name, count_triangles(scene), load_ms));
    throw_if_interrupted();

    const FrameSource source{command.settings, scene.name, scene_hash(command.scene), "pentaprism " PENTAPRISM_VERSION};
    const std::unique_ptr<FrameOutput> output = command.dataset.empty()
                                                    ? make_picture_output(source, command.out, command.sharp)
                                                    : make_dataset_output(source, command.dataset);
    set_picture_threads(command.settings.method.threads == 1 ? 0 : 2);

    const bool stats_for_each_frame = has_frame_number(command.stats);
    Json all_stats = Json::array();
    ProgressReporter progress(command.verbosity, command.frames.size());
    Renderer renderer(scene);
    for (const std::int64_t frame : command.frames) {
        if (command.skip_existing && output->exists(frame)) {
            progress.skip_frame(frame, output->name(frame));
            continue;
        }
        progress.begin_frame(frame);
        RenderStats stats = output->render(renderer, frame, progress.callback());
        stats.times_ms["load"] = load_ms;
        if (!command.stats.empty()) {
            Json json = to_json(stats, command, frame, scene.name);
            if (stats_for_each_frame) write_text_file(frame_file(command.stats, frame), to_text(json));
            all_stats.push_back(std::move(json));
        }
        if (!stats.device.empty()) print_debug("device: " + stats.device);
        for (const auto& [stage, ms] : stats.times_ms)
            print_debug(fmt::format("frame {}: {} {:.1f} ms", frame, stage, ms));
        progress.end_frame(output->name(frame));
    }
    output->finish();
    if (!all_stats.empty() && !stats_for_each_frame) {
        // One frame was asked for: the object itself; several: one object for each frame that was rendered.
        const bool single = command.frames.size() == 1;
        write_text_file(command.stats, to_text(single ? all_stats.front() : all_stats));
    }
    return 0;
}

void add_output_options(CLI::App& command, RenderCommand& render) {
    const std::string group = "Outputs";
    add_value(command, group, "-o,--output", "OUT",
              "Picture: .exr (linear) or .png (tone-mapped); #### is the frame's number",
              [&](const std::string& text) { render.out = text; });
    std::string names;
    for (const AovInfo& info : aov_table()) names += (names.empty() ? "" : ", ") + std::string(info.name);
    add_value(command, group, "--aov", "LIST",
              fmt::format("More outputs in .exr files, with commas between: {}", names), [&](const std::string& text) {
                  for (const std::string& name : split_list(text)) {
                      if (name == "albedo" || name == "ste") refuse_as_planned("--aov " + name);
                      render.settings.image.aovs.push_back(aov_named(name));
                  }
              });
    command.add_flag("--sharp", render.sharp, "Also OUT's twin OUT.sharp.EXT: a pinhole at mid-shutter")->group(group);
    add_value(command, group, "--dataset", "DIR", "Instead of OUT: blurred and sharp frames, depth, flow, ids, cameras",
              [&](const std::string& text) { render.dataset = text; });
    add_value(command, group, "--stats", "FILE.json",
              "What a frame cost; #### as in OUT, else an array for several frames",
              [&](const std::string& text) { render.stats = text; });
    add_planned_value(command, group, "--samples", "FILE", "Dump of every sample");
}

void add_frame_options(CLI::App& command, RenderCommand& render) {
    CLI::Option* one =
        add_value(command, "Animation", "--frame", "N", "The frame (default 0)", [&](const std::string& text) {
            render.frames = parse_frames(text);
            if (render.frames.size() > 1)
                throw Error(ErrorKind::kUsage, "--frame takes one frame; --frames takes several");
        });
    add_value(command, "Animation", "-f,--frames", "LIST", "Frames, such as 1-48,60,100-150x4",
              [&](const std::string& text) { render.frames = parse_frames(text); })
        ->excludes(one);
}

void add_batch_options(CLI::App& command, RenderCommand& render) {
    const std::string group = "Batch";
    CLI::Option* overwrite =
        command.add_flag("--overwrite", render.overwrite, "Write over files that exist (default)")->group(group);
    command.add_flag("--skip-existing", render.skip_existing, "Leave out frames whose file exists")
        ->group(group)
        ->excludes(overwrite);
    add_planned_flag(command, group, "--resume", "Go on with an interrupted frame");
    add_planned_value(command, group, "--shard", "I/N", "Render part I of N of the work");
}

}  // namespace

void add_render(CLI::App& program, Run& run) {
    CLI::App* command = program.add_subcommand("render", "Render frames of a scene to pictures");
    const auto state = std::make_shared<RenderCommand>();
    add_scene_argument(*command, state->scene);
    add_output_options(*command, *state);
    add_render_options(*command, state->settings);
    add_frame_options(*command, *state);
    add_batch_options(*command, *state);
    add_verbosity_options(*command, state->verbosity);
    command->callback([state, &run] { run = [state] { return render(*state); }; });
}

}  // namespace pentaprism::cli
