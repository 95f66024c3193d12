#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <nlohmann/json.hpp>
#include <pentaprism/error.h>
#include <pentaprism/randomize.h>

namespace pentaprism {
namespace {

using Json = nlohmann::ordered_json;

// What is drawn, each from a stream of its own: adding a range changes no other setting.
enum class Draw : std::uint64_t {
    kFstop,
    kFocus,
    kShutter,
    kExposure,
    kShiftX,
    kShiftY,
    kShiftZ,
    kTurnX,
    kTurnY,
    kTurnZ
};

// SplitMix64's finalizer (Steele, Lea, Flood 2014).
std::uint64_t mixed(std::uint64_t x) {
    x += 0x9e3779b97f4a7c15u;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return x ^ (x >> 31);
}

// In [0, 1).
double draw(std::uint64_t seed, std::int64_t frame, Draw what) {
    const std::uint64_t word =
        mixed(mixed(mixed(seed) + static_cast<std::uint64_t>(frame)) + static_cast<std::uint64_t>(what));
    return std::ldexp(static_cast<double>(word >> 11), -53);
}

double evenly(const Range& range, double u) {
    return range.low + (range.high - range.low) * u;
}
double evenly_in_log(const Range& range, double u) {
    return range.low * std::pow(range.high / range.low, u);
}

CameraOffset offset_of(const Randomization& r, std::int64_t frame) {
    const auto within = [&](double most, Draw what) { return most * (2.0 * draw(r.seed, frame, what) - 1.0); };
    return {{within(r.camera_shift, Draw::kShiftX), within(r.camera_shift, Draw::kShiftY),
             within(r.camera_shift, Draw::kShiftZ)},
            {within(r.camera_turn, Draw::kTurnX), within(r.camera_turn, Draw::kTurnY),
             within(r.camera_turn, Draw::kTurnZ)}};
}

[[noreturn]] void refuse(const std::string& why) {
    throw Error(ErrorKind::kUsage, "--randomize" + why);
}

struct RangeKey {
    const char* name;
    std::optional<Range> Randomization::*range;
    bool positive;
};
constexpr RangeKey kRanges[] = {{"fstop", &Randomization::fstop, true},
                                {"focus_distance", &Randomization::focus_distance, true},
                                {"shutter", &Randomization::shutter, false},
                                {"exposure", &Randomization::exposure, false}};
struct NumberKey {
    const char* name;
    double Randomization::*number;
    double most;
};
constexpr NumberKey kNumbers[] = {{"camera_shift", &Randomization::camera_shift, 1e9},
                                  {"camera_turn", &Randomization::camera_turn, 180.0}};

Range range_of(const Json& value, const RangeKey& key, const std::string& file) {
    const bool two_numbers = value.is_array() && value.size() == 2 && value[0].is_number() && value[1].is_number();
    const Range range = two_numbers ? Range{value[0].get<double>(), value[1].get<double>()} : Range{1.0, 0.0};
    if (!(range.low <= range.high) || !std::isfinite(range.high - range.low) || (key.positive && !(range.low > 0.0)))
        refuse(fmt::format(" {}: {} is not a range [LOW, HIGH]{}", file, key.name, key.positive ? " above 0" : ""));
    return range;
}

void read_key(const std::string& name, const Json& value, const std::string& file, Randomization& r) {
    std::string names = "seed";
    for (const RangeKey& key : kRanges) {
        if (name == key.name) {
            (r.*key.range) = range_of(value, key, file);
            return;
        }
        names += fmt::format(", {}", key.name);
    }
    for (const NumberKey& key : kNumbers) {
        if (name == key.name) {
            const double number = value.is_number() ? value.get<double>() : -1.0;
            if (!(number >= 0.0 && number <= key.most))
                refuse(fmt::format(" {}: {} is not a number from 0 to {}", file, key.name, key.most));
            r.*key.number = number;
            return;
        }
        names += fmt::format(", {}", key.name);
    }
    if (name != "seed") refuse(fmt::format(" {}: '{}' is not one of {}", file, name, names));
    if (!value.is_number_unsigned()) refuse(fmt::format(" {}: seed is not a whole number from 0 up", file));
    r.seed = value.get<std::uint64_t>();
}

}  // namespace

Randomization read_randomization(const std::string& file) {
    std::ifstream stream(file);
    std::error_code ignored;
    if (!stream || std::filesystem::is_directory(file, ignored)) refuse(fmt::format(" {}: cannot be read", file));
    const Json json = Json::parse(stream, nullptr, false);
    if (!json.is_object()) refuse(fmt::format(" {}: it is no JSON object", file));
    Randomization randomization;
    for (const auto& [name, value] : json.items()) read_key(name, value, file, randomization);
    return randomization;
}

std::string randomization_json(const Randomization& r) {
    Json json{{"seed", r.seed}};
    for (const RangeKey& key : kRanges)
        if (const auto& range = r.*key.range) json[key.name] = {range->low, range->high};
    for (const NumberKey& key : kNumbers)
        if (r.*key.number != 0.0) json[key.name] = r.*key.number;
    return json.dump();
}

void check_randomization(const RenderSettings& settings, const Randomization& r) {
    const auto& [image, camera, shutter, animation, method] = settings;
    const auto twice = [](const char* what, const char* option) {
        refuse(fmt::format(": {} has a range, and {} is given; leave one of them out", what, option));
    };
    if (r.fstop && camera.fstop) twice("fstop", "--fstop");
    if (r.fstop && camera.lens_radius) twice("fstop", "--lens-radius");
    if (r.fstop && !camera.defocus) twice("fstop", "--no-defocus");
    if (r.focus_distance && camera.focus_distance) twice("focus_distance", "--focus-distance");
    if (r.focus_distance && !camera.focus_object.empty()) twice("focus_distance", "--focus-object");
    if (r.focus_distance && camera.focus_pixel) twice("focus_distance", "--focus-pixel");
    if (r.shutter && shutter.shutter) twice("shutter", "--shutter");
    if (r.shutter && !shutter.motion_blur) twice("shutter", "--no-motion-blur");
    // Flow leads from mid-shutter to mid-shutter, which must be known of the neighbours.
    if (r.shutter && shutter.position != ShutterPosition::kCenter) twice("shutter", "--shutter-position");
    for (const bool high : {false, true}) {
        RenderSettings end = settings;
        const auto one = [high](const Range& range) { return high ? range.high : range.low; };
        if (r.fstop) end.camera.fstop = one(*r.fstop);
        if (r.focus_distance) end.camera.focus_distance = one(*r.focus_distance);
        if (r.shutter) end.shutter.shutter = one(*r.shutter);
        if (r.exposure) end.image.exposure += one(*r.exposure);
        try {
            validate(end);
        } catch (const Error& error) {
            refuse(fmt::format(": the ends of a range: {}", error.what()));
        }
    }
}

RenderSettings randomized(const RenderSettings& settings, const Randomization& r, std::int64_t frame) {
    RenderSettings result = settings;
    const auto u = [&](Draw what) { return draw(r.seed, frame, what); };
    if (r.fstop) result.camera.fstop = evenly_in_log(*r.fstop, u(Draw::kFstop));
    if (r.focus_distance) result.camera.focus_distance = evenly_in_log(*r.focus_distance, u(Draw::kFocus));
    if (r.shutter) result.shutter.shutter = evenly(*r.shutter, u(Draw::kShutter));
    if (r.exposure) result.image.exposure += evenly(*r.exposure, u(Draw::kExposure));
    result.camera.offset = offset_of(r, frame);
    result.camera.offset_before = offset_of(r, frame - 1);
    result.camera.offset_after = offset_of(r, frame + 1);
    return result;
}

}  // namespace pentaprism
