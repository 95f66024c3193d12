// The settings as JSON for a picture's header.

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <pentaprism/aov.h>
#include <pentaprism/metadata.h>
#include <pentaprism/render.h>

#include "camera/visibility_name.h"

namespace pentaprism {
namespace {

const char* name_of(Filter filter) {
    switch (filter) {
        case Filter::kBox:
            return "box";
        case Filter::kTent:
            return "tent";
        case Filter::kGaussian:
            return "gaussian";
        case Filter::kBlackmanHarris:
            break;
    }
    return "blackman-harris";
}

const char* name_of(ToneMap curve) {
    switch (curve) {
        case ToneMap::kNone:
            return "none";
        case ToneMap::kFilmic:
            return "filmic";
        case ToneMap::kAces:
            break;
    }
    return "aces";
}

const char* name_of(ShutterPosition position) {
    switch (position) {
        case ShutterPosition::kStart:
            return "start";
        case ShutterPosition::kEnd:
            return "end";
        case ShutterPosition::kCenter:
            break;
    }
    return "center";
}

const char* name_of(RollingShutter rolling) {
    switch (rolling) {
        case RollingShutter::kTop:
            return "top";
        case RollingShutter::kBottom:
            return "bottom";
        case RollingShutter::kLeft:
            return "left";
        case RollingShutter::kRight:
            return "right";
        case RollingShutter::kNone:
            break;
    }
    return "none";
}

const char* name_of(ShadowMode mode) {
    switch (mode) {
        case ShadowMode::kOff:
            return "off";
        case ShadowMode::kStill:
            return "still";
        case ShadowMode::kMoving:
            break;
    }
    return "moving";
}

const char* name_of(Sampler sampler) {
    switch (sampler) {
        case Sampler::kSobol:
            return "sobol";
        case Sampler::kBlueNoise:
            return "blue-noise";
        case Sampler::kIndependent:
            return "independent";
        case Sampler::kStratified:
            break;
    }
    return "stratified";
}

using Json = nlohmann::ordered_json;

// Options that were not given are left out: what they come to is in the header's own attributes.
template <class T>
void put(Json& json, const char* key, const std::optional<T>& value) {
    if (value) json[key] = *value;
}
void put(Json& json, const char* key, const std::string& value) {
    if (!value.empty()) json[key] = value;
}

void put(Json& json, const char* key, const CameraOffset& value) {
    if (value != CameraOffset{}) json[key] = {{"shift_m", value.shift_m}, {"turn_deg", value.turn_deg}};
}

bool has(const std::vector<Aov>& aovs, Aov wanted) {
    return std::find(aovs.begin(), aovs.end(), wanted) != aovs.end();
}

std::string file_name(const std::string& path) {
    return std::filesystem::path(path).filename().string();
}

// Some tests are kept as papers print them, and lose samples.
bool loses_samples(const std::string& culling) {
    const std::vector<CullingChoice> tests = culling_tests();
    return std::any_of(tests.begin(), tests.end(), [&](const CullingChoice& test) {
        return !test.conservative && culling.find(test.name) != std::string::npos;
    });
}

}  // namespace

const char* name_of(VisibilityMethod method) {
    switch (method) {
        case VisibilityMethod::kAccumulation:
            return "accumulation";
        case VisibilityMethod::kInterleaved:
            return "interleaved";
        case VisibilityMethod::kRaytrace:
            return "raytrace";
        case VisibilityMethod::kMicropolygon:
            return "micropolygon";
        case VisibilityMethod::kStochastic:
            break;
    }
    return "stochastic";
}

PictureHashes picture_hashes(const RenderSettings& settings) {
    const std::string& environment = settings.image.environment;
    const std::string& aperture = settings.camera.aperture_image;
    return {environment.empty() || environment == "sky" ? "" : scene_hash(environment),
            aperture.empty() ? "" : scene_hash(aperture)};
}

std::string settings_json(const RenderSettings& settings, const std::string& scene_name, const std::string& hash,
                          const PictureHashes& pictures) {
    const auto& [image, camera, shutter, animation, method] = settings;
    Json json;
    json["scene"] = scene_name;
    json["scene_hash"] = hash;
    json["resolution"] = {image.width, image.height};
    json["spp"] = image.spp;
    put(json, "target_error", image.target_error);
    if (image.target_error) json["max_spp"] = image.max_spp;
    json["filter"] = name_of(image.filter);
    put(json, "crop", image.crop);
    json["exposure"] = image.exposure;
    json["tonemap"] = name_of(image.tonemap);
    put(json, "background", image.background);
    for (const Aov aov : image.aovs) json["aovs"].push_back(aov_info(aov).name);
    if (image.flow_step != 1.0) json["flow_step"] = image.flow_step;
    put(json, "environment", file_name(image.environment));
    put(json, "environment_hash", pictures.environment);
    put(json, "camera", camera.camera);
    put(json, "focal_length_mm", camera.focal_length_mm);
    put(json, "sensor_width_mm", camera.sensor_width_mm);
    json["defocus"] = camera.defocus;
    put(json, "fstop", camera.fstop);
    put(json, "lens_radius", camera.lens_radius);
    put(json, "focus_distance", camera.focus_distance);
    put(json, "focus_object", camera.focus_object);
    put(json, "focus_pixel", camera.focus_pixel);
    put(json, "aperture_blades", camera.aperture_blades);
    put(json, "aperture_rotation_deg", camera.aperture_rotation_deg);
    put(json, "aperture_roundness", camera.aperture_roundness);
    put(json, "aperture_ratio", camera.aperture_ratio);
    put(json, "aperture_image", file_name(camera.aperture_image));
    put(json, "aperture_image_hash", pictures.aperture_image);
    put(json, "cats_eye", camera.cats_eye);
    put(json, "tilt_deg", camera.tilt_deg);
    put(json, "swing_deg", camera.swing_deg);
    put(json, "focus_range", camera.focus_range);
    put(json, "max_foreground_blur", camera.max_foreground_blur);
    put(json, "camera_offset", camera.offset);
    put(json, "camera_offset_before", camera.offset_before);
    put(json, "camera_offset_after", camera.offset_after);
    json["motion_blur"] = shutter.motion_blur;
    put(json, "shutter", shutter.shutter);
    json["shutter_position"] = name_of(shutter.position);
    for (const auto& [t, open] : shutter.curve) json["shutter_curve"].push_back({t, open});
    json["rolling_shutter"] = name_of(shutter.rolling);
    put(json, "rolling_shutter_duration", shutter.rolling_duration);
    json["motion_segments"] = shutter.motion_segments;
    json["fps"] = animation.fps;
    json["animation"] = animation.animation;
    json["visibility"] = name_of(method.visibility);
    if (has(image.aovs, Aov::kSte) || loses_samples(method.culling))
        json["culling"] = method.culling;  // else it changes no pixel
    json["shading"] = method.shading;
    if (method.backend == Backend::kGl && method.shading == "pixel") json["backend"] = "gl";  // it shades, and rounds
    json["texture_filter"] = method.texture_filter == TextureFilter::kOff     ? "off"
                             : method.texture_filter == TextureFilter::kPixel ? "pixel"
                                                                              : "full";
    json["brdf"] = method.brdf == BrdfModel::kBurley ? "burley" : "gltf";
    json["transparency"] = method.transparency == Transparency::kABuffer ? "a-buffer" : "stochastic";
    json["shadows"] = name_of(method.shadows);
    json["sampler"] = name_of(method.sampler);
    json["seed"] = method.seed;
    return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace pentaprism
