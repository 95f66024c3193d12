#include "scene/gltf_lens.h"

#include <array>
#include <cmath>
#include <fmt/format.h>

namespace pentaprism::gltf {

namespace {

/// Extras are free text to glTF: what is not a usable number is passed over with a warning.
std::optional<double> usable_number(Document& document, const Object& owner, const Json& extras, const char* key,
                                    double low, double high) {
    const auto found = extras.find(key);
    if (found == extras.end()) return std::nullopt;
    if (found->is_number() && found->get<double>() - found->get<double>() == 0.0 && found->get<double>() >= low &&
        found->get<double>() <= high)
        return found->get<double>();
    document.warn(fmt::format("{}, extras, has a {} that is not usable; it is ignored", owner.where(), key));
    return std::nullopt;
}

/// Two depths, the nearer first.
std::optional<std::array<double, 2>> usable_range(Document& document, const Object& owner, const Json& extras,
                                                  const char* key) {
    const auto found = extras.find(key);
    if (found == extras.end()) return std::nullopt;
    if (found->is_array() && found->size() == 2 && (*found)[0].is_number() && (*found)[1].is_number()) {
        const double from = (*found)[0], to = (*found)[1];
        if (from > 0.0 && from <= to && std::isfinite(to)) return std::array{from, to};
    }
    document.warn(fmt::format("{}, extras, has a {} that is not usable; it is ignored", owner.where(), key));
    return std::nullopt;
}

template <class T>
void keep_first(std::optional<T>& value, const std::optional<T>& other) {
    if (!value) value = other;
}

/// EXT_cameras_sensor as OSPRay Studio and its importer define it: imageSensor { pixels, pixelSize } and lens {
/// focalLength, apertureRadius, focusDistance, centerPointShift }, all lengths in metres.
void read_sensor(Document& document, const Object& sensor, LensInfo& lens) {
    constexpr double kMillimetres = 1000.0;
    if (sensor.has("imageSensor")) {
        const Object image = sensor.child("imageSensor");
        const auto pixels = image.numbers("pixels", 2), size = image.numbers("pixelSize", 2);
        if (!pixels.empty() && !size.empty() && pixels[0] * size[0] > 0.0)
            lens.sensor_width_mm = pixels[0] * size[0] * kMillimetres;
    }
    if (!sensor.has("lens")) return;
    const Object glass = sensor.child("lens");
    const double focal_length = glass.number("focalLength", 0.0), radius = glass.number("apertureRadius", 0.0);
    if (focal_length > 0.0) lens.focal_length_mm = focal_length * kMillimetres;
    if (focal_length > 0.0 && radius > 0.0) lens.fstop = focal_length / (2.0 * radius);
    if (focal_length <= 0.0 && radius > 0.0)
        document.warn(glass.where() + " has an apertureRadius but no focalLength; it is ignored");
    if (const double distance = glass.number("focusDistance", 0.0); distance > 0.0) lens.focus_distance = distance;
    for (const double shift : glass.numbers("centerPointShift", 2)) {
        if (shift != 0.0)
            document.warn(glass.where() + " has a centerPointShift, which is not supported; the lens is centred");
    }
}

}  // namespace

void read_lens(Document& document, const Object& owner, LensInfo& lens) {
    if (owner.has_extension("EXT_cameras_sensor")) read_sensor(document, owner.extension("EXT_cameras_sensor"), lens);
    const auto found = owner.json().find("extras");
    if (found == owner.json().end() || !found->is_object()) return;
    const auto number = [&](const char* key, double low, double high = 1e30) {
        return usable_number(document, owner, *found, key, low, high);
    };
    keep_first(lens.fstop, number("fstop", 1e-3));
    keep_first(lens.focus_distance, number("focusDistance", 1e-6));
    keep_first(lens.focal_length_mm, number("focalLength", 1e-3));
    keep_first(lens.sensor_width_mm, number("sensorWidth", 1e-3));
    keep_first(lens.shutter, number("shutter", 0.0));
    keep_first(lens.aperture_rotation_deg, number("apertureRotation", -1e9));
    keep_first(lens.aperture_ratio, number("apertureRatio", 1e-3));
    keep_first(lens.max_foreground_blur, number("maxForegroundBlur", 0.0));
    keep_first(lens.tilt_deg, number("tilt", -89.0, 89.0));
    keep_first(lens.swing_deg, number("swing", -89.0, 89.0));
    keep_first(lens.cats_eye, number("catsEye", 0.0, 1.5));
    keep_first(lens.focus_range, usable_range(document, owner, *found, "focusRange"));
    // 0 is a disk; of one or two blades, or of parts of one, there is no iris.
    if (const auto blades = number("apertureBlades", 0.0, 64.0); blades && !lens.aperture_blades) {
        if (*blades == std::floor(*blades) && *blades != 1.0 && *blades != 2.0)
            lens.aperture_blades = static_cast<int>(*blades);
        else
            document.warn(
                fmt::format("{}, extras, has an apertureBlades that is not usable; it is ignored", owner.where()));
    }
}

}  // namespace pentaprism::gltf
