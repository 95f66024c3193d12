#include "cli/options.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fmt/format.h>
#include <limits>
#include <memory>
#include <pentaprism/render.h>
#include <utility>

#include "cli/values.h"

namespace pentaprism::cli {
namespace {

constexpr int kIntMax = std::numeric_limits<int>::max();

bool is_surroundings_picture(const std::string& file) {
    const std::string suffix = CLI::detail::to_lower(std::filesystem::path(file).extension().string());
    return suffix == ".hdr" || suffix == ".exr";
}

void add_image_options(CLI::App& command, ImageSettings& image) {
    const std::string group = "Image";
    add_value(command, group, "-r,--resolution", "WxH", "Size in pixels, 1 to 16384 (default 1280x720)",
              [&](const std::string& text) { std::tie(image.width, image.height) = parse_size("--resolution", text); });
    add_value(command, group, "-s,--spp", "N", "Samples per pixel, 1 to 4096 (default 16)",
              [&](const std::string& text) { image.spp = static_cast<int>(parse_whole("--spp", text, 1, 4096)); });
    CLI::Option* target =
        add_value(command, group, "--target-error", "E",
                  "Give each 4x4 pixels --spp to --max-spp samples, more where they are noisier: 64 where these bring "
                  "the error down to E; 0.01 is a hundredth of the way from black to white (default: --spp everywhere)",
                  [&](const std::string& text) { image.target_error = parse_number("--target-error", text); });
    add_value(
        command, group, "--max-spp", "N", "The most samples per pixel that --target-error gives (default 1024)",
        [&](const std::string& text) { image.max_spp = static_cast<int>(parse_whole("--max-spp", text, 1, 4096)); })
        ->needs(target);
    add_value(command, group, "--filter", "box|tent|gaussian|blackman-harris",
              "Reconstruction filter (default blackman-harris, radius 1.5 pixels)", [&](const std::string& text) {
                  image.filter = parse_choice<Filter>("--filter", text,
                                                      {{"box", Filter::kBox},
                                                       {"tent", Filter::kTent},
                                                       {"gaussian", Filter::kGaussian},
                                                       {"blackman-harris", Filter::kBlackmanHarris}});
              });
    add_value(command, group, "--crop", "X0,X1,Y0,Y1",
              "Render this part alone; pixels, X1 and Y1 excluded (default: all)", [&](const std::string& text) {
                  const auto values = parse_numbers("--crop", text, 4, "X0,X1,Y0,Y1");
                  std::array<int, 4> crop{};
                  for (std::size_t i = 0; i < 4; ++i) {
                      crop[i] = static_cast<int>(std::clamp(values[i], -1e6, 1e6));
                      if (crop[i] != values[i]) {
                          throw Error(ErrorKind::kUsage, fmt::format("--crop: '{}' are not four whole numbers", text));
                      }
                  }
                  image.crop = crop;
              });
    add_value(command, group, "--exposure", "EV", "Colours are multiplied by 2^EV (default 0)",
              [&](const std::string& text) { image.exposure = parse_number("--exposure", text); });
    add_value(command, group, "--tonemap", "none|aces|filmic", "Tone curve of PNG files (default aces)",
              [&](const std::string& text) {
                  image.tonemap = parse_choice<ToneMap>(
                      "--tonemap", text,
                      {{"none", ToneMap::kNone}, {"aces", ToneMap::kAces}, {"filmic", ToneMap::kFilmic}});
              });
    add_value(command, group, "--background", "R,G,B|FILE|sky",
              "Linear colour behind the scene (default: the scene's, else 0,0,0), or what surrounds and lights it: a "
              "latitude-longitude picture, .hdr or .exr, or the built-in sky",
              [&](const std::string& text) {
                  if (text == "sky" || is_surroundings_picture(text)) {
                      image.environment = text;
                      return;
                  }
                  const auto values = parse_numbers("--background", text, 3, "R,G,B");
                  image.background = {static_cast<float>(values[0]), static_cast<float>(values[1]),
                                      static_cast<float>(values[2])};
              });
}

/// The many options that are one number.
void add_number(CLI::App& command, const std::string& group, const std::string& name, const std::string& unit,
                const std::string& description, std::optional<double>& value) {
    add_value(command, group, name, unit, description,
              [&value, name](const std::string& text) { value = parse_number(name, text); });
}

void add_camera_options(CLI::App& command, CameraSettings& camera) {
    const std::string group = "Camera";
    add_value(command, group, "--camera", "NAME|INDEX", "Camera (default: the first, else one that frames the scene)",
              [&](const std::string& text) { camera.camera = text; });
    add_number(command, group, "--focal-length", "MM", "Focal length in millimetres (default: the camera's)",
               camera.focal_length_mm);
    add_number(command, group, "--sensor-width", "MM", "Sensor width in millimetres (default: the camera's, else 36)",
               camera.sensor_width_mm);
}

void add_lens_options(CLI::App& command, CameraSettings& camera) {
    const std::string group = "Lens";
    add_number(command, group, "--fstop", "N", "f-number (default: the camera's, else a pinhole)", camera.fstop);
    add_number(command, group, "--lens-radius", "M", "Radius of the lens in metres, instead of --fstop",
               camera.lens_radius);
    add_number(command, group, "--focus-distance", "M",
               "Distance in focus in metres (default: the camera's, else the middle of what is seen)",
               camera.focus_distance);
    add_value(command, group, "--focus-object", "NODE", "Focus on the middle of this node",
              [&](const std::string& text) { camera.focus_object = text; });
    add_value(command, group, "--focus-pixel", "X,Y", "Focus on what this pixel shows", [&](const std::string& text) {
        const auto values = parse_numbers("--focus-pixel", text, 2, "X,Y");
        camera.focus_pixel = {values[0], values[1]};
    });
    add_value(command, group, "--aperture-blades", "N",
              "Blades of the iris, 3 or more; 0: a disk (default: the camera's, else 0)", [&](const std::string& text) {
                  camera.aperture_blades = static_cast<int>(parse_whole("--aperture-blades", text, 0, kIntMax));
              });
    add_number(command, group, "--aperture-rotation", "DEG", "Turns the iris; degrees (default: the camera's, else 0)",
               camera.aperture_rotation_deg);
    add_number(command, group, "--aperture-roundness", "R", "Curves the blades, 0: straight, to 1: a disk (default 0)",
               camera.aperture_roundness);
    add_number(command, group, "--aperture-ratio", "R",
               "Height over width of the circle of confusion (default: the camera's, else 1)", camera.aperture_ratio);
    add_value(command, group, "--focus-range", "NEAR,FAR",
              "Keep this range of depth sharp; metres (default: the camera's, else a real lens)",
              [&](const std::string& text) {
                  const auto values = parse_numbers("--focus-range", text, 2, "NEAR,FAR");
                  camera.focus_range = {values[0], values[1]};
              });
    add_number(command, group, "--tilt", "DEG",
               "Leans the plane of focus: above 0, its top is farther (default: the camera's, else 0)",
               camera.tilt_deg);
    add_number(command, group, "--swing", "DEG", "The same for its right side", camera.swing_deg);
    add_value(command, group, "--aperture-image", "FILE",
              "A picture, .png or .exr, as the lens: light comes through its circle where it is bright",
              [&](const std::string& text) { camera.aperture_image = text; });
    add_number(command, group, "--cats-eye", "A",
               "How far the barrel hides the lens in a corner of the picture, 0 to 1.5 lens radii (default: the "
               "camera's, else 0)",
               camera.cats_eye);
    add_number(command, group, "--max-foreground-blur", "PX",
               "Largest blur in front of the focus, a radius in pixels (default: the camera's, else any)",
               camera.max_foreground_blur);
    command
        .add_flag_callback(
            "--no-defocus", [&] { camera.defocus = false; }, "A pinhole, whatever else is said")
        ->group(group);
}

void add_shutter_options(CLI::App& command, ShutterSettings& shutter) {
    const std::string group = "Shutter";
    add_number(command, group, "--shutter", "F", "Open time in frames (default: the camera's, else 0.5)",
               shutter.shutter);
    add_value(command, group, "--shutter-position", "start|center|end",
              "Where the frame's time lies in it (default center)", [&](const std::string& text) {
                  shutter.position = parse_choice<ShutterPosition>("--shutter-position", text,
                                                                   {{"start", ShutterPosition::kStart},
                                                                    {"center", ShutterPosition::kCenter},
                                                                    {"end", ShutterPosition::kEnd}});
              });
    add_value(command, group, "--shutter-curve", "box|trapezoid:OPEN,CLOSE|FILE",
              "How it opens and closes: at once, evenly until OPEN and from CLOSE of its time, or a file with lines T "
              "OPEN (default box)",
              [&](const std::string& text) { shutter.curve = parse_shutter_curve(text); });
    add_value(command, group, "--rolling-shutter", "none|top|bottom|left|right",
              "The edge of the picture that is exposed first (default none: all at once)",
              [&](const std::string& text) { shutter.rolling = parse_rolling_shutter(text); });
    add_number(command, group, "--rolling-shutter-duration", "F",
               "Frames from the first row's opening to the last's (default 0.5)", shutter.rolling_duration);
    add_value(command, group, "--motion-segments", "auto|N",
              "Straight pieces of each path, 1 to 64 (default auto: error below 0.1 pixel)",
              [&](const std::string& text) {
                  shutter.motion_segments =
                      text == "auto" ? 0 : static_cast<int>(parse_whole("--motion-segments", text, 1, 64));
              });
    command
        .add_flag_callback(
            "--no-motion-blur", [&] { shutter.motion_blur = false; }, "Everything stands still at mid-shutter")
        ->group(group);
}

void add_animation_options(CLI::App& command, AnimationSettings& animation) {
    const std::string group = "Animation";
    add_value(command, group, "--fps", "N", "Frames per second: frame K is at K/N seconds (default 24)",
              [&](const std::string& text) { animation.fps = parse_number("--fps", text); });
    add_value(command, group, "--animation", "NAME|INDEX|all", "Clips that play (default all)",
              [&](const std::string& text) { animation.animation = text; });
}

void add_method_options(CLI::App& command, MethodSettings& method) {
    const std::string group = "Method";
    std::string names;
    for (const CullingChoice& choice : culling_tests())
        names += (names.empty() ? "" : ", ") + choice.name + (choice.conservative ? "" : " (loses samples)");
    add_value(command, group, "--culling", "TEST[@tile|@pixel|@bucket][+...]",
              fmt::format("Culling tests and what each is asked about (default auto): {}", names),
              [&](const std::string& text) {
                  check_culling(text);
                  method.culling = text;
              });
    add_value(command, group, "--visibility", "stochastic|accumulation|interleaved|raytrace|micropolygon",
              "How visible surfaces are found (default stochastic)", [&](const std::string& text) {
                  method.visibility =
                      parse_choice<VisibilityMethod>("--visibility", text,
                                                     {{"stochastic", VisibilityMethod::kStochastic},
                                                      {"accumulation", VisibilityMethod::kAccumulation},
                                                      {"interleaved", VisibilityMethod::kInterleaved},
                                                      {"raytrace", VisibilityMethod::kRaytrace},
                                                      {"micropolygon", VisibilityMethod::kMicropolygon}});
              });
    add_value(
        command, group, "--backend", "cpu|gl",
        "What finds visible surfaces, and with --shading pixel shades: the processor, or OpenGL 4.5 (default cpu)",
        [&](const std::string& text) { method.backend = parse_backend(text); });
    add_value(command, group, "--gl-pipeline", "auto|geometry|compute",
              "How --backend gl does it: the papers' geometry shader, or tiles in compute shaders (default auto)",
              [&](const std::string& text) { method.gl_pipeline = parse_gl_pipeline(text); });
    add_value(command, group, "--shading", "pixel|sample|decoupled",
              "How often visible surfaces are shaded (default decoupled)", [&](const std::string& text) {
                  method.shading = parse_choice<std::string>(
                      "--shading", text, {{"pixel", "pixel"}, {"sample", "sample"}, {"decoupled", "decoupled"}});
              });
    add_value(command, group, "--texture-filter", "off|pixel|full",
              "What a texture is averaged over: nothing, the pixel, or pixel, motion and lens (default full)",
              [&](const std::string& text) {
                  method.texture_filter = parse_choice<TextureFilter>(
                      "--texture-filter", text,
                      {{"off", TextureFilter::kOff}, {"pixel", TextureFilter::kPixel}, {"full", TextureFilter::kFull}});
              });
    add_value(command, group, "--brdf", "gltf|burley", "Model of surfaces (default gltf; burley as older Blender)",
              [&](const std::string& text) {
                  method.brdf = parse_choice<BrdfModel>("--brdf", text,
                                                        {{"gltf", BrdfModel::kGltf}, {"burley", BrdfModel::kBurley}});
              });
    add_value(command, group, "--shadows", "off|still|moving",
              "Shadows: none, of mid-shutter, or at each time of the shutter (default moving)",
              [&](const std::string& text) {
                  method.shadows = parse_choice<ShadowMode>(
                      "--shadows", text,
                      {{"off", ShadowMode::kOff}, {"still", ShadowMode::kStill}, {"moving", ShadowMode::kMoving}});
              });
    add_value(command, group, "--transparency", "stochastic|a-buffer",
              "Surfaces that let light through: shown by some samples and not by others (default), or all of them, one "
              "over the other, by each sample: slower, without that noise",
              [&](const std::string& text) {
                  method.transparency = parse_choice<Transparency>(
                      "--transparency", text,
                      {{"stochastic", Transparency::kStochastic}, {"a-buffer", Transparency::kABuffer}});
              });
    add_value(command, group, "--sampler", "stratified|sobol|blue-noise|independent",
              "Sample pattern (default stratified, the fastest)", [&](const std::string& text) {
                  method.sampler = parse_choice<Sampler>("--sampler", text,
                                                         {{"stratified", Sampler::kStratified},
                                                          {"sobol", Sampler::kSobol},
                                                          {"blue-noise", Sampler::kBlueNoise},
                                                          {"independent", Sampler::kIndependent}});
              });
    add_value(command, group, "--seed", "N", "Seed of the sample pattern (default 0)", [&](const std::string& text) {
        method.seed =
            static_cast<std::uint32_t>(parse_whole("--seed", text, 0, std::numeric_limits<std::uint32_t>::max()));
    });
    add_threads_option(command, method);
}

}  // namespace

CLI::Option* add_value(CLI::App& command, const std::string& group, const std::string& names, const std::string& form,
                       const std::string& description, std::function<void(const std::string&)> take) {
    // A value that is empty is a script's variable that was not set, not the default.
    const auto take_some = [take = std::move(take),
                            name = names.substr(names.rfind(',') + 1)](const std::string& text) {
        if (text.empty()) throw Error(ErrorKind::kUsage, name + ": its value is empty");
        take(text);
    };
    return command.add_option_function<std::string>(names, take_some, description)->type_name(form)->group(group);
}

std::vector<ShutterPoint> parse_shutter_curve(const std::string& text) {
    if (text == "box") return {};
    const std::string trapezoid = "trapezoid:";
    if (text.substr(0, trapezoid.size()) != trapezoid) return read_shutter_curve(text);
    const auto times = parse_numbers("--shutter-curve", text.substr(trapezoid.size()), 2, "trapezoid:OPEN,CLOSE");
    return trapezoid_shutter(times[0], times[1]);
}

RollingShutter parse_rolling_shutter(const std::string& text) {
    return parse_choice<RollingShutter>("--rolling-shutter", text,
                                        {{"none", RollingShutter::kNone},
                                         {"top", RollingShutter::kTop},
                                         {"bottom", RollingShutter::kBottom},
                                         {"left", RollingShutter::kLeft},
                                         {"right", RollingShutter::kRight}});
}

Backend parse_backend(const std::string& text) {
    return parse_choice<Backend>("--backend", text, {{"cpu", Backend::kCpu}, {"gl", Backend::kGl}});
}

GlPipeline parse_gl_pipeline(const std::string& text) {
    return parse_choice<GlPipeline>(
        "--gl-pipeline", text,
        {{"auto", GlPipeline::kAuto}, {"geometry", GlPipeline::kGeometry}, {"compute", GlPipeline::kCompute}});
}

void refuse_as_planned(const std::string& what) {
    throw Error(ErrorKind::kUsage, what + " is not built yet (planned: see CHANGELOG)");
}

void add_scene_argument(CLI::App& command, std::string& scene) {
    command.add_option("SCENE", scene, "A .gltf, .glb or .obj file, or builtin:NAME (see `pentaprism scene --list`)")
        ->required()
        ->type_name("");
}

void add_threads_option(CLI::App& command, MethodSettings& method) {
    add_value(
        command, "Method", "-t,--threads", "N", "Processors to use (default: PENTAPRISM_THREADS, else all)",
        [&](const std::string& text) { method.threads = static_cast<int>(parse_whole("--threads", text, 1, 1024)); });
}

void add_picture_options(CLI::App& command, RenderSettings& settings) {
    add_image_options(command, settings.image);
    add_camera_options(command, settings.camera);
    add_lens_options(command, settings.camera);
    add_shutter_options(command, settings.shutter);
    add_animation_options(command, settings.animation);
}

void add_render_options(CLI::App& command, RenderSettings& settings) {
    add_picture_options(command, settings);
    add_method_options(command, settings.method);
}

void complete_settings(RenderSettings& settings) {
    if (const char* text = std::getenv("PENTAPRISM_THREADS"); text && *text && settings.method.threads == 0) {
        settings.method.threads = static_cast<int>(parse_whole("PENTAPRISM_THREADS", text, 1, 1024));
    }
    cpu_target();  // a wrong PENTAPRISM_ISA is said before any work
    validate(settings);
}

}  // namespace pentaprism::cli
