// Blur as in the tables of Laine & Karras 2011 and Wu 2013: none, motion, defocus, both, and each of them doubled, by
// doubling the time the shutter is open and the radius of the lens.

#include "lab/effects.h"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <fmt/format.h>
#include <pentaprism/error.h>

#include "camera/view.h"

namespace pentaprism {
namespace {

constexpr double kDefaultFstop = 2.8;
constexpr double kLargestFactor = 64.0;
constexpr double kDefaultSlope =
    0.005;  // lens radius over focus distance where there is no f-number: orthographic cameras

std::string description_of(const Scene& scene) {
    for (const BuiltinScene& builtin : builtin_scenes())
        if (scene.name == "builtin:" + std::string(builtin.name)) return std::string(builtin.description);
    return "";
}

}  // namespace

std::vector<BenchEffect> bench_effects() {
    return {{"still", 0, 0},      {"motion", 1, 0}, {"motion-x2", 2, 0}, {"defocus", 0, 1},
            {"defocus-x2", 0, 2}, {"both", 1, 1},   {"both-x2", 2, 2}};
}

BenchEffect find_effect(const std::string& name) {
    std::string names;
    for (const BenchEffect& effect : bench_effects()) {
        if (effect.name == name) return effect;
        names += (names.empty() ? "" : ", ") + effect.name;
        // motion-x8 and the like
        const std::string prefix = effect.name + "-x";
        const bool is_whole = std::max(effect.motion, effect.defocus) == 1.0;
        const std::size_t digits = prefix.size();
        if (!is_whole || name.rfind(prefix, 0) != 0 || name.size() <= digits || !std::isdigit(name[digits])) continue;
        char* end = nullptr;
        const double factor = std::strtod(name.c_str() + digits, &end);
        if (*end == '\0' && factor > 0.0 && factor <= kLargestFactor)
            return {name, effect.motion * factor, effect.defocus * factor};
    }
    throw Error(ErrorKind::kUsage,
                fmt::format("there is no effect '{}'; there are: {}, and others by factors up to {:g}, such as both-x8",
                            name, names, kLargestFactor));
}

BenchScene describe_scene(const Scene& scene, const RenderSettings& settings, double frame) {
    RenderSettings own = settings;
    View view = make_view(scene, own, frame);
    BenchScene description;
    if (view.lens.pinhole()) {
        description.own_lens = false;
        own.camera.defocus = true;
        if (view.perspective) {
            own.camera.fstop = kDefaultFstop;
        } else {
            own.camera.lens_radius = 1.0;  // any lens has the same focus
            own.camera.lens_radius = kDefaultSlope * make_view(scene, own, frame).lens.focus_distance;
        }
        view = make_view(scene, own, frame);
    }
    description.name = scene.name;
    description.description = description_of(scene);
    description.triangles = count_triangles(scene);
    description.frame = frame;
    description.fps = settings.animation.fps;
    description.shutter_frames = (view.shutter.close - view.shutter.open) * settings.animation.fps;
    description.lens_radius = view.lens.radius;
    description.fstop = view.lens.fstop;
    description.focus_distance = view.lens.focus_distance;
    return description;
}

RenderSettings with_effect(RenderSettings settings, const BenchScene& scene, const BenchEffect& effect) {
    settings.shutter.motion_blur = effect.motion > 0.0;
    if (effect.motion > 0.0) settings.shutter.shutter = scene.shutter_frames * effect.motion;
    settings.camera.defocus = effect.defocus > 0.0;
    settings.camera.fstop.reset();
    settings.camera.lens_radius.reset();
    if (effect.defocus > 0.0) settings.camera.lens_radius = scene.lens_radius * effect.defocus;
    return settings;
}

}  // namespace pentaprism
