#include <cmath>
#include <fstream>
#include <glm/gtc/quaternion.hpp>
#include <gtest/gtest.h>
#include <pentaprism/error.h>
#include <pentaprism/randomize.h>
#include <pentaprism/render.h>

#include "camera/view.h"
#include "unit/small_scene.h"

namespace pentaprism {
namespace {

Randomization everything() {
    Randomization r;
    r.seed = 7;
    r.fstop = {1.0, 16.0};
    r.focus_distance = {2.0, 8.0};
    r.shutter = {0.25, 0.75};
    r.exposure = {-1.0, 1.0};
    r.camera_shift = 0.1;
    r.camera_turn = 2.0;
    return r;
}

TEST(Randomization, DrawsFromItsRangesEvenly) {
    const Randomization r = everything();
    constexpr int kFrames = 4000;
    double stops = 0.0, shutter = 0.0, turn = 0.0;
    for (int frame = 0; frame < kFrames; ++frame) {
        const RenderSettings s = randomized({}, r, frame);
        ASSERT_TRUE(*s.camera.fstop >= 1.0 && *s.camera.fstop <= 16.0);
        ASSERT_TRUE(*s.camera.focus_distance >= 2.0 && *s.camera.focus_distance <= 8.0);
        ASSERT_TRUE(*s.shutter.shutter >= 0.25 && *s.shutter.shutter <= 0.75);
        ASSERT_LE(std::abs(s.image.exposure), 1.0);
        for (int axis = 0; axis < 3; ++axis) {
            ASSERT_LE(std::abs(s.camera.offset.shift_m[axis]), 0.1);
            ASSERT_LE(std::abs(s.camera.offset.turn_deg[axis]), 2.0);
        }
        stops += std::log2(*s.camera.fstop) / kFrames;
        shutter += *s.shutter.shutter / kFrames;
        turn += s.camera.offset.turn_deg[2] / kFrames;
    }
    // Five standard errors of the mean of a uniform distribution of that width.
    const double errors = 5.0 / std::sqrt(12.0 * kFrames);
    EXPECT_NEAR(stops, 2.0, 4.0 * errors);
    EXPECT_NEAR(shutter, 0.5, 0.5 * errors);
    EXPECT_NEAR(turn, 0.0, 4.0 * errors);
}

TEST(Randomization, DependsOnTheSeedAndTheFrameAloneAndEachRangeOnItself) {
    const Randomization r = everything();
    EXPECT_EQ(randomized({}, r, 5).camera.fstop, randomized({}, r, 5).camera.fstop);
    EXPECT_NE(randomized({}, r, 5).camera.fstop, randomized({}, r, 6).camera.fstop);
    Randomization other = r;
    other.fstop.reset();
    other.camera_shift = 0.0;
    EXPECT_EQ(randomized({}, r, 5).shutter.shutter, randomized({}, other, 5).shutter.shutter);
    EXPECT_FALSE(randomized({}, other, 5).camera.fstop);
    other.seed = 8;
    EXPECT_NE(randomized({}, r, 5).shutter.shutter, randomized({}, other, 5).shutter.shutter);
    EXPECT_EQ(randomized({}, r, 5).camera.offset_after, randomized({}, r, 6).camera.offset);
    EXPECT_EQ(randomized({}, r, 5).camera.offset_before, randomized({}, r, 4).camera.offset);
}

TEST(Randomization, ACameraWithAnOffsetIsANodeThatStandsElsewhere) {
    Scene scene = small_scene::scene_with_camera();
    RenderSettings settings;
    settings.camera.offset = {{0.3, -0.2, 0.1}, {4.0, 10.0, -7.0}};
    const glm::dmat4 moved = world_to_camera(make_view(scene, settings, 0.0), evaluate(scene, {}, 0.0));
    const auto about = [](double degrees, const glm::dvec3& axis) {
        return glm::angleAxis(glm::radians(degrees), axis);
    };
    scene.nodes[0].transform.translation = {0.3f, -0.2f, 0.1f};
    scene.nodes[0].transform.rotation =
        glm::quat(about(10.0, {0, 1, 0}) * about(4.0, {1, 0, 0}) * about(-7.0, {0, 0, 1}));
    const glm::dmat4 node = world_to_camera(make_view(scene, {}, 0.0), evaluate(scene, {}, 0.0));
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 4; ++row) EXPECT_NEAR(moved[column][row], node[column][row], 1e-6);
    EXPECT_GT(std::abs(moved[0][2]), 0.1) << "it is turned at all";
}

TEST(Randomization, FlowLeadsToTheCameraOfTheNeighbour) {
    Scene scene = small_scene::scene_with_camera();
    small_scene::add_mesh(scene, {small_scene::square(20.0f, -8.0f, kNone)});
    RenderSettings settings;
    settings.image.width = settings.image.height = 32;
    settings.image.spp = 4;
    settings.image.aovs = {Aov::kMotion};
    settings.camera.offset_after.shift_m = {0.5, 0.0, 0.0};
    settings.camera.offset_before.shift_m = {0.0, 0.25, 0.0};
    RenderStats stats;
    const Picture picture = render_picture(scene, settings, 0.0, stats);
    const std::size_t pixels = 32 * 32, middle = 16 * 32 + 16;
    EXPECT_NEAR(picture.aovs[middle], -16.0 * 0.5 / 8.0, 1e-5) << "the camera goes right, the wall left";
    EXPECT_NEAR(picture.aovs[pixels + middle], 0.0, 1e-5);
    EXPECT_NEAR(picture.aovs[2 * pixels + middle], 0.0, 1e-5);
    EXPECT_NEAR(picture.aovs[3 * pixels + middle], 16.0 * 0.25 / 8.0, 1e-5) << "the camera goes up, the wall down";
}

std::string refusal(const std::string& json) {
    const std::string file = testing::TempDir() + "randomize_test.json";
    std::ofstream(file) << json;
    try {
        read_randomization(file);
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::kUsage);
        return error.what();
    }
    return {};
}

