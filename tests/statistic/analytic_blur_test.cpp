// Whole pictures whose blur is known on paper: a half-plane that sweeps over pixels, the disk of confusion of a small
// square, and both blurs at once. Seen through the alpha channel, which is coverage, with a box filter: a pixel is then
// the mean of its own samples. Bounds are five standard errors of independent samples; ours are stratified and err
// less.
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <pentaprism/render.h>

#include "unit/small_scene.h"

namespace pentaprism {
namespace {

using namespace small_scene;

constexpr int kSize = 64;             // pixels a side
constexpr double kFocal = kSize / 2;  // pixels: the camera sees [-1, 1] at depth 1

RenderSettings settings_with(int spp) {
    RenderSettings settings;
    settings.image.width = settings.image.height = kSize;
    settings.image.spp = spp;
    settings.image.filter = Filter::kBox;
    settings.animation.fps = 1.0;
    return settings;
}

// A square of half width `size` metres whose node moves from `from` at 0 s to `to` at 1 s.
Scene moving_square(float size, glm::vec3 from, glm::vec3 to) {
    Scene scene = scene_with_camera();
    scene.materials.emplace_back();
    scene.materials[0].double_sided = true;
    const Index node = add_mesh(scene, {square(size, 0.0f, 0)});
    Channel channel;
    channel.node = node;
    channel.path = ChannelPath::kTranslation;
    channel.times = {0.0f, 1.0f};
    channel.values = {from.x, from.y, from.z, to.x, to.y, to.z};
    scene.animations.push_back({"move", {channel}, 1.0});
    return scene;
}

Picture picture_of(const Scene& scene, const RenderSettings& settings, double frame = 0.5) {
    RenderStats stats;
    return render_picture(scene, settings, frame, stats);
}

double alpha(const Picture& picture, int x, int y) {
    return picture.rgba[4 * (static_cast<std::size_t>(y) * picture.width + x) + 3];
}

// Coverage as a distribution over the picture: x to the right, y up, pixels from the middle.
struct Moments {
    double energy = 0, x = 0, y = 0, xx = 0, yy = 0, xy = 0, yyy = 0, farthest = 0;
};
Moments moments_of(const Picture& picture) {
    Moments m;
    for (int py = 0; py < kSize; ++py)
        for (int px = 0; px < kSize; ++px) {
            const double a = alpha(picture, px, py), x = px + 0.5 - kSize / 2, y = kSize / 2 - py - 0.5;
            m.energy += a;
            m.x += a * x, m.y += a * y, m.xx += a * x * x, m.yy += a * y * y, m.xy += a * x * y;
            m.yyy += a * y * y * y;
            if (a > 0) m.farthest = std::max(m.farthest, std::hypot(x, y));
        }
    for (double* sum : {&m.x, &m.y, &m.xx, &m.yy, &m.xy, &m.yyy}) *sum /= m.energy;
    return m;
}

// Mean over a pixel [p, p + 1) of a step that moves from e0 to e1: the integral of a clamped ramp.
double swept_coverage(double e0, double e1, double p) {
    const auto integral = [](double e) { return e <= 0 ? 0.0 : e < 1 ? 0.5 * e * e : e - 0.5; };
    return (integral(e1 - p) - integral(e0 - p)) / (e1 - e0);
}

TEST(AnalyticBlur, AHalfPlaneThatSweepsOverPixelsIsARamp) {
    // The right edge of a square 40 metres wide moves from 0.05 m to 0.55 m while the shutter is open.
    const Scene scene = moving_square(20.0f, {-20.2f, 0, -1}, {-19.2f, 0, -1});
    RenderSettings settings = settings_with(64);
    settings.shutter.shutter = 0.5;
    const Picture picture = picture_of(scene, settings);
    for (int px = 0; px < kSize; ++px) {
        double mean = 0;
        for (int py = 0; py < kSize; ++py) mean += alpha(picture, px, py) / kSize;
        const double expected = swept_coverage(kFocal * 0.05, kFocal * 0.55, px - kSize / 2);
        const double sigma = std::sqrt(std::max(1e-9, expected * (1 - expected)) / (64.0 * kSize));
        EXPECT_NEAR(mean, expected, 5 * sigma + 1e-6) << "column " << px;
    }
}

TEST(AnalyticBlur, AShutterThatOpensAndClosesEvenlyMakesTheRampASmoothStep) {
    // Light until t of a triangle that peaks in the middle: 2 t^2, then 1 - 2 (1 - t)^2. The edge is at 0.05 m + 0.5 m
    // * t.
    const Scene scene = moving_square(20.0f, {-20.2f, 0, -1}, {-19.2f, 0, -1});
    RenderSettings settings = settings_with(64);
    settings.shutter.shutter = 0.5;
    settings.shutter.curve = trapezoid_shutter(0.5, 0.5);
    const Picture picture = picture_of(scene, settings);
    for (int px = kSize / 2; px < kSize; ++px) {
        double mean = 0, expected = 0;
        for (int py = 0; py < kSize; ++py) mean += alpha(picture, px, py) / kSize;
        // A point is covered from when the edge has passed it until the shutter closes.
        constexpr int kSteps = 1000;
        for (int i = 0; i < kSteps; ++i) {
            const double x = (px + (i + 0.5) / kSteps - kSize / 2) / kFocal;
            const double t = std::clamp((x - 0.05) / 0.5, 0.0, 1.0);
            expected += (t < 0.5 ? 1 - 2 * t * t : 2 * (1 - t) * (1 - t)) / kSteps;
        }
        const double sigma = std::sqrt(std::max(1e-9, expected * (1 - expected)) / (64.0 * kSize));
        EXPECT_NEAR(mean, expected, 5 * sigma + 1e-5) << "column " << px;
    }
}

TEST(AnalyticBlur, ARollingShutterSlantsAMovingEdgeTowardsTheRowsThatComeLast) {
    // The edge crosses half a metre, 16 pixels, while the rows are read out, and is exposed a tenth as long as that.
    const Scene scene = moving_square(20.0f, {-20.25f, 0, -1}, {-19.25f, 0, -1});
    for (const RollingShutter edge : {RollingShutter::kTop, RollingShutter::kBottom}) {
        RenderSettings settings = settings_with(256);
        settings.shutter.shutter = 0.05;
        settings.shutter.rolling = edge;
        settings.shutter.rolling_duration = 0.5;
        const Picture picture = picture_of(scene, settings);
        for (int py = 0; py < kSize; ++py) {
            double covered = 0, expected = 0;
            for (int px = 0; px < kSize; ++px) covered += alpha(picture, px, py);
            // All is centred about 0.5 s, when the edge is at 0.25 m; a row is 1/64 of the readout.
            const double delay = (py + 0.5) / kSize - 0.5;
            expected = kSize / 2 + kFocal * (0.25 + 0.5 * (edge == RollingShutter::kTop ? delay : -delay));
            // The place of the edge varies evenly by 1.6 pixels over the exposure and a quarter over the row's height,
            // and each sample by a pixel of its own: about two pixels share 256 samples each.
            const double sigma = std::sqrt(2.0 * 0.25 / 256.0);
            EXPECT_NEAR(covered, expected, 5 * sigma) << "row " << py;
        }
    }
}

TEST(AnalyticBlur, ARollingShutterOfNoDurationIsNone) {
    const Scene scene = moving_square(20.0f, {-20.2f, 0, -1}, {-19.2f, 0, -1});
    RenderSettings settings = settings_with(16);
    const Picture plain = picture_of(scene, settings);
    settings.shutter.rolling = RollingShutter::kTop;
    settings.shutter.rolling_duration = 0.0;
    EXPECT_EQ(picture_of(scene, settings).rgba, plain.rgba);
    settings.shutter.rolling_duration = 0.5;
    EXPECT_NE(picture_of(scene, settings).rgba, plain.rgba);
}

// A square of `side` pixels at depth 2 in front of a lens focused elsewhere.
constexpr double kSide = 3.0, kDepth = 2.0;
Scene small_square(double speed_px = 0) {
    const float half = static_cast<float>(0.5 * kSide / kFocal * kDepth);
    const float reach = static_cast<float>(0.5 * speed_px / kFocal * kDepth);
    return moving_square(half, {-reach, 0, -float{kDepth}}, {reach, 0, -float{kDepth}});
}
RenderSettings lens(double radius, double focus) {
    RenderSettings settings = settings_with(1024);
    settings.camera.lens_radius = radius;
    settings.camera.focus_distance = focus;
    return settings;
}
// Thin lens: radius of the circle of confusion in pixels.
double confusion(double radius, double focus) {
    return radius * kFocal * std::abs(kDepth - focus) / (focus * kDepth);
}
constexpr double kHits = kSide * kSide * 1024;

TEST(AnalyticBlur, ASquareOutOfFocusIsADiskWithItsEnergyAndTheRadiusOfTheThinLens) {
    for (const double focus : {1.0, 8.0}) {
        const double lens_radius = focus < kDepth ? 0.8 : 1.1, radius = confusion(lens_radius, focus);
        const Moments m = moments_of(picture_of(small_square(), lens(lens_radius, focus)));
        const double density = kSide * kSide / (std::numbers::pi * radius * radius);
        EXPECT_NEAR(m.energy, kSide * kSide, 5 * kSide * kSide * std::sqrt((1 - density) / kHits)) << "focus " << focus;
        // Disk: a quarter of r^2 in each axis. Square and pixel: a twelfth of their sides' squares.
        const double second = radius * radius / 4 + kSide * kSide / 12 + 1.0 / 12;
        const double error = 5 * radius * radius * std::sqrt(1.0 / 16 / kHits);  // sd of x^2 on a disk is r^2 / 4
        EXPECT_NEAR(m.xx, second, error) << "focus " << focus;
        EXPECT_NEAR(m.yy, second, error) << "focus " << focus;
        EXPECT_NEAR(m.xy, 0, error) << "focus " << focus;
        EXPECT_NEAR(m.x, 0, 5 * radius / 2 / std::sqrt(kHits)) << "focus " << focus;
        EXPECT_NEAR(m.y, 0, 5 * radius / 2 / std::sqrt(kHits)) << "focus " << focus;
        // Nothing beyond the disk of the square's corners (and half a pixel's diagonal), yet it is reached.
        EXPECT_LT(m.farthest, radius + (kSide + 1) / std::numbers::sqrt2) << "focus " << focus;
        EXPECT_GT(m.farthest, radius) << "focus " << focus;
    }
}

TEST(AnalyticBlur, TheApertureStandsUprightBehindTheFocusAndUpsideDownInFrontOfIt) {
    // A triangle is told from its mirror image by its third moment. Behind the focus plane (c > 0) a point is seen at
    // the place of the lens sample that sees it, so the picture of a point shows the aperture as its samples have it.
    RenderSettings behind = lens(0.8, 1.0), front = lens(1.1, 8.0);
    for (RenderSettings* settings : {&behind, &front}) settings->camera.aperture_blades = 3;
    behind.camera.aperture_rotation_deg = front.camera.aperture_rotation_deg = 90.0;
    const double upright = moments_of(picture_of(small_square(), behind)).yyy,
                 inverted = moments_of(picture_of(small_square(), front)).yyy;
    behind.camera.aperture_rotation_deg = 270.0;
    const double turned = moments_of(picture_of(small_square(), behind)).yyy;
    const SampleTable samples(1024, 0, frame_of(small_square(), behind).view.lens, Grouping::kDefocus);
    double aperture = 0;
    for (int i = 0; i < 1024; ++i) aperture += std::pow(samples.sample(0, 0, i).v, 3);
    // A triangle of circumradius r has |E[y^3]| = r^3 / 40 (corner along y).
    const double radius = confusion(0.8, 1.0), expected = std::pow(radius, 3) / 40;
    EXPECT_GT(std::abs(upright), 0.5 * expected);
    EXPECT_LT(upright * inverted, 0) << "not mirrored in front of the focus plane";
    EXPECT_GT(turned * aperture, 0) << "not as the lens has it";
    EXPECT_LT(upright * turned, 0) << "not turned by half a turn";
}

TEST(AnalyticBlur, MotionAndDefocusAddTheirSecondMoments) {
    // 20 pixels in a second, of which the shutter sees half; the disk is the same at all times.
    RenderSettings settings = lens(0.8, 1.0);
    settings.shutter.shutter = 0.5;
    const Moments m = moments_of(picture_of(small_square(20.0), settings));
    const double radius = confusion(0.8, 1.0), swept = 10.0;
    const double second_y = radius * radius / 4 + kSide * kSide / 12 + 1.0 / 12;
    EXPECT_NEAR(m.energy, kSide * kSide, 5 * kSide * kSide / std::sqrt(kHits));
    EXPECT_NEAR(m.yy, second_y, 5 * radius * radius / 4 / std::sqrt(kHits));
    EXPECT_NEAR(m.xx, second_y + swept * swept / 12, 5 * (radius * radius / 4 + swept * swept / 12) / std::sqrt(kHits));
}

TEST(AnalyticBlur, WithoutLensOrShutterTheOtherBlurAloneIsLeftBitForBit) {
    const Scene still = small_square(), moving = small_square(20.0);
    RenderSettings motion = settings_with(16), closed = lens(0.8, 1.0), off = lens(0.8, 1.0);
    closed.image.spp = off.image.spp = 16;
    off.camera.defocus = false;
    EXPECT_EQ(picture_of(moving, motion).rgba, picture_of(moving, off).rgba) << "A = 0 is motion alone";
    closed.shutter.shutter = 0.0;
    off = closed;
    off.shutter.shutter = 0.5;
    off.shutter.motion_blur = false;
    EXPECT_EQ(picture_of(moving, closed).rgba, picture_of(moving, off).rgba) << "a closed shutter is no motion";
    closed.shutter.shutter = 0.5;
    EXPECT_EQ(picture_of(still, closed).rgba, picture_of(still, off).rgba) << "what stands still is not blurred";
    EXPECT_NE(picture_of(moving, closed).rgba, picture_of(moving, off).rgba);
}

}  // namespace
}  // namespace pentaprism
