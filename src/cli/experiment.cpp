// `pentaprism experiment guided-sampling SCENE`: may samples be placed only where bounds say that they can hit?

#include <fmt/format.h>
#include <memory>
#include <nlohmann/json.hpp>
#include <pentaprism/error.h>
#include <pentaprism/experiment.h>
#include <pentaprism/image.h>

#include "cli/commands.h"
#include "cli/interrupt.h"
#include "cli/messages.h"
#include "cli/options.h"
#include "cli/output_names.h"
#include "cli/progress.h"
#include "cli/values.h"

namespace pentaprism::cli {
namespace {

using Json = nlohmann::ordered_json;

struct ExperimentCommand {
    std::string scene;
    GuidedPlan plan;
    std::filesystem::path out;
    int zoom = 2;
    bool json = false;
    Verbosity verbosity;
};

std::string to_text(const GuidedReport& report, const std::string& scene, const GuidedPlan& plan) {
    std::string text =
        fmt::format("{}: {}x{}, {} samples per pixel, {} pictures of each way, {} blocks\n", one_line(scene),
                    report.width, report.height, plan.settings.image.spp, plan.repeats, report.blocks);
    text +=
        fmt::format("{:<12}{:>14}{:>10}{:>10}{:>9}{:>10}\n", "", "tests/pixel", "error", "bias", "rms z", "worst z");
    for (const GuidedRow& row : report.rows) {
        text += fmt::format("{:<12}{:>14.1f}{:>10.5f}{:>10.5f}{:>9.2f}{:>10.1f}  {}\n", row.name, row.tests_per_pixel,
                            row.error, row.bias, row.rms_z, row.worst_z, row.description);
    }
    return text;
}

Json to_json(const GuidedReport& report, const std::string& scene, const GuidedPlan& plan) {
    Json rows = Json::array();
    for (const GuidedRow& row : report.rows) {
        rows.push_back({{"name", row.name},
                        {"description", row.description},
                        {"tests_per_pixel", row.tests_per_pixel},
                        {"error", row.error},
                        {"bias", row.bias},
                        {"rms_z", row.rms_z},
                        {"worst_z", row.worst_z}});
    }
    return {{"scene", scene},
            {"width", report.width},
            {"height", report.height},
            {"spp", plan.settings.image.spp},
            {"repeats", plan.repeats},
            {"blocks", report.blocks},
            {"rows", rows}};
}

void write(const Picture& picture, const std::filesystem::path& file) {
    ImageSettings image;
    image.width = picture.width;
    image.height = picture.height;
    image.tonemap = ToneMap::kNone;
    const auto writer = make_picture_writer(file, image, {});
    writer->begin(picture.info);
    writer->rows({0, picture.height, picture.width, picture.rgba, picture.z});
    writer->finish();
}

int experiment(ExperimentCommand& command) {
    complete_settings(command.plan.settings);
    const ImageSettings& image = command.plan.settings.image;
    for (const auto& [given, option] :
         {std::pair(image.crop.has_value(), "--crop"), std::pair(image.target_error.has_value(), "--target-error")})
        if (given)
            throw Error(ErrorKind::kUsage,
                        fmt::format("{}: the experiment has whole pictures, with as many samples for each pixel; leave "
                                    "it out",
                                    option));
    if (!command.out.empty()) {
        check_picture_name(command.out, false);
        check_output_name(command.out, "--output");
    }
    const Scene scene = load_scene(command.scene);
    for (const std::string& warning : scene.warnings) print_warning(warning);
    throw_if_interrupted();
    GuidedReport report;
    {
        ProgressReporter progress(command.verbosity, 1);
        progress.begin_frame(static_cast<std::int64_t>(command.plan.frame));
        report = run_guided_sampling(scene, command.plan, progress.callback());
        throw_if_interrupted();
        progress.end_frame("sampled");
    }
    if (!command.out.empty()) write(guided_picture(report, command.zoom), command.out);
    print_result(command.json
                     ? to_json(report, scene.name, command.plan).dump(2, ' ', false, Json::error_handler_t::replace) +
                           "\n"
                     : to_text(report, scene.name, command.plan));
    return 0;
}

}  // namespace

void add_experiment(CLI::App& program, Run& run) {
    CLI::App* group = program.add_subcommand("experiment", "Questions about sampling, shown on a scene");
    group->require_subcommand(1);
    CLI::App* command = group->add_subcommand(
        "guided-sampling", "May samples be placed only where a triangle's bounds say that they can hit it?");
    const auto state = std::make_shared<ExperimentCommand>();
    state->plan.settings.image.width = 160;
    state->plan.settings.image.height = 90;
    state->plan.settings.image.spp = 64;
    add_scene_argument(*command, state->scene);
    add_value(*command, "Options", "-o,--output", "FILE", "Pictures side by side, .png or .exr (default: none)",
              [state](const std::string& text) { state->out = text; });
    add_value(*command, "Options", "--zoom", "N", "Size of a pixel in FILE, 1 to 8 (default 2)",
              [state](const std::string& text) { state->zoom = static_cast<int>(parse_whole("--zoom", text, 1, 8)); });
    add_value(*command, "Options", "--repeats", "N", "Pictures of each way, 2 to 1000 (default 8)",
              [state](const std::string& text) {
                  state->plan.repeats = static_cast<int>(parse_whole("--repeats", text, 2, 1000));
              });
    command->add_flag("--json", state->json, "One JSON document on stdout");
    add_value(*command, "Animation", "--frame", "N", "The frame (default 0)", [state](const std::string& text) {
        state->plan.frame = static_cast<double>(parse_whole("--frame", text, 0, 999'999'999));
    });
    add_picture_options(*command, state->plan.settings);
    add_threads_option(*command, state->plan.settings.method);
    add_verbosity_options(*command, state->verbosity);
    command->callback([state, &run] { run = [state] { return experiment(*state); }; });
}

}  // namespace pentaprism::cli
