#include "scene/gltf_lens.h"

#include <fmt/format.h>

namespace pentaprism::gltf {

namespace {

/// Extras are free text to glTF: what is not a usable number is passed over with a warning.
std::optional<double> usable_number(Document& document, const Object& owner, const Json& extras, const char* key,
                                    double low) {
    const auto found = extras.find(key);
    if (found == extras.end()) return std::nullopt;
    if (found->is_number() && found->get<double>() - found->get<double>() == 0.0 && found->get<double>() >= low)
        return found->get<double>();
    document.warn(fmt::format("{}, extras, has a {} that is not usable; it is ignored", owner.where(), key));
    return std::nullopt;
}

void keep_first(std::optional<double>& value, const std::optional<double>& other) {
    if (!value) value = other;
}

}  // namespace

void read_lens(Document& document, const Object& owner, LensInfo& lens) {
    const auto found = owner.json().find("extras");
    if (found == owner.json().end() || !found->is_object()) return;
    const auto number = [&](const char* key, double low) { return usable_number(document, owner, *found, key, low); };
    keep_first(lens.fstop, number("fstop", 1e-3));
    keep_first(lens.focus_distance, number("focusDistance", 1e-6));
    keep_first(lens.focal_length_mm, number("focalLength", 1e-3));
    keep_first(lens.sensor_width_mm, number("sensorWidth", 1e-3));
    keep_first(lens.shutter, number("shutter", 0.0));
    keep_first(lens.aperture_rotation_deg, number("apertureRotation", -1e9));
    keep_first(lens.aperture_ratio, number("apertureRatio", 1e-3));
    if (const auto blades = number("apertureBlades", 0.0); blades && !lens.aperture_blades && *blades <= 1000.0) {
        lens.aperture_blades = static_cast<int>(*blades);
    }
}

}  // namespace pentaprism::gltf
