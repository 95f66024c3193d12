// What RenderSettings may hold.

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <pentaprism/aov.h>
#include <pentaprism/error.h>
#include <pentaprism/settings.h>

#include "camera/visibility_name.h"

namespace pentaprism {
namespace {

[[noreturn]] void refuse(const std::string& message) {
    throw Error(ErrorKind::kUsage, message);
}

void check_whole(const char* option, int value, int least, int most) {
    if (value < least || value > most) refuse(fmt::format("{}: {} is not from {} to {}", option, value, least, most));
}

void check_finite(const char* option, double value) {
    if (!std::isfinite(value)) refuse(fmt::format("{}: {} is not a finite number", option, value));
}

void check_above(const char* option, const std::optional<double>& value, double bound) {
    if (!value) return;
    check_finite(option, *value);
    if (*value <= bound) refuse(fmt::format("{}: {} is not above {}", option, *value, bound));
}

void check_from(const char* option, const std::optional<double>& value, double least, double most) {
    if (!value) return;
    check_finite(option, *value);
    if (*value < least || *value > most)
        refuse(fmt::format("{}: {} is not from {} to {}", option, *value, least, most));
}

void check(const ImageSettings& image) {
    check_whole("--resolution", image.width, 1, 16384);
    check_whole("--resolution", image.height, 1, 16384);
    check_whole("--spp", image.spp, 1, 4096);
    check_above("--target-error", image.target_error, 0.0);
    check_from("--target-error", image.target_error, 0.0, 1.0);
    check_whole("--max-spp", image.max_spp, 1, 4096);
    if (image.target_error && image.max_spp < image.spp)
        refuse(fmt::format("--max-spp {}: it is less than --spp {}, the fewest samples of a pixel", image.max_spp,
                           image.spp));
    check_from("--exposure", image.exposure, -100.0, 100.0);
    check_from("flow step", image.flow_step, 0.0, 1e6);
    if (image.background) {
        for (const float value : *image.background) check_from("--background", value, 0.0, 65504.0);
    }
    for (std::size_t i = 0; i < image.aovs.size(); ++i)
        if (std::find(image.aovs.begin(), image.aovs.begin() + i, image.aovs[i]) != image.aovs.begin() + i)
            refuse("--aov: an output is named twice");
    if (!image.crop) return;
    const auto [x0, x1, y0, y1] = *image.crop;
    const std::string crop = fmt::format("--crop {},{},{},{}", x0, x1, y0, y1);
    if (x0 >= x1 || y0 >= y1) refuse(crop + ": nothing is left; X0 < X1 and Y0 < Y1 are wanted");
    if (x0 < 0 || y0 < 0 || x1 > image.width || y1 > image.height) {
        refuse(fmt::format("{}: it reaches out of the {}x{} picture", crop, image.width, image.height));
    }
}

void check(const CameraSettings& camera, const ImageSettings& image) {
    constexpr double kHuge = 1e9;
    check_above("--focal-length", camera.focal_length_mm, 0.0);
    check_above("--sensor-width", camera.sensor_width_mm, 0.0);
    check_above("--fstop", camera.fstop, 0.0);
    check_from("--lens-radius", camera.lens_radius, 0.0, kHuge);
    check_above("--focus-distance", camera.focus_distance, 0.0);
    check_from("--aperture-rotation", camera.aperture_rotation_deg, -kHuge, kHuge);
    check_from("--aperture-roundness", camera.aperture_roundness, 0.0, 1.0);
    check_above("--aperture-ratio", camera.aperture_ratio, 0.0);
    check_from("--tilt", camera.tilt_deg, -89.0, 89.0);
    check_from("--swing", camera.swing_deg, -89.0, 89.0);
    check_from("--cats-eye", camera.cats_eye, 0.0, 1.5);
    if (!camera.aperture_image.empty() && camera.aperture_blades)
        refuse("--aperture-image and --aperture-blades exclude each other; give one of them");
    if (!camera.aperture_image.empty() && camera.aperture_roundness)
        refuse("--aperture-image has no blades to curve; leave --aperture-roundness out");
    check_from("--max-foreground-blur", camera.max_foreground_blur, 0.0, kHuge);
    if (camera.focus_range) {
        const auto [from, to] = *camera.focus_range;
        check_above("--focus-range", from, 0.0);
        check_finite("--focus-range", to);
        if (from > to) refuse(fmt::format("--focus-range {},{}: the nearest depth comes first", from, to));
        if (camera.focus_distance && (*camera.focus_distance < from || *camera.focus_distance > to)) {
            refuse(
                fmt::format("--focus-range {},{}: --focus-distance {} lies outside", from, to, *camera.focus_distance));
        }
    }
    for (const CameraOffset* offset : {&camera.offset, &camera.offset_before, &camera.offset_after})
        for (int axis = 0; axis < 3; ++axis) {
            check_from("camera offset", offset->shift_m[axis], -kHuge, kHuge);
            check_from("camera offset", offset->turn_deg[axis], -360.0, 360.0);
        }
    if (camera.fstop && camera.lens_radius)
        refuse("--fstop and --lens-radius say the same in two ways; give one of them");
    if (int{camera.focus_distance.has_value()} + int{!camera.focus_object.empty()} +
            int{camera.focus_pixel.has_value()} >
        1) {
        refuse("--focus-distance, --focus-object and --focus-pixel exclude each other; give one of them");
    }
    if (camera.aperture_blades && (*camera.aperture_blades < 0 || *camera.aperture_blades == 1 ||
                                   *camera.aperture_blades == 2 || *camera.aperture_blades > 64)) {
        refuse(fmt::format("--aperture-blades: {} is neither 0 (a disk) nor from 3 to 64", *camera.aperture_blades));
    }
    if (camera.focus_pixel) {
        const auto [x, y] = *camera.focus_pixel;
        check_finite("--focus-pixel", x);
        check_finite("--focus-pixel", y);
        if (x < 0.0 || y < 0.0 || x >= image.width || y >= image.height) {
            refuse(
                fmt::format("--focus-pixel {},{}: it lies outside the {}x{} picture", x, y, image.width, image.height));
        }
    }
}

void check(const ShutterSettings& shutter) {
    check_from("--shutter", shutter.shutter, 0.0, 1e6);
    check_whole("--motion-segments", shutter.motion_segments, 0, 64);
    check_from("--rolling-shutter-duration", shutter.rolling_duration, 0.0, 1e6);
    if (shutter.rolling_duration && shutter.rolling == RollingShutter::kNone)
        refuse("--rolling-shutter-duration: nothing rolls; give --rolling-shutter top, bottom, left or right as well");
    if (shutter.curve.empty()) return;
    if (shutter.curve.size() < 2) refuse("--shutter-curve: two points or more are wanted");
    double before = 0.0, light = 0.0;
    for (std::size_t i = 0; i < shutter.curve.size(); ++i) {
        const auto [t, open] = shutter.curve[i];
        if (!(t >= before && t <= 1.0))
            refuse(fmt::format("--shutter-curve: times rise from 0 to 1, but point {} is at {}", i + 1, t));
        if (!(open >= 0.0 && open <= 1e6))
            refuse(fmt::format("--shutter-curve: point {} is open by {}, which is not from 0 to 1e6", i + 1, open));
        if (i > 0) light += 0.5 * (open + shutter.curve[i - 1].open) * (t - before);
        before = t;
    }
    if (!(light > 1e-9)) refuse("--shutter-curve: it lets no light in");
}

void check(const AnimationSettings& animation) {
    check_above("--fps", animation.fps, 0.0);
    check_from("--fps", animation.fps, 0.0, 1e6);
}

void check(const MethodSettings& method) {
    const bool culls =
        method.visibility != VisibilityMethod::kRaytrace && method.visibility != VisibilityMethod::kMicropolygon;
    if (!culls && method.culling != "auto") {
        refuse(fmt::format("--culling {}: --visibility {} has no use for it; leave one of them out", method.culling,
                           name_of(method.visibility)));
    }
    if (!culls && method.backend == Backend::kGl)
        refuse(fmt::format("--backend gl: --visibility {} is the processor's alone", name_of(method.visibility)));
    if (method.backend == Backend::kCpu && method.gl_pipeline != GlPipeline::kAuto)
        refuse("--gl-pipeline: only --backend gl has one; give that, too, or leave it out");
    if (method.shading != "pixel" && method.shading != "sample" && method.shading != "decoupled")
        refuse(fmt::format("--shading: '{}' is not pixel, sample or decoupled", method.shading));
    check_whole("--threads", method.threads, 0, 1024);
    if (method.tile_size != 8 && method.tile_size != 16 && method.tile_size != 32) {
        refuse(fmt::format("tile size: {} is not 8, 16 or 32", method.tile_size));
    }
}

bool has(const std::vector<Aov>& aovs, Aov wanted) {
    return std::find(aovs.begin(), aovs.end(), wanted) != aovs.end();
}

}  // namespace

void validate(const RenderSettings& settings) {
    check(settings.image);
    check(settings.camera, settings.image);
    check(settings.shutter);
    check(settings.animation);
    check(settings.method);
    if (has(settings.image.aovs, Aov::kSte) && settings.method.culling == "auto")
        refuse("--aov ste: the fast path keeps no account of pixels; name a test with --culling, such as hull");
    const bool shares_times = settings.method.visibility == VisibilityMethod::kAccumulation ||
                              settings.method.visibility == VisibilityMethod::kInterleaved;
    if (settings.method.visibility == VisibilityMethod::kRaytrace) {
        const char* shaped = settings.camera.focus_range           ? "--focus-range"
                             : settings.camera.max_foreground_blur ? "--max-foreground-blur"
                                                                   : nullptr;
        if (shaped) refuse(fmt::format("{}: rays are straight, so --visibility raytrace cannot have it", shaped));
    }
    if (settings.image.target_error) {
        if (settings.method.visibility != VisibilityMethod::kStochastic)
            refuse(
                fmt::format("--target-error: with --visibility {} all pixels have the same number of samples; leave "
                            "one of them out",
                            name_of(settings.method.visibility)));
        if (settings.method.backend != Backend::kCpu)
            refuse(
                "--target-error: with --backend gl all pixels have the same number of samples; leave one of them out");
    }
    if (settings.method.transparency == Transparency::kABuffer) {
        if (settings.method.visibility != VisibilityMethod::kStochastic)
            refuse(
                fmt::format("--transparency a-buffer: not with --visibility {}, which finds one surface for a sample",
                            name_of(settings.method.visibility)));
        if (settings.method.backend != Backend::kCpu)
            refuse("--transparency a-buffer: not with --backend gl, which finds one surface for a sample");
        if (has(settings.image.aovs, Aov::kSte))
            refuse("--aov ste: --transparency a-buffer keeps no account of pixels; leave one of them out");
    }
    const auto refuse_shared = [&](const char* option, const char* what) {
        refuse(fmt::format("{}: with --visibility {} all {}; leave one of them out", option,
                           name_of(settings.method.visibility), what));
    };
    if (!shares_times) return;
    if (settings.shutter.rolling != RollingShutter::kNone) refuse_shared("--rolling-shutter", "rows share their times");
    if (settings.camera.cats_eye.value_or(0.0) > 0.0) refuse_shared("--cats-eye", "places share their lens points");
    if (settings.method.sampler != Sampler::kStratified) refuse_shared("--sampler", "pixels share a pattern");
}

}  // namespace pentaprism
