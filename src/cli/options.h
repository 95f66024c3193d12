#pragma once
// The options that decide how a frame looks: `render` and `verify` share them.

#include <CLI/App.hpp>
#include <functional>
#include <pentaprism/settings.h>
#include <string>
#include <vector>

namespace pentaprism::cli {

/// An option with one value. `take` may throw Error(kUsage).
CLI::Option* add_value(CLI::App& command, const std::string& group, const std::string& names, const std::string& form,
                       const std::string& description, std::function<void(const std::string&)> take);

/// For what the contract names and is not built yet.
[[noreturn]] void refuse_as_planned(const std::string& what);

/// Values of --shutter-curve and --rolling-shutter.
std::vector<ShutterPoint> parse_shutter_curve(const std::string& text);
RollingShutter parse_rolling_shutter(const std::string& text);
Backend parse_backend(const std::string& text);
GlPipeline parse_gl_pipeline(const std::string& text);

void add_scene_argument(CLI::App& command, std::string& scene);

/// Groups image, camera, lens, shutter and animation. `settings` must outlive the parsing.
void add_picture_options(CLI::App& command, RenderSettings& settings);
void add_threads_option(CLI::App& command, MethodSettings& method);
/// All of them and the group method, in which threads are.
void add_render_options(CLI::App& command, RenderSettings& settings);

/// After parsing: fills in what the environment says, and throws Error(kUsage) for what has no meaning.
void complete_settings(RenderSettings& settings);

}  // namespace pentaprism::cli
