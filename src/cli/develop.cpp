// `pentaprism refocus` and `pentaprism retime`: pictures of stored samples, with another lens or another shutter.

#include <filesystem>
#include <fmt/format.h>
#include <memory>
#include <nlohmann/json.hpp>
#include <pentaprism/error.h>
#include <pentaprism/frames.h>
#include <pentaprism/stored_samples.h>

#include "cli/commands.h"
#include "cli/interrupt.h"
#include "cli/messages.h"
#include "cli/options.h"
#include "cli/output_names.h"
#include "cli/values.h"

namespace pentaprism::cli {
namespace {

using Json = nlohmann::ordered_json;

struct DevelopCommand {
    std::string samples;
    std::filesystem::path out;
    Development development;
    Json record = Json::object();  // what was asked for, for the header
};

int develop(const DevelopCommand& command) {
    if (command.record.contains("rolling-shutter-duration") && command.development.rolling == RollingShutter::kNone)
        throw Error(
            ErrorKind::kUsage,
            "--rolling-shutter-duration: nothing rolls; give --rolling-shutter top, bottom, left or right as well");
    check_picture_name(command.out, false);
    if (has_frame_number(command.out))
        throw Error(ErrorKind::kUsage,
                    "--output: samples are of one frame, and # numbers frames: " + command.out.string());
    check_output_name(command.out, "--output");
    StoredSamples samples(open_shard_file(command.samples));
    const double reach = samples.reach(command.development);
    FileMetadata metadata = samples.metadata();
    Json settings = Json::parse(metadata.settings_json, nullptr, false);
    if (settings.is_object() && !command.record.empty()) {
        settings["developed"] = command.record;
        metadata.settings_json = settings.dump(-1, ' ', false, Json::error_handler_t::replace);
    }
    set_picture_threads(2);
    const auto writer = make_picture_writer(command.out, samples.image(), metadata);
    samples.develop(command.development, *writer);
    throw_if_interrupted();
    writer->finish();
    if (reach >= 0.5)
        print_warning(fmt::format("{}: {:.0f} pixels at the border lack samples from outside the picture",
                                  command.out.string(), reach));
    return 0;
}

std::shared_ptr<DevelopCommand> add_develop(CLI::App& program, Run& run, const std::string& name,
                                            const std::string& description, CLI::App*& command) {
    const auto state = std::make_shared<DevelopCommand>();
    command = program.add_subcommand(name, description);
    command->add_option("SAMPLES", state->samples, "A .5ds file that `render --samples` wrote")
        ->required()
        ->type_name("");
    add_value(*command, "Options", "-o,--output", "OUT", "Picture: .exr (linear) or .png (tone-mapped)",
              [state](const std::string& text) { state->out = text; })
        ->required();
    command->callback([state, &run] { run = [state] { return develop(*state); }; });
    return state;
}

// An option that is one number and goes into the header, too.
void add_recorded(CLI::App& command, const std::shared_ptr<DevelopCommand>& state, const std::string& name,
                  const std::string& unit, const std::string& description, std::function<void(double)> take) {
    add_value(command, "Options", "--" + name, unit, description, [=](const std::string& text) {
        const double value = parse_number("--" + name, text);
        state->record[name] = value;
        take(value);
    });
}

}  // namespace

void add_refocus(CLI::App& program, Run& run) {
    CLI::App* command = nullptr;
    const auto state = add_develop(program, run, "refocus", "A picture of stored samples, focused elsewhere", command);
    Development& wanted = state->development;
    add_recorded(*command, state, "focus-distance", "M", "Distance in focus in metres (default: as rendered)",
                 [&wanted](double value) { wanted.focus_distance = value; });
    add_recorded(*command, state, "fstop", "N", "f-number, not below the one that was rendered (default: that)",
                 [&wanted](double value) { wanted.fstop = value; });
}

void add_retime(CLI::App& program, Run& run) {
    CLI::App* command = nullptr;
    const auto state =
        add_develop(program, run, "retime", "A picture of stored samples, with another shutter", command);
    Development& wanted = state->development;
    add_recorded(*command, state, "shutter", "F", "Open time in frames, within the one that was rendered",
                 [&wanted](double value) { wanted.shutter = value; });
    add_recorded(*command, state, "shutter-offset", "F",
                 "Frames from the rendered mid-shutter to the new one (default 0)",
                 [&wanted](double value) { wanted.shutter_offset = value; });
    add_value(*command, "Options", "--shutter-curve", "box|trapezoid:OPEN,CLOSE|FILE", "As for render (default box)",
              [state](const std::string& text) {
                  state->development.curve = parse_shutter_curve(text);
                  for (const auto& [t, open] : state->development.curve)
                      state->record["shutter-curve"].push_back({t, open});
              });
    add_value(*command, "Options", "--rolling-shutter", "none|top|bottom|left|right",
              "The edge of the picture that is exposed first (default none)", [state](const std::string& text) {
                  state->development.rolling = parse_rolling_shutter(text);
                  state->record["rolling-shutter"] = text;
              });
    wanted.rolling_duration = 0.5;
    add_recorded(*command, state, "rolling-shutter-duration", "F",
                 "Frames from the first row's opening to the last's (default 0.5)",
                 [&wanted](double value) { wanted.rolling_duration = value; });
}

}  // namespace pentaprism::cli
