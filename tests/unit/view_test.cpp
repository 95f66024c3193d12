// Camera, lens and shutter in numbers worked out by hand, and the thin lens against rays through it.
#include "camera/view.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <pentaprism/error.h>

#include "camera/look.h"
#include "frame/frame.h"
#include "support/random.h"
#include "support/scenes.h"

namespace pentaprism {
namespace {

using support::add_camera;
using support::add_node;
using support::add_square;
using support::animate;
using support::Random;

// 90 degrees high: the focal length is half the picture's height.
Camera right_angle() {
    Camera camera;
    camera.yfov = std::numbers::pi / 2;
    camera.znear = 0.1;
    return camera;
}

RenderSettings picture(int width, int height) {
    RenderSettings settings;
    settings.image.width = width;
    settings.image.height = height;
    return settings;
}

TEST(View, TakesTheFocalLengthInPixelsFromTheFieldOfViewOrTheSensor) {
    Scene scene;
    add_camera(scene, "eye", {}, right_angle());
    RenderSettings settings = picture(300, 200);
    View view = make_view(scene, settings, 0);
    EXPECT_NEAR(view.fx, 100, 1e-9);
    EXPECT_NEAR(view.fy, 100, 1e-9);
    EXPECT_NEAR(view.focal_length_mm, 12, 1e-9) << "100 of 300 pixels of a 36 mm sensor";
    EXPECT_DOUBLE_EQ(view.w_near(), 0.1);
    settings.camera.focal_length_mm = 50;
    view = make_view(scene, settings, 0);
    EXPECT_NEAR(view.fx, 50.0 * 300 / 36, 1e-9);
    EXPECT_NEAR(view.focal_length_mm, 50, 1e-9);
    settings.camera.sensor_width_mm = 24;
    EXPECT_NEAR(make_view(scene, settings, 0).fx, 50.0 * 300 / 24, 1e-9);
}

TEST(View, AFocalLengthInTheFileSaysHowWideTheSensorIs) {
    Scene scene;
    Camera camera = right_angle();
    camera.lens.focal_length_mm = 50;
    camera.lens.fstop = 2;
    camera.lens.focus_distance = 4;
    add_camera(scene, "eye", {}, camera);
    RenderSettings settings = picture(300, 200);
    const View view = make_view(scene, settings, 0);
    EXPECT_NEAR(view.fx, 100, 1e-9) << "the field of view is the camera's";
    EXPECT_NEAR(view.focal_length_mm, 50, 1e-9);
    EXPECT_NEAR(view.lens.radius, 0.0125, 1e-12) << "50 mm / (2 * 2)";
    EXPECT_NEAR(make_view(scene, picture(200, 200), 0).lens.radius, 0.0125, 1e-12) << "whatever the picture's shape";
    settings.camera.focal_length_mm = 100;
    EXPECT_NEAR(make_view(scene, settings, 0).fx, 200, 1e-9) << "twice as long, twice as large";
    settings.camera.focal_length_mm.reset();
    settings.camera.sensor_width_mm = 36;
    EXPECT_NEAR(make_view(scene, settings, 0).focal_length_mm, 12, 1e-9) << "the command line counts more";
    settings.camera.sensor_width_mm.reset();
    scene.cameras[0].lens.sensor_width_mm = 36;
    EXPECT_NEAR(make_view(scene, settings, 0).focal_length_mm, 12, 1e-9) << "and so does the sensor itself";
}

TEST(View, ACameraOfNoSizeLooksNowhere) {
    Scene scene;
    add_camera(scene, "eye", {}, right_angle());
    scene.nodes[0].transform.scale = {2, 0.5, 3};
    EXPECT_NO_THROW(make_view(scene, picture(30, 20), 0)) << "a camera has no scale";
    scene.nodes[0].transform.scale = {1, 0, 1};
    const View view = make_view(scene, picture(30, 20), 0);
    EXPECT_THROW(world_to_camera(view, evaluate(scene, {}, 0)), Error);
}

TEST(View, TakesTheLensRadiusFromTheFStop) {
    Scene scene;
    add_camera(scene, "eye", {}, right_angle());
    RenderSettings settings = picture(360, 200);
    EXPECT_TRUE(make_view(scene, settings, 0).lens.pinhole());
    settings.camera.focal_length_mm = 50;
    settings.camera.fstop = 2;
    settings.camera.focus_distance = 4;
    const View view = make_view(scene, settings, 0);
    EXPECT_NEAR(view.lens.radius, 0.0125, 1e-12) << "50 mm / (2 * 2)";
    EXPECT_NEAR(view.lens.a, -0.0125 * 500, 1e-9);
    EXPECT_NEAR(view.lens.b, 0.0125 * 500 / 4, 1e-9);
    settings.camera.fstop.reset();
    settings.camera.lens_radius = 0.025;
    EXPECT_NEAR(make_view(scene, settings, 0).lens.fstop, 1.0, 1e-9) << "the same number the other way round";
    settings.camera.defocus = false;
    EXPECT_TRUE(make_view(scene, settings, 0).lens.pinhole());
}

TEST(View, PrefersTheSettingsToWhatTheFileSaysOfTheLens) {
    Scene scene;
    Camera camera = right_angle();
    camera.lens.fstop = 4;
    camera.lens.focus_distance = 3;
    camera.lens.sensor_width_mm = 30;
    camera.lens.aperture_blades = 6;
    add_camera(scene, "eye", {}, camera);
    RenderSettings settings = picture(200, 200);
    View view = make_view(scene, settings, 0);
    EXPECT_NEAR(view.lens.radius, 0.015 / 8, 1e-12) << "half of 30 mm, f/4";
    EXPECT_DOUBLE_EQ(view.lens.focus_distance, 3);
    EXPECT_EQ(view.lens.blades, 6);
    settings.camera.fstop = 8;
    settings.camera.focus_distance = 5;
    settings.camera.aperture_blades = 0;
    view = make_view(scene, settings, 0);
    EXPECT_NEAR(view.lens.radius, 0.015 / 16, 1e-12);
    EXPECT_DOUBLE_EQ(view.lens.focus_distance, 5);
    EXPECT_EQ(view.lens.blades, 0);
}

// Where the film sees the camera-space point p through lens point (u, v): the ray from the lens through p meets the
// plane of focus at q, and a thin lens images all rays through q to the same place, that of the ray through its centre.
glm::dvec2 through_thin_lens(const View& view, const glm::dvec3& p, double u, double v) {
    const double focus = view.lens.focus_distance, depth = -p.z;
    const glm::dvec2 lens = view.lens.radius * glm::dvec2(u, v);
    const glm::dvec2 q = lens + (glm::dvec2(p) - lens) * (focus / depth);
    return {view.fx * q.x / focus, view.fy * q.y / focus};
}

TEST(Lens, AgreesWithRaysThroughAThinLens) {
    Random r(61);
    Scene scene;
    add_camera(scene, "eye", {}, right_angle());
    for (int i = 0; i < 200; ++i) {
        RenderSettings settings = picture(r.between(100, 2000), r.between(100, 2000));
        settings.camera.lens_radius = r.magnitude(1e-4, 0.3);
        settings.camera.focus_distance = r.magnitude(0.2, 50);
        const View view = make_view(scene, settings, 0);
        const glm::dvec3 p(r.range(-3, 3), r.range(-3, 3), -r.magnitude(0.2, 100));
        const double u = r.range(-1, 1), v = r.range(-1, 1);
        const glm::dvec4 clip = to_raster_clip(view, p);
        EXPECT_DOUBLE_EQ(clip.z, -p.z);
        EXPECT_DOUBLE_EQ(clip.w, -p.z);
        const double c = view.lens.a + view.lens.b * clip.w;
        const glm::dvec2 expected = through_thin_lens(view, p, u, v);
        const double scale = 1 + std::abs(expected.x) + std::abs(expected.y) + std::abs(c / clip.z);
        EXPECT_NEAR((clip.x + u * c) / clip.z, expected.x, 1e-9 * scale);
        EXPECT_NEAR((clip.y + v * c) / clip.z, expected.y, 1e-9 * scale);
    }
}

TEST(Lens, IsSharpAtTheFocusAndTurnsTheImageOverInFrontOfIt) {
    Scene scene;
    add_camera(scene, "eye", {}, right_angle());
    RenderSettings settings = picture(200, 200);
    settings.camera.lens_radius = 0.1;
    settings.camera.focus_distance = 2;
    const Lens lens = make_view(scene, settings, 0).lens;
    EXPECT_DOUBLE_EQ(lens.a + lens.b * 2, 0);
    EXPECT_NEAR((lens.a + lens.b * 1) / 1, -10 * (1 - 0.5), 1e-12) << "A fx (w - F) / (F w)";
    EXPECT_NEAR((lens.a + lens.b * 4) / 4, 10 * 0.25, 1e-12);
    EXPECT_NEAR((lens.a + lens.b * 1e9) / 1e9, 5, 1e-6) << "far away it tends to A fx / F";
}

TEST(Focus, IsAtTheNodeOrPixelAskedForOrAtWhatIsSeenInTheMiddle) {
    Scene scene;
    add_camera(scene, "eye", {0, 0, 1}, right_angle());
    add_square(scene, "near", {0, 0, -2}, 0.5f);
    add_square(scene, "far", {3, 0, -6}, 0.5f);
    RenderSettings settings = picture(200, 200);
    settings.camera.fstop = 2;
    EXPECT_NEAR(make_view(scene, settings, 0).lens.focus_distance, 3, 1e-9);
    settings.camera.focus_object = "far";
    EXPECT_NEAR(make_view(scene, settings, 0).lens.focus_distance, 7, 1e-9);
    settings.camera.focus_object.clear();
    settings.camera.focus_pixel = {{100 + 100.0 * 3 / 7, 100}};
    EXPECT_NEAR(make_view(scene, settings, 0).lens.focus_distance, 7, 1e-9);
    settings.camera.focus_pixel = {{5, 5}};
    EXPECT_THROW(make_view(scene, settings, 0), Error) << "nothing is seen there";
    settings.camera.focus_pixel.reset();
    settings.camera.focus_object = "no such node";
    EXPECT_THROW(make_view(scene, settings, 0), Error);
    add_node(scene, "behind", {0, 0, 9});
    settings.camera.focus_object = "behind";
    EXPECT_THROW(make_view(scene, settings, 0), Error);
}

TEST(Focus, FollowsANodeThatMovesToWhereItIsAtMidShutter) {
    Scene scene;
    add_camera(scene, "eye", {}, right_angle());
    const Index node = add_square(scene, "runner", {0, 0, -2}, 0.5f);
    animate(scene, node, ChannelPath::kTranslation, {0, 1}, {0, 0, -2, 0, 0, -10});
    RenderSettings settings = picture(200, 200);
    settings.camera.fstop = 2;
    settings.camera.focus_object = "runner";
    settings.animation.fps = 24;
    EXPECT_NEAR(make_view(scene, settings, 12).lens.focus_distance, 6, 1e-6);
    settings.shutter.position = ShutterPosition::kStart;  // open from 12 / 24 s for half a frame
    EXPECT_NEAR(make_view(scene, settings, 12).lens.focus_distance, 2 + 8 * (12.25 / 24), 1e-6);
}

TEST(Shutter, IsOpenAroundBeforeOrAfterTheFrameTime) {
    Scene scene;
    add_camera(scene, "eye", {}, right_angle());
    RenderSettings settings = picture(64, 64);
    settings.animation.fps = 25;
    auto expect_open = [&](double open, double close) {
        const Shutter shutter = make_view(scene, settings, 10).shutter;
        EXPECT_NEAR(shutter.open * 25, open, 1e-9);
        EXPECT_NEAR(shutter.close * 25, close, 1e-9);
    };
    expect_open(9.75, 10.25);
    settings.shutter.shutter = 0.8;
    expect_open(9.6, 10.4);
    settings.shutter.position = ShutterPosition::kStart;
    expect_open(10, 10.8);
    settings.shutter.position = ShutterPosition::kEnd;
    expect_open(9.2, 10);
    settings.shutter.motion_blur = false;
    expect_open(9.6, 9.6);
}

TEST(View, OfAnOrthographicCameraKeepsPlacesAndShearsByTheSameSlope) {
    Scene scene;
    Camera camera;
    camera.perspective = false;
    camera.ymag = 2;
    camera.znear = 0.5;
    add_camera(scene, "plan", {}, camera);
    RenderSettings settings = picture(300, 200);
    settings.camera.lens_radius = 0.1;
    settings.camera.focus_distance = 4;
    const View view = make_view(scene, settings, 0);
    EXPECT_FALSE(view.perspective);
    EXPECT_DOUBLE_EQ(view.fx, 50);
    EXPECT_DOUBLE_EQ(view.w_near(), 0.5);
    const glm::dvec4 clip = to_raster_clip(view, {1, -0.5, -8});
    EXPECT_EQ(clip, glm::dvec4(50, -25, 1, 8));
    EXPECT_NEAR(view.lens.a + view.lens.b * clip.w, 0.1 * 50 * (8 - 4) / 4, 1e-12);
    settings.camera.lens_radius.reset();
    settings.camera.fstop = 2;
    EXPECT_THROW(make_view(scene, settings, 0), Error) << "no focal length, so no f-stop";
    settings.camera.fstop.reset();
    EXPECT_NO_THROW(make_view(scene, settings, 0));
    settings.camera.focal_length_mm = 50;
    EXPECT_THROW(make_view(scene, settings, 0), Error) << "it would change nothing";
    settings.camera.focal_length_mm.reset();
    settings.camera.sensor_width_mm = 24;
    EXPECT_THROW(make_view(scene, settings, 0), Error);
}

TEST(View, FindsACameraByNameOrIndexAndFramesASceneWithoutOne) {
    Scene scene;
    add_square(scene, "thing", {5, 6, 7}, 1);
    View view = make_view(scene, picture(200, 100), 0);
    EXPECT_EQ(view.camera_node, kNone);
    const glm::dvec4 clip = to_raster_clip(view, glm::dvec3(view.fixed_world_to_camera * glm::dvec4(5, 6, 7, 1)));
    EXPECT_GT(clip.w, view.depth_near);
    EXPECT_NEAR(clip.x / clip.z, 0, 1e-6);
    EXPECT_NEAR(clip.y / clip.z, 0, 1e-6);
    add_camera(scene, "one", {}, right_angle());
    add_camera(scene, "two", {}, right_angle());
    RenderSettings settings = picture(200, 100);
    EXPECT_EQ(make_view(scene, settings, 0).camera_name, "one");
    for (const char* wanted : {"two", "two camera", "1"}) {
        settings.camera.camera = wanted;
        EXPECT_EQ(make_view(scene, settings, 0).camera_name, "two") << wanted;
    }
    settings.camera.camera = "three";
    EXPECT_THROW(make_view(scene, settings, 0), Error);
}

// ---- Motion segments
// ---------------------------------------------------------------------------------------------------

struct Wheel {
    Scene scene;
    RenderSettings settings = picture(400, 400);
    // A square of 1 m on each side of the axle, 2 m in front of the camera: corners at sqrt(2) * 100 pixels from the
    // middle.
    explicit Wheel(double turns_per_second) {
        add_camera(scene, "eye", {}, right_angle());
        const Index node = add_square(scene, "wheel", {0, 0, -2}, 1);
        std::vector<float> times, values;
        for (int k = 0; k <= 240; ++k) {
            const double half = turns_per_second * k / 240 * std::numbers::pi;
            times.push_back(static_cast<float>(k / 240.0));
            for (const double q : {0.0, 0.0, std::sin(half), std::cos(half)}) values.push_back(static_cast<float>(q));
        }
        animate(scene, node, ChannelPath::kRotation, times, values);
        settings.animation.fps = 24;
    }
    Frame frame() const {
        const std::vector<Index> clips = choose_animations(scene, "all");
        return pose_frame(scene, make_view(scene, settings, 12), clips, settings.shutter);
    }
};

// Largest distance in pixels of the frame's paths from the wheel's circle.
double chord_error(const Frame& frame) {
    const double radius = std::sqrt(2.0) * 100;
    double worst = 0;
    for (std::uint32_t triangle = 0; triangle < frame.triangle_count(); ++triangle)
        for (int segment = 0; segment < frame.parts[0].segments; ++segment) {
            const MovingTriangle m = moving_triangle(frame, triangle, segment);
            for (int i = 0; i < 3; ++i)
                for (int step = 0; step <= 16; ++step) {
                    const double s = step / 16.0, w = m.w[i][0] + s * (m.w[i][1] - m.w[i][0]);
                    const double x = (m.x[i][0] + s * (m.x[i][1] - m.x[i][0])) / w,
                                 y = (m.y[i][0] + s * (m.y[i][1] - m.y[i][0])) / w;
                    worst = std::max(worst, std::abs(std::hypot(x, y) - radius));
                }
        }
    return worst;
}

TEST(MotionSegments, KeepASpinningWheelWithinATenthOfAPixel) {
    int last = 0;
    for (const double turns : {0.5, 2.0, 8.0}) {
        const Frame frame = Wheel(turns).frame();
        ASSERT_EQ(frame.parts.size(), 1u);
        EXPECT_LT(chord_error(frame), 0.1) << turns << " turns a second";
        EXPECT_GT(frame.parts[0].segments, last) << turns << " turns a second: faster needs more";
        last = frame.parts[0].segments;
    }
}

TEST(MotionSegments, AreAsManyAsAskedForAndOneForASlowWheel) {
    Wheel wheel(2);
    wheel.settings.shutter.motion_segments = 3;
    const Frame frame = wheel.frame();
    EXPECT_EQ(frame.parts[0].segments, 3);
    EXPECT_EQ(frame.points.size(), 4u * 4);
    EXPECT_GT(chord_error(frame), 0.1) << "three are too few: the error can be seen by this test";
    EXPECT_EQ(Wheel(0.01).frame().parts[0].segments, 1);
}

TEST(MotionSegments, AreNoneWhereNothingMovesOrNothingMay) {
    Wheel wheel(2);
    wheel.settings.shutter.motion_blur = false;
    EXPECT_FALSE(wheel.frame().parts[0].moves);
    EXPECT_EQ(wheel.frame().points.size(), 4u);
    EXPECT_FALSE(Wheel(0).frame().parts[0].moves);
}

TEST(Frame, OfAStillShutterIsTheSceneAtMidShutter) {
    Wheel wheel(2);
    wheel.settings.shutter.motion_blur = false;
    const Frame still = wheel.frame();
    wheel.settings.shutter.motion_blur = true;
    wheel.settings.shutter.motion_segments = 2;
    const Frame moving = wheel.frame();
    for (std::size_t i = 0; i < 4; ++i)
        EXPECT_EQ(still.points[i], moving.points[4 + i]) << "knot 1 of 2 is mid-shutter";
}

}  // namespace
}  // namespace pentaprism
