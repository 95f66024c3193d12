// `pentaprism render SCENE -o OUT`: frames to pictures.

#include <chrono>
#include <filesystem>
#include <fmt/format.h>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <pentaprism/aov.h>
#include <pentaprism/error.h>
#include <pentaprism/frames.h>
#include <pentaprism/image.h>
#include <pentaprism/metadata.h>
#include <pentaprism/randomize.h>
#include <pentaprism/render.h>
#include <pentaprism/shard.h>
#include <sys/resource.h>

#include "cli/commands.h"
#include "cli/frame_output.h"
#include "cli/interrupt.h"
#include "cli/messages.h"
#include "cli/options.h"
#include "cli/output_names.h"
#include "cli/progress.h"
#include "cli/ranks.h"
#include "cli/values.h"

namespace pentaprism::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

double milliseconds_since(Clock::time_point start) {
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

// Of this process, all its threads.
double processor_milliseconds() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    const auto ms = [](const timeval& time) {
        return 1e3 * static_cast<double>(time.tv_sec) + 1e-3 * static_cast<double>(time.tv_usec);
    };
    return ms(usage.ru_utime) + ms(usage.ru_stime);
}

struct RenderCommand {
    std::string scene;
    RenderSettings settings;
    fs::path out, stats, dataset, samples;
    bool sharp = false;
    std::vector<std::int64_t> frames{0};
    bool overwrite = false, skip_existing = false, resume = false;
    Verbosity verbosity;
    std::optional<Randomization> randomization;
    std::optional<Shard> shard;
    Ranks ranks;
    /// One frame is shared out by its tiles, several are dealt out whole.
    bool shards_a_frame() const { return shard && frames.size() == 1; }
    std::vector<std::int64_t> my_frames() const {
        return shard && !shards_a_frame() ? frames_of(frames, *shard) : frames;
    }
    bool leaves_existing() const { return skip_existing || resume; }
};

[[noreturn]] void refuse(const std::string& why) {
    throw Error(ErrorKind::kUsage, why);
}

// What goes with what.
void check_kind(const RenderCommand& command) {
    const bool has_aovs = !command.settings.image.aovs.empty();
    if (command.out.empty() && command.dataset.empty() && command.samples.empty())
        refuse("--output is required, and must end in .exr or .png (or give --dataset DIR or --samples FILE)");
    if (!command.out.empty() && !command.dataset.empty())
        refuse("--output and --dataset exclude each other: a data set has names of its own");
    if (!command.samples.empty()) {
        if (!command.out.empty() || !command.dataset.empty())
            refuse("--samples: instead of --output and --dataset; `pentaprism refocus` makes pictures of them");
        if (has_aovs || command.sharp || command.shards_a_frame())
            refuse("--samples: samples have neither --aov nor --sharp, and no parts of a frame; leave them out");
        if (command.settings.image.target_error)
            refuse("--samples: stored samples are as many for each pixel; leave --target-error out");
        if (command.settings.method.transparency == Transparency::kABuffer)
            refuse("--samples: a stored sample is of one surface; leave --transparency a-buffer out");
        if (command.samples.extension() != ".5ds")
            refuse(fmt::format("--samples {}: the name must end in .5ds", command.samples.string()));
    } else if (!command.dataset.empty()) {
        if (has_aovs || command.sharp) refuse("--dataset holds its own --aov and --sharp; leave them out");
        if (command.shards_a_frame()) refuse("--shard: a --dataset is shared out by its frames; give several");
    } else {
        check_picture_name(command.out, has_aovs);
        if (command.shards_a_frame() && command.sharp)
            refuse("--sharp: a part of a frame has no twin; shard several frames, or leave it out");
    }
}

// Also of a file that does not exist yet.
bool is_same_file(const fs::path& a, const fs::path& b) {
    std::error_code error;
    const auto whole = [&](const fs::path& file) { return fs::weakly_canonical(fs::absolute(file), error); };
    return whole(a) == whole(b) && !error;
}