TEST(Randomization, ReadsWhatItWrites) {
    const std::string text = randomization_json(everything());
    EXPECT_EQ(refusal(text), "");
    const Randomization r = read_randomization(testing::TempDir() + "randomize_test.json");
    EXPECT_EQ(randomization_json(r), text);
    EXPECT_EQ(r.seed, 7u);
    EXPECT_EQ(r.fstop->high, 16.0);
}

TEST(Randomization, SaysWhatItDoesNotUnderstand) {
    EXPECT_EQ(refusal("{}"), "");
    for (const char* text : {"", "[1]", "{\"fstop\": [1, 1e999]}", "{\"fstop\": [1, 2]", "nonsense"})
        EXPECT_NE(refusal(text).find("it is no JSON object"), std::string::npos) << text;
    for (const char* range : {"2", "[2]", "[3, 2]", "[1, 2, 3]", "[0, 2]", "[-1, 2]", "[\"1\", 2]", "null"})
        EXPECT_NE(refusal(std::string("{\"fstop\": ") + range + "}").find("fstop is not a range [LOW, HIGH] above 0"),
                  std::string::npos)
            << range;
    EXPECT_NE(refusal("{\"fstops\": [1, 2]}").find("'fstops' is not one of seed, fstop"), std::string::npos);
    EXPECT_NE(refusal("{\"seed\": -1}").find("seed is not"), std::string::npos);
    EXPECT_NE(refusal("{\"camera_turn\": 181}").find("camera_turn is not"), std::string::npos);
    EXPECT_NE(refusal("{\"camera_shift\": [0, 1]}").find("camera_shift is not"), std::string::npos);
    EXPECT_THROW(read_randomization("/no/such/file"), Error);
}

TEST(Randomization, RefusesWhatIsGivenTwiceAndEndsThatAreOutOfRange) {
    const auto refused = [](const Randomization& r, auto change) {
        RenderSettings settings;
        change(settings);
        EXPECT_THROW(check_randomization(settings, r), Error);
    };
    EXPECT_NO_THROW(check_randomization({}, everything()));
    refused(everything(), [](RenderSettings& s) { s.camera.fstop = 2.0; });
    refused(everything(), [](RenderSettings& s) { s.camera.lens_radius = 0.1; });
    refused(everything(), [](RenderSettings& s) { s.camera.defocus = false; });
    refused(everything(), [](RenderSettings& s) { s.camera.focus_object = "fox"; });
    refused(everything(), [](RenderSettings& s) { s.shutter.shutter = 0.5; });
    refused(everything(), [](RenderSettings& s) { s.shutter.motion_blur = false; });
    refused(everything(), [](RenderSettings& s) { s.shutter.position = ShutterPosition::kStart; });
    refused(everything(), [](RenderSettings& s) { s.image.exposure = 99.5; });
    Randomization closed = everything();
    closed.shutter = {-0.5, 0.5};
    refused(closed, [](RenderSettings&) {});
}

}  // namespace
}  // namespace pentaprism
