// `pentaprism compare A B`: how far apart two pictures are.

#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <pentaprism/compare.h>
#include <pentaprism/error.h>
#include <pentaprism/image.h>

#include "cli/commands.h"
#include "cli/messages.h"
#include "cli/options.h"
#include "cli/values.h"

namespace pentaprism::cli {
namespace {

using Json = nlohmann::ordered_json;

struct CompareCommand {
    std::string a, b;
    std::filesystem::path difference;
    double gain = 4.0;
    std::optional<double> fail_above;
    CompareOptions options;
    bool json = false;
};

// JSON has no infinity: the PSNR of equal pictures is null.
Json to_json(const CompareCommand& command, const Comparison& c) {
    Json json{{"a", command.a},
              {"b", command.b},
              {"width", c.width},
              {"height", c.height},
              {"space", command.options.linear ? "linear" : "srgb"},
              {"rmse", c.rmse}};
    json["psnr"] = std::isfinite(c.psnr) ? Json(c.psnr) : Json(nullptr);
    json["ssim"] = c.ssim;
    json["flip"] = c.flip;
    json["max"] = c.max;
    json["not_finite"] = c.not_finite;
    return json;
}

std::string to_text(const CompareCommand& command, const Comparison& c) {
    std::string text =
        fmt::format("{}x{}, {} values\n", c.width, c.height, command.options.linear ? "linear" : "sRGB-encoded");
    text += fmt::format("  {:<6} {:.6f}\n", "rmse", c.rmse);
    text += fmt::format("  {:<6} {:.2f} dB\n", "psnr", c.psnr);
    text += fmt::format("  {:<6} {:.4f}\n", "ssim", c.ssim);
    text += fmt::format("  {:<6} {:.4f}\n", "flip", c.flip);
    text += fmt::format("  {:<6} {:.6f}\n", "max", c.max);
    if (c.not_finite > 0) text += fmt::format("  {} values are not finite in one of the pictures\n", c.not_finite);
    return text;
}

void write_difference(const CompareCommand& command, const Picture& a, const Picture& b) {
    const Picture picture = difference_picture(a, b, command.gain);
    ImageSettings image;
    image.tonemap = ToneMap::kNone;
    FileMetadata metadata;
    metadata.software = "pentaprism " PENTAPRISM_VERSION;
    const auto writer = make_picture_writer(command.difference, image, metadata);
    writer->begin(picture.info);
    writer->rows({0, picture.height, picture.width, picture.rgba, picture.z});
    writer->finish();
}

int compare(const CompareCommand& command) {
    if (!command.difference.empty() && !is_picture_name(command.difference))
        throw Error(ErrorKind::kUsage,
                    fmt::format("--output {}: the name must end in .exr or .png", command.difference.string()));
    const Picture a = read_picture(command.a), b = read_picture(command.b);
    const Comparison comparison = compare_pictures(a, b, command.options);
    if (!command.difference.empty()) write_difference(command, a, b);
    print_result(command.json ? to_json(command, comparison).dump(2, ' ', false, Json::error_handler_t::replace) + "\n"
                              : to_text(command, comparison));
    if (!command.fail_above || comparison.rmse <= *command.fail_above) return 0;
    print_error(fmt::format("{} and {}: rmse is {:.6f}, at most {} is allowed", command.a, command.b, comparison.rmse,
                            *command.fail_above));
    return static_cast<int>(ErrorKind::kRender);
}

}  // namespace

void add_compare(CLI::App& program, Run& run) {
    CLI::App* command = program.add_subcommand("compare", "Say how far apart two pictures are");
    const auto state = std::make_shared<CompareCommand>();
    command->add_option("A", state->a, "Picture, .exr or .png")->required()->type_name("");
    command->add_option("B", state->b, "Picture of the same size")->required()->type_name("");
    command->add_flag("--json", state->json, "One JSON document on stdout");
    command->add_flag("--linear", state->options.linear,
                      "rmse, psnr and max of linear values (default: sRGB-encoded, cut to 0..1)");
    add_value(*command, "Options", "--fail-above", "X", "Exit with 1 if rmse is larger",
              [state](const std::string& text) {
                  state->fail_above = parse_number("--fail-above", text);
                  if (!(*state->fail_above >= 0.0))
                      throw Error(ErrorKind::kUsage, fmt::format("--fail-above: {} is not a number from 0 up", text));
              });
    add_value(*command, "Options", "-o,--output", "FILE", "Write the difference of encoded values, .png or .exr",
              [state](const std::string& text) { state->difference = text; });
    add_value(*command, "Options", "--gain", "G", "Differences in that picture are multiplied by it (default 4)",
              [state](const std::string& text) {
                  state->gain = parse_number("--gain", text);
                  if (!(state->gain > 0.0 && std::isfinite(state->gain)))
                      throw Error(ErrorKind::kUsage, fmt::format("--gain: {} is not a finite number above 0", text));
              });
    command->callback([state, &run] { run = [state] { return compare(*state); }; });
}

}  // namespace pentaprism::cli