// A file for each frame, in a folder that can be written to.
void check_names(const RenderCommand& command) {
    const auto check_numbered = [&](const fs::path& file, const char* option) {
        if (file.empty()) return;
        if (command.frames.size() > 1 && !has_frame_number(file))
            refuse(fmt::format("{} {}: {} frames need a place for their number, such as a.####{}", option,
                               file.string(), command.frames.size(), file.extension().string()));
        check_output_name(frame_file(file, command.frames.front()), option);
    };
    if (!command.stats.empty()) {
        check_output_name(frame_file(command.stats, command.frames.front()), "--stats");
        if (command.shard && command.frames.size() > 1 && !has_frame_number(command.stats))
            refuse("--stats: a part of a sequence needs a place for the frame's number, such as s.####.json");
    }
    check_numbered(command.out, "--output");
    check_numbered(command.samples, "--samples");
    const fs::path& file = command.samples.empty() ? command.out : command.samples;
    if (!command.stats.empty() && !file.empty() &&
        is_same_file(frame_file(command.stats, command.frames.front()), frame_file(file, command.frames.front())))
        refuse(fmt::format("--stats {}: it is the file of the picture itself", command.stats.string()));
}

Json to_json(const RenderStats& stats, double cpu_ms, const RenderCommand& command, std::int64_t frame,
             const std::string& scene) {
    Json json;
    json["scene"] = scene;
    json["frame"] = frame;
    const fs::path& file = command.samples.empty() ? command.out : command.samples;
    if (!file.empty()) json["file"] = frame_file(file, frame).filename().string();
    json["width"] = command.settings.image.width;
    json["height"] = command.settings.image.height;
    json["spp"] = command.settings.image.spp;
    json["times_ms"] = stats.times_ms;
    json["cpu_ms"] = cpu_ms;
    json["triangles"] = stats.triangles;
    json["moving_triangles"] = stats.moving_triangles;
    json["samples"] = stats.samples;
    if (stats.pixels > 0) json["mean_spp"] = static_cast<double>(stats.samples) / static_cast<double>(stats.pixels);
    if (command.settings.image.target_error) json["pilot_samples"] = stats.pilot_samples;
    json["tested"] = stats.tested;
    json["covered"] = stats.covered;
    json["ste"] = stats.ste();
    json["shaded"] = stats.shaded;
    json["peak_mb"] = stats.peak_mb;
    json["threads"] = stats.threads;
    json["isa"] = stats.isa;
    if (!stats.device.empty()) json["device"] = stats.device;
    if (!stats.gl_pipeline.empty()) json["gl_pipeline"] = stats.gl_pipeline;
    return json;
}

