// Lenses that are not a thin disk focused at one depth: a range of focus, limited blur, a plane of focus that leans,
// focus and zoom that move while the shutter is open.
#include "camera/lens.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>
#include <numbers>
#include <pentaprism/error.h>

#include "camera/view.h"
#include "frame/frame.h"
#include "sample/aperture.h"
#include "support/random.h"
#include "support/scenes.h"

namespace pentaprism {
namespace {

using support::add_camera;
using support::add_square;
using support::Random;

constexpr double kNear = 0.1;

// 100 pixels high, 90 degrees: fx = 50.
Scene scene_with_camera() {
    Scene scene;
    Camera camera;
    camera.yfov = std::numbers::pi / 2;
    camera.znear = kNear;
    add_camera(scene, "eye", {}, camera);
    return scene;
}

RenderSettings lens_settings() {
    RenderSettings settings;
    settings.image.width = 160;
    settings.image.height = 100;
    settings.camera.lens_radius = 0.2;
    return settings;
}

Lens shaped_lens() {
    Lens lens;
    lens.radius = 0.2;
    lens.focus_distance = 4.0;
    lens.focus(50.0);
    lens.sharp_range = {3.0, 5.0};
    lens.max_foreground_px = 2.5;
    return lens;
}

TEST(Lens, IsSharpInItsRangeRealFarFromItAndLimitedInFront) {
    const Lens lens = shaped_lens();
    for (const double z : {3.0, 3.7, 4.0, 5.0}) EXPECT_EQ(lens.coc(z, true, kNear), 0.0) << z;
    for (const double z : {5.5, 6.0, 30.0}) EXPECT_DOUBLE_EQ(lens.coc(z, true, kNear), lens.a + lens.b * z) << z;
    const double half = 5.25;  // in the middle of the transition
    EXPECT_NEAR(lens.coc(half, true, kNear), 0.5 * (lens.a + lens.b * half), 1e-12);
    // The real radius at 1 m would be 7.5 pixels.
    EXPECT_DOUBLE_EQ(lens.coc(1.0, true, kNear), -2.5);
    EXPECT_DOUBLE_EQ(lens.coc(0.2, true, kNear), -2.5 * 0.2);
}

TEST(Lens, ChangesItsRadiusWithoutASkipAndNeverBackwards) {
    for (const bool perspective : {true, false}) {
        const Lens lens = shaped_lens();
        const auto radius = [&](double z) { return lens.coc(z, perspective, kNear) / (perspective ? z : 1.0); };
        double before = radius(kNear);
        for (double z = kNear; z < 20; z += 1e-4) {
            const double now = radius(z);
            ASSERT_GE(now, before - 1e-12) << z;
            ASSERT_LT(now - before, 1e-2) << "a step at " << z;
            before = now;
        }
    }
    const Lens lens = shaped_lens();
    // In front of the near plane c goes on along its tangent.
    const double at = lens.coc(kNear, true, kNear), step = lens.coc(kNear + 1e-6, true, kNear) - at;
    EXPECT_NEAR(lens.coc(kNear - 1.0, true, kNear), at - 1e6 * step, 1e-6);
}

TEST(View, FocusesARangeWhereBothEndsWouldBlurAlike) {
    const Scene scene = scene_with_camera();
    RenderSettings settings = lens_settings();
    settings.camera.focus_range = {2.0, 6.0};
    const Lens lens = make_view(scene, settings, 0).lens;
    EXPECT_DOUBLE_EQ(lens.focus_distance, 3.0);
    EXPECT_NEAR(lens.a / 2 + lens.b, -(lens.a / 6 + lens.b), 1e-12);
    Scene lens_in_file = scene_with_camera();
    lens_in_file.cameras[0].lens.focus_distance = 7.0;
    EXPECT_DOUBLE_EQ(make_view(lens_in_file, settings, 0).lens.focus_distance, 3.0) << "the command line counts more";
    settings.camera.focus_range.reset();
    lens_in_file.cameras[0].lens.focus_range = {2.0, 6.0};
    EXPECT_THROW(make_view(lens_in_file, settings, 0), Error) << "the focus lies outside";
    settings.camera.defocus = false;
    EXPECT_NO_THROW(make_view(lens_in_file, settings, 0));
}

TEST(Settings, RefuseARangeOfFocusThatIsNone) {
    RenderSettings settings = lens_settings();
    settings.camera.focus_range = {3.0, 2.0};
    EXPECT_THROW(validate(settings), Error);
    settings.camera.focus_range = {0.0, 2.0};
    EXPECT_THROW(validate(settings), Error);
    settings.camera.focus_range = {1.0, 2.0};
    EXPECT_NO_THROW(validate(settings));
    settings.camera.focus_distance = 2.5;
    EXPECT_THROW(validate(settings), Error);
    settings.camera.focus_distance = 1.5;
    EXPECT_NO_THROW(validate(settings));
    settings.method.visibility = VisibilityMethod::kRaytrace;
    EXPECT_THROW(validate(settings), Error) << "rays are straight";
}

// A ray from the lens through what the film's place focuses on: Q on the plane of focus, seen along (gx, gy) from the
// middle of the lens.
TEST(Lens, SeesThroughAPlaneOfFocusThatLeansAsRaysDo) {
    Random r(5);
    const Scene scene = scene_with_camera();
    for (int i = 0; i < 500; ++i) {
        RenderSettings settings = lens_settings();
        settings.camera.focus_distance = r.range(1, 10);
        settings.camera.tilt_deg = r.range(-60, 60);
        settings.camera.swing_deg = r.range(-60, 60);
        settings.camera.aperture_ratio = r.chance(0.5) ? 1.0 : 1.7;
        const View view = make_view(scene, settings, 0);
        const double focus = view.lens.focus_distance;
        const glm::dvec2 raw = aperture_point(
            [&] {
                Lens flat = view.lens;
                flat.tilt = {};
                return flat;
            }(),
            0.3, r.unit());
        const glm::dvec2 uv = view.lens.on_tilted_plane(raw);
        EXPECT_LE(std::hypot(uv.x, uv.y / view.lens.ratio), 1.0 + 1e-12);
        const glm::dvec2 g(r.range(-60, 60), r.range(-40, 40));
        // X = gx w / fx, Y = gy w / fx on the plane w + tilt . (X, Y) = focus.
        const double w = focus / (1.0 + glm::dot(view.lens.tilt, g) / view.fx);
        if (!(w > 0.0)) continue;
        const glm::dvec2 q = g * w / view.fx, from = view.lens.radius * raw;
        for (const double z : {0.3 * w, w, 2.7 * w}) {
            const glm::dvec2 expected = from + (q - from) * (z / w);  // where the ray is at depth z
            const LineOfSight line = line_of_sight(view, g.x, g.y, uv.x, uv.y);
            const glm::dvec2 seen = line.origin + line.direction * z;
            EXPECT_LT(glm::length(seen - view.fx * expected), 1e-8 * (1.0 + glm::length(seen)));
            // The relation of the exact test: x + u c = gx w.
            const double c = view.coc(seen.x, seen.y, z);
            EXPECT_LT(glm::length(seen + uv * c - g * z), 1e-8 * (1.0 + glm::length(g) * z));
        }
    }
}

TEST(Lens, LeansItsTopOrItsRightSideAway) {
    const Scene scene = scene_with_camera();
    RenderSettings settings = lens_settings();
    settings.camera.focus_distance = 4;
    settings.camera.tilt_deg = 45;
    View view = make_view(scene, settings, 0);
    EXPECT_NEAR(view.coc(0, view.fx * 1.0, 5.0), 0.0, 1e-9) << "1 m up, in focus 1 m farther";
    settings.camera.tilt_deg.reset();
    settings.camera.swing_deg = 45;
    view = make_view(scene, settings, 0);
    EXPECT_NEAR(view.coc(view.fx * 1.0, 0, 5.0), 0.0, 1e-9);
    settings.camera.swing_deg = 88;
    EXPECT_THROW(make_view(scene, settings, 0), Error) << "the plane cuts the lens";
    settings.camera.swing_deg = 45;
    settings.camera.max_foreground_blur = 3;
    EXPECT_THROW(make_view(scene, settings, 0), Error) << "not both";
}

void animate_camera(Scene& scene, ChannelPath path, float from, float to) {
    if (scene.animations.empty()) scene.animations.emplace_back();
    Channel channel;
    channel.camera = 0;
    channel.path = path;
    channel.width = 1;
    channel.times = {0, 1};
    channel.values = {from, to};
    scene.animations[0].channels.push_back(channel);
    scene.animations[0].duration = 1;
}

RenderSettings one_second() {
    RenderSettings settings = lens_settings();
    settings.animation.fps = 1;
    settings.shutter.shutter = 1;
    settings.shutter.position = ShutterPosition::kStart;
    return settings;
}

TEST(Frame, PullsTheFocusWhileTheShutterIsOpen) {
    Scene scene = scene_with_camera();
    add_square(scene, "wall", {0, 0, -4}, 1.0f);
    scene.cameras[0].lens.focus_distance = 3.0;
    animate_camera(scene, ChannelPath::kFocusDistance, 2.0f, 4.0f);
    const RenderSettings settings = one_second();
    const View view = make_view(scene, settings, 0);
    EXPECT_DOUBLE_EQ(view.lens.focus_distance, 3.0) << "of mid-shutter";
    const Frame frame = pose_frame(scene, view, choose_animations(scene, "all"), settings.shutter);
    ASSERT_TRUE(frame.parts[0].moves) << "its blur does";
    const int last = frame.parts[0].segments - 1;
    EXPECT_GT(last, 0) << "1 / focus is not straight in time";
    EXPECT_NEAR(moving_triangle(frame, 0, 0).c[0][0], 0.2 * 50 * (4.0 - 2.0) / 2.0, 1e-4);
    EXPECT_NEAR(moving_triangle(frame, 0, last).c[0][1], 0.0, 1e-4);
    EXPECT_EQ(moving_triangle(frame, 0, last).x[0][1], moving_triangle(frame, 0, 0).x[0][0]);
}

TEST(Frame, ZoomsWhileTheShutterIsOpen) {
    Scene scene = scene_with_camera();
    add_square(scene, "wall", {0, 0, -4}, 1.0f);
    const auto fov = [](double f) { return static_cast<float>(2 * std::atan(50.0 / f)); };
    animate_camera(scene, ChannelPath::kYfov, fov(50), fov(100));
    RenderSettings settings = one_second();
    settings.camera.lens_radius.reset();
    settings.camera.fstop = 2.0;
    settings.camera.focus_distance = 8.0;
    const View view = make_view(scene, settings, 0);
    const Frame frame = pose_frame(scene, view, choose_animations(scene, "all"), settings.shutter);
    const MovingTriangle first = moving_triangle(frame, 0, 0),
                         last = moving_triangle(frame, 0, frame.parts[0].segments - 1);
    EXPECT_NEAR(first.x[0][0], -50, 1e-3);
    EXPECT_NEAR(last.x[0][1], -100, 1e-2);
    EXPECT_EQ(first.w[0][0], last.w[0][1]);
    // The f-number stays, so the lens grows with the focal length: twice that and twice the scale.
    EXPECT_NEAR(last.c[0][1] / first.c[0][0], 4.0, 1e-3);
    settings.camera.focal_length_mm = 30;
    const View fixed = make_view(scene, settings, 0);
    const Frame still = pose_frame(scene, fixed, choose_animations(scene, "all"), settings.shutter);
    EXPECT_FALSE(still.parts[0].moves) << "the command line counts more";
}

}  // namespace
}  // namespace pentaprism
