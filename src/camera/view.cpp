#include "camera/view.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <glm/gtc/constants.hpp>
#include <glm/gtc/matrix_inverse.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>
#include <pentaprism/error.h>

#include "camera/look.h"

namespace pentaprism {
namespace {

// The node that carries the camera asked for, by camera index, camera name or node name.
Index find_camera_node(const Scene& scene, const std::string& wanted) {
    auto node_with_camera = [&](auto accept) {
        for (Index n = 0; n < static_cast<Index>(scene.nodes.size()); ++n)
            if (scene.nodes[n].visible && scene.nodes[n].camera != kNone && accept(scene.nodes[n])) return n;
        return kNone;
    };
    if (wanted.empty()) {
        for (Index c = 0; c < static_cast<Index>(scene.cameras.size()); ++c)
            if (const Index n = node_with_camera([&](const Node& node) { return node.camera == c; }); n != kNone)
                return n;
        return kNone;
    }
    Index found = node_with_camera(
        [&](const Node& node) { return node.name == wanted || scene.cameras[node.camera].name == wanted; });
    if (found == kNone && wanted.size() < 9 &&
        std::all_of(wanted.begin(), wanted.end(), [](char c) { return c >= '0' && c <= '9'; })) {
        const Index index = std::stoi(wanted);
        found = node_with_camera([&](const Node& node) { return node.camera == index; });
    }
    if (found == kNone) {
        std::string names;
        for (const Node& node : scene.nodes)
            if (node.visible && node.camera != kNone)
                names +=
                    (names.empty() ? "" : ", ") + (node.name.empty() ? scene.cameras[node.camera].name : node.name);
        throw Error(ErrorKind::kUsage, scene.name + ": no camera '" + wanted + "'" +
                                           (names.empty() ? "; the scene has none" : "; there are: " + names));
    }
    return found;
}

// A camera that sees everything that the scene shows at any of a few times of its animation.
void frame_scene(const Scene& scene, std::span<const Index> animations, View& view) {
    double duration = 0.0;
    for (const Index a : animations) duration = std::max(duration, scene.animations[a].duration);
    Box3 box;
    for (int i = 0; i <= 4; ++i) box.extend(bounding_box(scene, evaluate(scene, animations, duration * i / 4), kNone));
    if (box.empty()) box.extend(Box3{glm::dvec3(-1.0), glm::dvec3(1.0)});
    const double radius = std::max(1e-6, 0.5 * glm::length(box.upper - box.lower));
    constexpr double half_angle = 0.35;
    const double shorter_side = std::min(1.0, static_cast<double>(view.width) / view.height);
    const double distance = radius / std::sin(std::atan(std::tan(half_angle) * shorter_side));
    const glm::dvec3 direction = glm::normalize(glm::dvec3(0.45, 0.3, 1.0));
    view.fixed_world_to_camera =
        glm::lookAt(box.centre() + distance * direction, box.centre(), glm::dvec3(0.0, 1.0, 0.0));
    view.fx = view.fy = 0.5 * view.height / std::tan(half_angle);
    view.depth_near = std::max(distance * 1e-3, distance - 1.5 * radius);
    view.depth_far = distance + 4.0 * radius;
    view.camera_name = "framing";
}

void apply_projection(const Camera& camera, View& view) {
    view.perspective = camera.perspective;
    view.depth_near = camera.znear;
    view.depth_far = std::isfinite(camera.zfar) ? camera.zfar : 1e30;
    if (camera.perspective) {
        view.fx = view.fy = 0.5 * view.height / std::tan(0.5 * camera.yfov);
    } else {
        // Pixels are square: the picture's height shows 2 ymag, whatever the aspect the file has in mind.
        view.fx = view.fy = 0.5 * view.height / camera.ymag;
    }
}

// Middle of what is seen: the surface at the middle of the picture, else the middle of the scene.
double default_focus(const Scene& scene, const Pose& pose, const View& view) {
    const double depth = depth_at_pixel(scene, pose, view, 0.5 * view.width, 0.5 * view.height);
    if (std::isfinite(depth)) return depth;
    const Box3 box = bounding_box(scene, pose, kNone);
    if (box.empty()) return 1.0;
    const double centre = -(world_to_camera(view, pose) * glm::dvec4(box.centre(), 1.0)).z;
    return std::max(centre, 2.0 * view.depth_near);
}

double focus_distance(const Scene& scene, const CameraSettings& settings, const LensInfo& info, const Pose& pose,
                      const View& view) {
    if (settings.focus_distance) return *settings.focus_distance;
    if (!settings.focus_object.empty()) {
        const Index node = find_node(scene, settings.focus_object);
        if (node == kNone)
            throw Error(ErrorKind::kUsage, scene.name + ": no node '" + settings.focus_object + "' to focus on");
        const Box3 box = bounding_box(scene, pose, node);
        const glm::dvec3 centre = box.empty() ? glm::dvec3(pose.world[node][3]) : box.centre();
        const double depth = -(world_to_camera(view, pose) * glm::dvec4(centre, 1.0)).z;
        if (!(depth > 0.0))
            throw Error(ErrorKind::kUsage, scene.name + ": node '" + settings.focus_object +
                                               "' is behind the camera, it cannot be in focus");
        return depth;
    }
    if (settings.focus_pixel) {
        const auto [x, y] = *settings.focus_pixel;
        const double depth = depth_at_pixel(scene, pose, view, x, y);
        if (!std::isfinite(depth))
            throw Error(ErrorKind::kUsage,
                        scene.name + ": nothing is seen at --focus-pixel; give a pixel that shows a surface");
        return depth;
    }
    if (info.focus_distance && !settings.focus_range) return *info.focus_distance;
    if (view.lens.sharp_range) {  // a/z + b has opposite values at both ends
        const auto [from, to] = *view.lens.sharp_range;
        return view.perspective ? 2.0 / (1.0 / from + 1.0 / to) : 0.5 * (from + to);
    }
    return default_focus(scene, pose, view);
}

// A camera that says its focal length alone has the sensor that goes with its field of view, as it is before it zooms.
double sensor_width_of(const CameraSettings& settings, const Camera& camera, const View& view) {
    if (settings.sensor_width_mm) return *settings.sensor_width_mm;
    if (camera.lens.sensor_width_mm) return *camera.lens.sensor_width_mm;
    if (!camera.perspective || !camera.lens.focal_length_mm) return 36.0;
    return *camera.lens.focal_length_mm * 2.0 * std::tan(0.5 * camera.yfov) * view.width / view.height;
}

// Focal length and size of the lens.
void resolve_size(const CameraSettings& settings, const LensInfo& info, View& view) {
    Lens& lens = view.lens;
    if (!view.perspective && (settings.focal_length_mm || settings.sensor_width_mm))
        throw Error(ErrorKind::kUsage,
                    "an orthographic camera has neither focal length nor sensor: leave --focal-length and "
                    "--sensor-width out");
    if (settings.focal_length_mm) view.fx = view.fy = *settings.focal_length_mm * view.width / view.sensor_width_mm;
    view.focal_length_mm = view.perspective ? view.fx * view.sensor_width_mm / view.width : 0.0;
    if (!settings.defocus) return;
    if (settings.lens_radius) {
        lens.radius = *settings.lens_radius;
    } else if (settings.fstop || (info.fstop && view.perspective)) {
        if (!view.perspective)
            throw Error(ErrorKind::kUsage,
                        "an orthographic camera has no focal length, so no f-stop: give --lens-radius");
        lens.fstop = settings.fstop ? *settings.fstop : *info.fstop;
        lens.radius = view.focal_length_mm * 1e-3 / (2.0 * lens.fstop);
    }
    if (lens.fstop == 0.0 && view.focal_length_mm > 0.0 && lens.radius > 0.0)
        lens.fstop = view.focal_length_mm * 1e-3 / (2.0 * lens.radius);
}

std::string in_metres(const std::array<double, 2>& range) {
    return fmt::format("{},{}", range[0], range[1]);
}

// What may not come together, wherever it was said.
void check_lens(const Lens& lens) {
    if (lens.sharp_range &&
        (lens.focus_distance < (*lens.sharp_range)[0] || lens.focus_distance > (*lens.sharp_range)[1]))
        throw Error(ErrorKind::kUsage, fmt::format("--focus-range {}: the focus lies outside, at {:.6g} m",
                                                   in_metres(*lens.sharp_range), lens.focus_distance));
    if (lens.tilt == glm::dvec2(0.0)) return;
    if (!lens.straight() || lens.cats_eye > 0.0)
        throw Error(ErrorKind::kUsage, fmt::format("{}: a plane of focus that leans (--tilt, --swing) cannot have it",
                                                   lens.sharp_range      ? "--focus-range"
                                                   : lens.cats_eye > 0.0 ? "--cats-eye"
                                                                         : "--max-foreground-blur"));
    if (!(lens.radius * std::hypot(lens.tilt.x, lens.ratio * lens.tilt.y) < 0.99 * lens.focus_distance))
        throw Error(ErrorKind::kUsage,
                    "--tilt, --swing: the plane of focus cuts the lens; lean it less or focus farther");
}

bool moves_camera(const Scene& scene, std::span<const Index> animations, Index camera) {
    return std::any_of(animations.begin(), animations.end(), [&](Index a) {
        const std::vector<Channel>& channels = scene.animations[a].channels;
        return std::any_of(channels.begin(), channels.end(), [&](const Channel& c) { return c.camera == camera; });
    });
}

// Leans by these angles about the horizontal and the vertical axis: the top, the right side is farther.
glm::dvec2 tilt_of(const CameraSettings& settings, const LensInfo& info) {
    constexpr double degree = std::numbers::pi / 180.0;
    return {-std::tan(degree * settings.swing_deg.value_or(info.swing_deg.value_or(0.0))),
            -std::tan(degree * settings.tilt_deg.value_or(info.tilt_deg.value_or(0.0)))};
}

void resolve_lens(const Scene& scene, const CameraSettings& settings, const LensInfo& info, const Pose& pose,
                  View& view) {
    Lens& lens = view.lens;
    lens.blades = settings.aperture_blades.value_or(info.aperture_blades.value_or(0));
    lens.rotation_deg = settings.aperture_rotation_deg.value_or(info.aperture_rotation_deg.value_or(0.0));
    lens.roundness = settings.aperture_roundness.value_or(0.0);
    lens.ratio = settings.aperture_ratio.value_or(info.aperture_ratio.value_or(1.0));
    if (!settings.aperture_image.empty())
        lens.image = std::make_shared<const ApertureImage>(read_aperture_image(settings.aperture_image));
    resolve_size(settings, info, view);
    if (lens.radius == 0.0) return;
    lens.cats_eye = settings.cats_eye.value_or(info.cats_eye.value_or(0.0));
    lens.tilt = tilt_of(settings, info);
    lens.sharp_range = settings.focus_range ? settings.focus_range : info.focus_range;
    if (const auto most = settings.max_foreground_blur ? settings.max_foreground_blur : info.max_foreground_blur)
        lens.max_foreground_px = *most;
    lens.focus_distance = focus_distance(scene, settings, info, pose, view);
    check_lens(lens);
    lens.focus(view.fx);
}

Shutter resolve_shutter(const RenderSettings& settings, const LensInfo& info, double frame) {
    const double fps = settings.animation.fps;
    const double open_frames = settings.shutter.shutter.value_or(info.shutter.value_or(0.5));
    const RollingShutter rolling = settings.shutter.rolling;
    const double readout_frames =
        rolling == RollingShutter::kNone ? 0.0 : settings.shutter.rolling_duration.value_or(0.5);
    const double all_frames = open_frames + readout_frames;
    double start = frame;
    if (settings.shutter.position == ShutterPosition::kCenter) start -= 0.5 * all_frames;
    if (settings.shutter.position == ShutterPosition::kEnd) start -= all_frames;
    Shutter shutter;
    shutter.open = start / fps;
    shutter.close = (start + all_frames) / fps;
    shutter.curve = ShutterCurve(settings.shutter.curve);
    if (readout_frames > 0.0) {
        shutter.rolling = rolling;
        shutter.exposure_share = open_frames / all_frames;
    }
    if (!settings.shutter.motion_blur) shutter.open = shutter.close = shutter.middle();
    return shutter;
}

// As the scene has it, without an offset.
glm::dmat4 world_to_scene_camera(const View& view, const Pose& pose) {
    if (view.camera_node == kNone) return view.fixed_world_to_camera;
    // A camera ignores its node's scale (glTF 2.0, 3.10): only position and directions count.
    const glm::dmat4& world = pose.world[view.camera_node];
    glm::dmat4 rigid(1.0);
    const glm::dvec3 back = glm::normalize(glm::dvec3(world[2]));
    const glm::dvec3 right = glm::normalize(glm::cross(glm::dvec3(world[1]), back));
    if (!std::isfinite(right.x + right.y + right.z))
        throw Error(
            ErrorKind::kScene,
            fmt::format("the camera {} looks nowhere: its node or one above has a scale of 0", view.camera_name));
    rigid[0] = glm::dvec4(right, 0.0);
    rigid[1] = glm::dvec4(glm::cross(back, right), 0.0);
    rigid[2] = glm::dvec4(back, 0.0);
    rigid[3] = world[3];
    return glm::affineInverse(rigid);
}

// From the scene's camera to one that is shifted and turned.
std::optional<glm::dmat4> offset_matrix(const CameraOffset& offset) {
    if (offset == CameraOffset{}) return std::nullopt;
    const auto& [shift, turn] = offset;
    glm::dmat4 placed = glm::translate(glm::dmat4(1.0), glm::dvec3(shift[0], shift[1], shift[2]));
    placed = glm::rotate(placed, glm::radians(turn[1]), glm::dvec3(0.0, 1.0, 0.0));
    placed = glm::rotate(placed, glm::radians(turn[0]), glm::dvec3(1.0, 0.0, 0.0));
    placed = glm::rotate(placed, glm::radians(turn[2]), glm::dvec3(0.0, 0.0, 1.0));
    return glm::affineInverse(placed);
}

}  // namespace

glm::dmat4 world_to_camera(const View& view, const Pose& pose) {
    const glm::dmat4 to_camera = world_to_scene_camera(view, pose);
    return view.offset ? *view.offset * to_camera : to_camera;
}

View make_view(const Scene& scene, const RenderSettings& settings, double frame) {
    View view;
    view.width = settings.image.width;
    view.height = settings.image.height;
    view.offset = offset_matrix(settings.camera.offset);
    const std::vector<Index> animations = choose_animations(scene, settings.animation.animation);
    view.camera_node = find_camera_node(scene, settings.camera.camera);
    if (view.camera_node == kNone) {
        frame_scene(scene, animations, view);
        view.sensor_width_mm = sensor_width_of(settings.camera, Camera{}, view);
        view.shutter = resolve_shutter(settings, LensInfo{}, frame);
        const Pose middle = evaluate(scene, animations, view.shutter.middle());
        resolve_lens(scene, settings.camera, LensInfo{}, middle, view);
        return view;
    }
    const Index index = scene.nodes[view.camera_node].camera;
    view.shutter = resolve_shutter(settings, scene.cameras[index].lens, frame);
    const Pose middle = evaluate(scene, animations, view.shutter.middle());
    const Camera& camera = camera_at(scene, middle, index);
    apply_projection(camera, view);
    view.sensor_width_mm = sensor_width_of(settings.camera, scene.cameras[index], view);
    const std::string& node_name = scene.nodes[view.camera_node].name;
    view.camera_name = node_name.empty() ? camera.name : node_name;
    view.optics_move = moves_camera(scene, animations, index);
    if (view.optics_move) view.asked = settings.camera;
    resolve_lens(scene, settings.camera, camera.lens, middle, view);
    return view;
}

View view_at(const Scene& scene, const View& view, const Pose& pose) {
    if (!view.optics_move) return view;
    const Camera& camera = camera_at(scene, pose, scene.nodes[view.camera_node].camera);
    View now = view;
    apply_projection(camera, now);
    resolve_size(view.asked, camera.lens, now);
    if (now.lens.radius == 0.0) return now;
    const bool pulls = !view.asked.focus_distance && !view.asked.focus_range && view.asked.focus_object.empty() &&
                       !view.asked.focus_pixel;
    if (pulls && camera.lens.focus_distance) now.lens.focus_distance = *camera.lens.focus_distance;
    check_lens(now.lens);
    now.lens.focus(now.fx);
    return now;
}

LineOfSight line_of_sight(const View& view, double gx, double gy, double u, double v) {
    const Lens& lens = view.lens;
    const glm::dvec2 g(gx, gy), uv(u, v), lean = lens.tilt / glm::dvec2(view.fx, view.fy);
    LineOfSight line{-lens.a * uv, -lens.b * uv};
    (view.perspective ? line.direction : line.origin) += g;
    if (lens.tilt == glm::dvec2(0.0)) return line;
    // (x, y) + uv * b * (lean . (x, y)) is on the line above; so lean . (x, y) is affine in depth, too.
    const double share = lens.b / (1.0 + lens.b * glm::dot(lean, uv));
    line.origin -= share * glm::dot(lean, line.origin) * uv;
    line.direction -= share * glm::dot(lean, line.direction) * uv;
    return line;
}

}  // namespace pentaprism