std::string to_text(const Json& json) {
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

// Leaves out the frames that need no work. All are looked at before the first is rendered: a directory of other
// settings is refused at once, and the time left counts what is left.
std::vector<std::int64_t> frames_to_do(const RenderCommand& command, FrameOutput& output, ProgressReporter& progress) {
    const std::vector<std::int64_t> all = command.my_frames();
    if (!command.leaves_existing()) return all;
    if (command.resume) output.check_resumable(all);
    std::vector<std::int64_t> frames;
    for (const std::int64_t frame : all) {
        if (output.exists(frame))
            progress.skip_frame(frame, output.name(frame));
        else
            frames.push_back(frame);
    }
    return frames;
}

// A colour that samples share holds the blur that was rendered: what is developed later wants each its own.
void keep_samples_apart(MethodSettings& method) {
    method.shading = "sample";
    if (method.texture_filter == TextureFilter::kFull) method.texture_filter = TextureFilter::kPixel;
}

// MPI processes share out the work as shards do.
void share_with_ranks(RenderCommand& command) {
    command.ranks = join_ranks();
    if (command.ranks.alone()) return;
    if (command.shard) refuse("--shard: mpirun shares out the work already; leave one of them out");
    command.shard = Shard{command.ranks.rank, command.ranks.size};
    if (!command.ranks.first()) command.verbosity.progress = ProgressStyle::kNone;
}

std::unique_ptr<FrameOutput> make_output(const RenderCommand& command, const FrameSource& source) {
    if (!command.dataset.empty()) return make_dataset_output(source, command.dataset, command.frames, command.shard);
    if (!command.samples.empty()) return make_samples_output(source, command.samples);
    if (command.shards_a_frame())
        return command.ranks.alone() ? make_shard_output(source, command.out, *command.shard)
                                     : make_ranks_output(source, command.out, command.ranks);
    return make_picture_output(source, command.out, command.sharp);
}

int render(RenderCommand& command) {
    complete_settings(command.settings);
    if (!command.samples.empty()) keep_samples_apart(command.settings.method);
    share_with_ranks(command);
    if (command.randomization) check_randomization(command.settings, *command.randomization);
    check_kind(command);
    check_names(command);
    const Clock::time_point load_start = Clock::now();
    const Scene scene = load_scene(command.scene);
    const double load_ms = milliseconds_since(load_start);
    for (const std::string& warning : scene.warnings) print_warning(warning);
    print_info(fmt::format("{}: {} triangles, read in {:.0f} ms", scene.name, count_triangles(scene), load_ms));
    throw_if_interrupted();

    const FrameSource source{command.settings,          scene.name,
                             scene_hash(command.scene), "pentaprism " PENTAPRISM_VERSION,
                             command.randomization,     picture_hashes(command.settings)};
    const std::unique_ptr<FrameOutput> output = make_output(command, source);
    set_picture_threads(command.settings.method.threads == 1 ? 0 : 2);

    const bool stats_for_each_frame = has_frame_number(command.stats);
    Json all_stats = Json::array();
    ProgressReporter progress(command.verbosity, command.my_frames().size());
    Renderer renderer(scene);
    const std::vector<std::int64_t> frames = frames_to_do(command, *output, progress);
    output->begin(frames);
    for (const std::int64_t frame : frames) {
        if (command.leaves_existing() && output->exists(frame)) {  // another process was faster
            progress.skip_frame(frame, output->name(frame));
            continue;
        }
        progress.begin_frame(frame);
        const double cpu_start = processor_milliseconds();
        RenderStats stats = output->render(renderer, frame, progress.callback());
        const double cpu_ms = processor_milliseconds() - cpu_start;
        stats.times_ms["load"] = load_ms;
        if (!command.stats.empty() && (command.ranks.first() || !command.shards_a_frame())) {
            Json json = to_json(stats, cpu_ms, command, frame, scene.name);
            if (stats_for_each_frame) write_text_file(frame_file(command.stats, frame), to_text(json));
            all_stats.push_back(std::move(json));
        }
        if (!stats.device.empty()) print_debug("device: " + stats.device + ", pipeline: " + stats.gl_pipeline);
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
    leave_ranks();
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
                  for (const std::string& name : split_list(text))
                      render.settings.image.aovs.push_back(aov_named(name));
              });
    command.add_flag("--sharp", render.sharp, "Also OUT's twin OUT.sharp.EXT: a pinhole at mid-shutter")->group(group);
    add_value(command, group, "--dataset", "DIR", "Instead of OUT: blurred and sharp frames, depth, flow, ids, cameras",
              [&](const std::string& text) { render.dataset = text; });
    add_value(command, group, "--randomize", "FILE.json",
              "Ranges of lens, shutter, exposure and camera, from which each frame gets its own; recorded in its files",
              [&](const std::string& text) { render.randomization = read_randomization(text); });
    add_value(command, group, "--stats", "FILE.json",
              "What a frame cost; #### as in OUT, else an array for several frames",
              [&](const std::string& text) { render.stats = text; });
    add_value(command, group, "--samples", "FILE.5ds",
              "Instead of OUT: every sample with its ray, for `refocus` and `retime`; 32 bytes each",
              [&](const std::string& text) { render.samples = text; });
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
    CLI::Option* skip = command.add_flag("--skip-existing", render.skip_existing, "Leave out frames whose file exists")
                            ->group(group)
                            ->excludes(overwrite);
    command
        .add_flag("--resume", render.resume,
                  "The same, but refuse if one of them was made with other settings, scene or version")
        ->group(group)
        ->excludes(overwrite)
        ->excludes(skip);
    add_value(command, group, "--shard", "I/N",
              "Part I of N of the work, I from 1: every N-th of several frames, or of the tiles of one, for `merge`",
              [&](const std::string& text) { render.shard = parse_shard(text); });
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
