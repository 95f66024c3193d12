// Lenses of all shapes: every culling test and every way to cover gives the picture that testing every sample gives,
// bit for bit, and double precision agrees with it.
#include <cmath>
#include <gtest/gtest.h>
#include <pentaprism/render.h>
#include <pentaprism/verify.h>
#include <string>

#include "cull/cull_choice.h"
#include "cull/cull_test.h"
#include "support/scenes.h"

namespace pentaprism {
namespace {

// A floor from under the camera to far away, and squares before, in and behind the focus; all turn and move.
Scene test_scene() {
    Scene scene;
    Camera camera;
    camera.yfov = 0.9;
    camera.znear = 0.1;
    camera.lens.fstop = 0.08;
    camera.lens.focal_length_mm = 40;
    const Index eye = support::add_camera(scene, "eye", {0, 0.6, 0}, camera);
    support::animate(scene, eye, ChannelPath::kTranslation, {0, 1}, {-0.1f, 0.6f, 0, 0.1f, 0.6f, -0.2f});
    const Index floor = support::add_square(scene, "floor", {0, -0.4, -10}, 12.0f);
    scene.nodes[floor].transform.rotation = glm::dquat(std::sqrt(0.5), -std::sqrt(0.5), 0, 0);
    int i = 0;
    for (const float z : {-0.7f, -1.4f, -2.2f, -3.0f, -4.5f, -8.0f}) {
        const float x = 0.5f * static_cast<float>(i % 3 - 1) * (1 - z) / 2, step = 0.15f * (i % 2 ? -1.0f : 1.0f) * -z;
        const Index node = support::add_square(scene, "square", {x, 0.3, z}, 0.12f * (0.6f - z));
        support::animate(scene, node, ChannelPath::kTranslation, {0, 1}, {x, 0.3f, z, x + step, 0.4f, z + step});
        support::animate(scene, node, ChannelPath::kRotation, {0, 1}, {0, 0, 0, 1, 0, 0.6f, 0, 0.8f});
        ++i;
    }
    Light sun;
    sun.kind = LightKind::kDirectional;
    sun.intensity = 3.0f;
    scene.lights.push_back(sun);
    const Index light = support::add_node(scene, "sun", {0, 5, 0});
    scene.nodes[light].transform.rotation = glm::dquat(0.8, -0.6, 0, 0);
    scene.nodes[light].light = 0;
    scene.materials.emplace_back();
    scene.materials[0].double_sided = true;
    for (Mesh& mesh : scene.meshes) mesh.primitives[0].material = 0;
    return scene;
}

struct LensCase {
    const char* name;
    void (*set)(Scene&, RenderSettings&);
    bool cuts = false;
};

void animate_camera(Scene& scene, ChannelPath path, float from, float to) {
    Channel channel;
    channel.camera = 0;
    channel.path = path;
    channel.width = 1;
    channel.times = {0, 1};
    channel.values = {from, to};
    scene.animations[0].channels.push_back(channel);
}

const LensCase kLenses[] = {
    {"Range",
     [](Scene&, RenderSettings& s) {
         s.camera.focus_range = {1.9, 3.3};
     },
     true},
    {"Foreground",
     [](Scene&, RenderSettings& s) {
         s.camera.focus_distance = 3.0;
         s.camera.max_foreground_blur = 3.0;
     },
     true},
    {"RangeAndForeground",
     [](Scene&, RenderSettings& s) {
         s.camera.focus_range = {1.9, 3.3};
         s.camera.max_foreground_blur = 2.0;
         s.camera.aperture_ratio = 1.6;
     },
     true},
    {"Tilt",
     [](Scene&, RenderSettings& s) {
         s.camera.focus_distance = 2.5;
         s.camera.tilt_deg = 50;
         s.camera.swing_deg = -20;
         s.camera.aperture_ratio = 0.7;
     }},
    {"CatsEye",
     [](Scene&, RenderSettings& s) {
         s.camera.focus_distance = 2.0;
         s.camera.cats_eye = 1.4;
     }},
    {"CatsEyeAndRollingShutter",
     [](Scene&, RenderSettings& s) {
         s.camera.focus_distance = 2.0;
         s.camera.cats_eye = 0.8;
         s.camera.aperture_blades = 5;
         s.shutter.rolling = RollingShutter::kLeft;
     }},
    {"FocusPull",
     [](Scene& scene, RenderSettings&) { animate_camera(scene, ChannelPath::kFocusDistance, 1.0f, 5.0f); }},
    {"Zoom",
     [](Scene& scene, RenderSettings& s) {
         s.camera.focus_distance = 2.0;
         animate_camera(scene, ChannelPath::kYfov, 1.2f, 0.6f);
     }},
    {"PullOfARange",
     [](Scene& scene, RenderSettings&) {
         scene.cameras[0].lens.focus_range = {1.5, 3.5};
         animate_camera(scene, ChannelPath::kFocusDistance, 1.6f, 3.4f);
     },
     true},
    {"Sobol", [](Scene&, RenderSettings& s) { s.method.sampler = Sampler::kSobol; }},
    {"BlueNoise", [](Scene&, RenderSettings& s) { s.method.sampler = Sampler::kBlueNoise; }},
    {"Independent", [](Scene&, RenderSettings& s) { s.method.sampler = Sampler::kIndependent; }},
};

class EveryLens : public ::testing::TestWithParam<LensCase> {
  protected:
    EveryLens() : scene_(test_scene()) {
        settings_.image.width = 70;
        settings_.image.height = 44;
        settings_.image.spp = 16;
        settings_.animation.fps = 2;
        settings_.shutter.shutter = 1.0;
        settings_.shutter.position = ShutterPosition::kStart;
        GetParam().set(scene_, settings_);
    }
    Picture render() { return render_picture(scene_, settings_, 0, stats_); }

    Scene scene_;
    RenderSettings settings_;
    RenderStats stats_;
};

TEST_P(EveryLens, ShowsTheSameHoweverSamplesAreCulled) {
    settings_.method.culling = "none";
    const Picture expected = render();
    EXPECT_GT(stats_.covered, 1000);
    const auto triangles = 2 * static_cast<std::int64_t>(scene_.meshes.size());
    EXPECT_EQ(stats_.triangles > triangles, GetParam().cuts);
    settings_.method.culling = "auto";
    const Picture fast = render();
    EXPECT_TRUE(fast.rgba == expected.rgba && fast.z == expected.z);
    for (const CullTest* test : cull_table()) {
        if (!test->conservative) continue;
        settings_.method.culling = test->name;
        const Picture picture = render();
        EXPECT_TRUE(picture.rgba == expected.rgba && picture.z == expected.z) << test->name;
    }
    settings_.method.culling = "auto";
    settings_.method.tile_size = 8;
    settings_.method.threads = 1;
    const Picture small = render();
    EXPECT_TRUE(small.rgba == expected.rgba && small.z == expected.z) << "tiles of 8 pixels";
}

TEST_P(EveryLens, AgreesWithDoublePrecision) {
    settings_.image.spp = 4;
    const VerifyReport report = verify_frame(scene_, settings_, 0);
    EXPECT_EQ(report.away_from_edge, 0);
    EXPECT_LE(report.ours_wrong, 2);
    EXPECT_GT(report.brute_force_samples, 100);
    EXPECT_EQ(report.brute_force_disagreements, 0);
}

INSTANTIATE_TEST_SUITE_P(Lenses, EveryLens, ::testing::ValuesIn(kLenses),
                         [](const auto& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace pentaprism
