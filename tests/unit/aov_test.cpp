// Arbitrary output variables against what a scene of one moving square must give.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <gtest/gtest.h>
#include <map>
#include <pentaprism/aov.h>
#include <pentaprism/error.h>
#include <pentaprism/render.h>

#include "resolve/named_ids.h"
#include "unit/small_scene.h"

namespace pentaprism {
namespace {

using namespace small_scene;

constexpr int kSize = 32;
constexpr double kFocal = kSize / 2;  // pixels: the camera sees [-1, 1] at depth 1

// A square of 3 metres half width at depth 2 moves by (1, 0.5) metres a second; a background square stands behind it.
Scene scene_of_two() {
    Scene scene = scene_with_camera();
    scene.materials.resize(2);
    scene.materials[0].name = "paint";
    scene.materials[0].double_sided = true;
    const Index mover = add_mesh(scene, {square(0.5f, 0.0f, 0)}), wall = add_mesh(scene, {square(20.0f, -8.0f, 1)});
    scene.nodes[mover].name = "mover";
    scene.nodes[wall].name = "mover";  // a name that is taken
    Channel channel;
    channel.node = mover;
    channel.path = ChannelPath::kTranslation;
    channel.times = {0.0f, 10.0f};
    channel.values = {-5.0f, -2.5f, -2.0f, 5.0f, 2.5f, -2.0f};
    scene.animations.push_back({"move", {channel}, 10.0});
    return scene;
}

RenderSettings settings_with(std::vector<Aov> aovs) {
    RenderSettings settings;
    settings.image.width = settings.image.height = kSize;
    settings.image.spp = 16;
    settings.image.aovs = std::move(aovs);
    settings.animation.fps = 8.0;
    settings.shutter.shutter = 0.25;
    return settings;
}

Picture picture_of(const Scene& scene, const RenderSettings& settings, double frame = 40.0) {
    RenderStats stats;
    return render_picture(scene, settings, frame, stats);
}

float value(const Picture& picture, int channel, int x, int y) {
    return picture.aovs[(static_cast<std::size_t>(channel) * picture.height + y) * picture.width + x];
}
std::uint32_t number(const Picture& picture, int channel, int x, int y) {
    return std::bit_cast<std::uint32_t>(value(picture, channel, x, y));
}

// At frame 40, 5 s, the mover is in the middle of the picture; the corner sees the wall.
constexpr int kMiddle = kSize / 2, kCorner = 2;

TEST(Aovs, TellWhatIsSeen) {
    const Picture picture =
        picture_of(scene_of_two(), settings_with({Aov::kDepth, Aov::kNormal, Aov::kPosition, Aov::kUv}));
    EXPECT_FLOAT_EQ(value(picture, 0, kMiddle, kMiddle), 2.0f);
    EXPECT_FLOAT_EQ(value(picture, 0, kCorner, kCorner), 8.0f);
    EXPECT_NEAR(value(picture, 1, kMiddle, kMiddle), 0.0, 1e-6);
    EXPECT_NEAR(value(picture, 3, kMiddle, kMiddle), 1.0, 1e-6) << "z of the normal";
    EXPECT_NEAR(value(picture, 6, kCorner, kCorner), -8.0, 1e-5) << "z of the position";
    // x of the wall at the middle of pixel 2, mean of stratified samples.
    EXPECT_NEAR(value(picture, 4, kCorner, kCorner), 8.0 * (kCorner + 0.5 - kSize / 2) / kFocal, 0.05);
    EXPECT_NEAR(value(picture, 8, kCorner, kCorner), 0.5 - 0.025 * 8.0 * (kSize / 2 - kCorner - 0.5) / kFocal, 2e-3);
}

TEST(Aovs, MotionIsTheWayOnTheScreenFromFrameToFrame) {
    const Picture picture = picture_of(scene_of_two(), settings_with({Aov::kMotion}));
    // 1/8 of a second: (1/8, 1/16) metres at depth 2; v counts down.
    const double u = kFocal * 0.125 / 2, v = -kFocal * 0.0625 / 2;
    EXPECT_NEAR(value(picture, 0, kMiddle, kMiddle), u, 1e-5);
    EXPECT_NEAR(value(picture, 1, kMiddle, kMiddle), v, 1e-5);
    EXPECT_NEAR(value(picture, 2, kMiddle, kMiddle), -u, 1e-5);
    EXPECT_NEAR(value(picture, 3, kMiddle, kMiddle), -v, 1e-5);
    for (int channel = 0; channel < 4; ++channel) EXPECT_EQ(value(picture, channel, kCorner, kCorner), 0.0f);
}

TEST(Aovs, TheCircleOfConfusionIsThatOfTheThinLensWithItsSign) {
    RenderSettings settings = settings_with({Aov::kCoc});
    settings.camera.lens_radius = 0.1;
    settings.camera.focus_distance = 4.0;
    const Picture picture = picture_of(scene_of_two(), settings);
    const auto radius = [](double depth) { return 0.1 * kFocal * (depth - 4.0) / (4.0 * depth); };
    EXPECT_NEAR(value(picture, 0, kMiddle, kMiddle), radius(2.0), 1e-5);
    EXPECT_LT(value(picture, 0, kMiddle, kMiddle), 0.0f);
    EXPECT_NEAR(value(picture, 0, kCorner, kCorner), radius(8.0), 1e-5);
    // A pinhole has none.
    EXPECT_EQ(value(picture_of(scene_of_two(), settings_with({Aov::kCoc})), 0, kMiddle, kMiddle), 0.0f);
}

TEST(Aovs, IdsGoToWhatMostSamplesSee) {
    Scene scene = scene_of_two();
    scene.roots.pop_back();  // no wall: the corner is background
    scene.nodes.back().visible = false;
    const RenderSettings settings = settings_with({Aov::kObjectId, Aov::kMaterialId, Aov::kTime, Aov::kCoverage});
    const Picture picture = picture_of(scene, settings);
    EXPECT_EQ(number(picture, 0, kMiddle, kMiddle), 1u);
    EXPECT_EQ(number(picture, 1, kMiddle, kMiddle), 1u);
    EXPECT_EQ(number(picture, 0, kCorner, kCorner), 0u);
    EXPECT_LT(value(picture, 2, kMiddle, kMiddle), 1.0f / 16);
    EXPECT_GT(value(picture, 3, kMiddle, kMiddle), 15.0f / 16);
    EXPECT_EQ(value(picture, 4, kMiddle, kMiddle), 1.0f);
    EXPECT_EQ(value(picture, 5, kMiddle, kMiddle), 1.0f);
    EXPECT_EQ(value(picture, 5, kCorner, kCorner), 0.0f);
    bool partly = false;
    for (int y = 0; y < kSize; ++y)
        for (int x = 0; x < kSize; ++x) {
            const float coverage = value(picture, 5, x, y);
            EXPECT_EQ(coverage * 16, std::round(coverage * 16));
            EXPECT_EQ(number(picture, 0, x, y) == 1u, coverage > 0.5f) << x << "," << y;  // a tie is background
            partly = partly || (coverage > 0 && coverage < 1);
        }
    EXPECT_TRUE(partly);
}

// Each thing of one colour: what Cryptomatte says of a blurred pixel, times what the sharp things look like, is the
// pixel.
TEST(Aovs, TheSumOverSharpComponentsIsTheBlurredPixel) {
    Scene scene = scene_of_two();
    scene.nodes[1].name = "front";
    add_mesh(scene, {square(0.7f, -3.0f, 0)});  // behind the mover, before the wall
    scene.nodes.back().name = "middle";
    scene.materials.push_back(scene.materials[0]);
    scene.meshes[0].primitives[0].material = 2;
    const std::map<std::string, glm::vec3> colors{
        {"front", {1.0f, 0.5f, 0.25f}}, {"middle", {0.0f, 0.75f, 0.5f}}, {"mover", {0.25f, 0.25f, 1.0f}}};
    const auto paint = [&](Index material, const glm::vec3& color) {
        scene.materials[material].unlit = true;
        scene.materials[material].base_color = glm::vec4(color, 1.0f);
    };
    paint(2, colors.at("front")), paint(0, colors.at("middle")), paint(1, colors.at("mover"));  // the wall
    RenderSettings settings = settings_with({Aov::kCryptomatte, Aov::kTime, Aov::kObjectId});
    settings.image.filter = Filter::kBox;
    settings.shutter.shutter = 1.0;
    settings.camera.lens_radius = 0.2;
    settings.camera.focus_distance = 3.0;
    const Picture picture = picture_of(scene, settings);
    int mixed = 0;
    for (int y = 0; y < kSize; ++y)
        for (int x = 0; x < kSize; ++x) {
            glm::dvec3 sum(0.0);
            int components = 0;
            for (int rank = 0; rank < kCryptomatteRanks; ++rank) {
                const float id = value(picture, 2 * rank, x, y), share = value(picture, 2 * rank + 1, x, y);
                if (share == 0.0f) continue;
                ++components;
                const auto known = std::find_if(colors.begin(), colors.end(), [&](const auto& thing) {
                    NamedIds ids;
                    return id == ids.cryptomatte_id(ids.add(thing.first, ""));
                });
                ASSERT_NE(known, colors.end());
                sum += double(share) * glm::dvec3(known->second);
            }
            for (int c = 0; c < 3; ++c)
                EXPECT_NEAR(sum[c], picture.rgba[4 * (static_cast<std::size_t>(y) * kSize + x) + c], 2e-6)
                    << x << ' ' << y;
            // The blend fraction is the share of the object that most samples see.
            const int time = 4 * kCryptomatteRanks;
            EXPECT_NEAR(value(picture, time + 2, x, y), value(picture, 1, x, y), 1e-6) << x << ' ' << y;
            EXPECT_LE(value(picture, time, x, y), value(picture, time + 1, x, y));
            mixed += components > 1;
        }
    EXPECT_GT(mixed, 50);
}

TEST(Aovs, VarianceIsThatOfTheMeanOfTheSamples) {
    Scene scene = scene_of_two();
    scene.roots.pop_back();
    scene.nodes.back().visible = false;
    scene.materials[0].unlit = true;  // white, on black
    const Picture picture = picture_of(scene, settings_with({Aov::kCoverage, Aov::kVariance}));
    for (int y = 0; y < kSize; ++y)
        for (int x = 0; x < kSize; ++x) {
            const double p = value(picture, 0, x, y);
            EXPECT_NEAR(value(picture, 1, x, y), p * (1 - p) / 15.0, 1e-6);
        }
}

TEST(Aovs, AlbedoIsTheBaseColourWithoutLight) {
    Scene scene = scene_of_two();
    scene.materials[0].base_color = {0.5f, 0.25f, 1.0f, 1.0f};
    scene.materials[0].metallic = 1.0f;
    scene.materials[1].base_color = {0.125f, 0.5f, 0.75f, 1.0f};
    const Picture picture = picture_of(scene, settings_with({Aov::kAlbedo, Aov::kObjectId}));
    EXPECT_FLOAT_EQ(value(picture, 0, kMiddle, kMiddle), 0.5f);
    EXPECT_FLOAT_EQ(value(picture, 1, kMiddle, kMiddle), 0.25f);
    EXPECT_FLOAT_EQ(value(picture, 2, kCorner, kCorner), 0.75f);
}

// Shading is the other way to the same number: without light it shows the base colour of each sample.
TEST(Aovs, AlbedoIsThePictureOfAnUnlitTexturedScene) {
    Scene scene = scene_of_two();
    Image image;
    image.width = image.height = 4;
    for (int i = 0; i < 16; ++i)
        for (const int code : {16 * i, 255 - 16 * i, i % 2 * 255, 255})
            image.texels.push_back(static_cast<std::uint8_t>(code));
    scene.images.push_back(image);
    for (Material& material : scene.materials) {
        material.unlit = true;
        material.base_color = {0.5f, 1.0f, 0.75f, 1.0f};
        material.base_color_texture.image = 0;
    }
    RenderSettings settings = settings_with({Aov::kAlbedo, Aov::kCoverage});
    settings.image.filter = Filter::kBox;
    settings.camera.lens_radius = 0.1;
    settings.camera.focus_distance = 4.0;
    settings.method.shading = "sample";
    settings.method.texture_filter = TextureFilter::kOff;
    const Picture picture = picture_of(scene, settings);
    float least = 1.0f, most = 0.0f;
    for (int y = 0; y < kSize; ++y)
        for (int x = 0; x < kSize; ++x)
            for (int c = 0; c < 3; ++c) {
                const float shown = picture.rgba[4 * (static_cast<std::size_t>(y) * kSize + x) + c];
                EXPECT_NEAR(value(picture, c, x, y) * value(picture, 3, x, y), shown, 2e-6) << x << ' ' << y;
                least = std::min(least, shown), most = std::max(most, shown);
            }
    EXPECT_LT(least + 0.3f, most) << "there is a texture to see";
}

// The wall stands still, so what is hidden of it is what lies behind the mover's square a frame later or earlier.
TEST(Aovs, OcclusionIsWhereTheMoverWillBeAndWas) {
    RenderSettings settings = settings_with({Aov::kOcclusion, Aov::kObjectId});
    settings.animation.fps = 2.0;
    const Picture picture = picture_of(scene_of_two(), settings, 10.0);
    const double half = 0.5 * kFocal / 2, step_x = kFocal * 0.5 / 2, step_y = -kFocal * 0.25 / 2;
    int hidden = 0;
    for (int y = 0; y < kSize; ++y)
        for (int x = 0; x < kSize; ++x) {
            if (number(picture, 4, x, y) != 2) {
                EXPECT_EQ(value(picture, 0, kMiddle, kMiddle), 0.0f) << "nothing stands before the mover";
                continue;
            }
            for (const int way : {1, -1}) {
                // How far inside the square, in pixels; the pixel may see a little of the mover, and the rule leaves a
                // rim.
                const double dx = half - std::abs(x + 0.5 - kSize / 2.0 - way * step_x);
                const double dy = half - std::abs(y + 0.5 - kSize / 2.0 - way * step_y);
                const double inside = std::min(dx, dy);
                const float share = value(picture, way > 0 ? 0 : 2, x, y);
                if (inside > 1.5) {
                    EXPECT_GT(share, 0.5f) << x << ' ' << y << ' ' << way;
                }
                if (inside < -0.8) {
                    EXPECT_EQ(share, 0.0f) << x << ' ' << y << ' ' << way;
                }
                hidden += share > 0.5f;
            }
            EXPECT_EQ(value(picture, 1, x, y), 0.0f) << "the wall stays in the picture";
        }
    EXPECT_GT(hidden, 20);
}

TEST(Aovs, OcclusionKnowsThePicturesBorder) {
    // Three frames after the middle the mover touches the right border; the next step takes half of it out.
    RenderSettings settings = settings_with({Aov::kOcclusion, Aov::kObjectId});
    settings.animation.fps = 2.0;
    const Picture picture = picture_of(scene_of_two(), settings, 13.0);
    const double step = kFocal * 0.5 / 2, blur = 0.5 * 0.25 * step;
    int leaving = 0;
    for (int y = 0; y < kSize; ++y)
        for (int x = 0; x < kSize; ++x) {
            if (number(picture, 4, x, y) != 1) continue;
            if (x + step - blur > kSize) {
                EXPECT_GT(value(picture, 1, x, y), 0.5f) << x << " (the wall may show)";
                ++leaving;
            }
            if (x + 1 + step + blur < kSize) {
                EXPECT_EQ(value(picture, 1, x, y), 0.0f) << x;
            }
            EXPECT_EQ(value(picture, 3, x, y), 0.0f) << "it comes from inside";
        }
    EXPECT_GT(leaving, 0);
}

TEST(Aovs, SteCountsTheTestsOfTheFrame) {
    RenderSettings settings = settings_with({Aov::kSte});
    EXPECT_THROW(picture_of(scene_of_two(), settings), Error);
    settings.method.culling = "hull";
    RenderStats stats;
    const Picture picture = render_picture(scene_of_two(), settings, 40.0, stats);
    double tested = 0, covered = 0;
    for (int y = 0; y < kSize; ++y)
        for (int x = 0; x < kSize; ++x) {
            tested += value(picture, 1, x, y);
            covered += value(picture, 0, x, y) * value(picture, 1, x, y);
        }
    EXPECT_EQ(tested, stats.tested);
    EXPECT_NEAR(covered, stats.covered, 1e-3 * stats.covered);
    EXPECT_GE(value(picture, 0, kCorner, kCorner), 0.5f) << "the wall alone, at most with its other triangle";
}

TEST(Aovs, DoNotDependOnTilesThreadsOrOneAnother) {
    std::vector<Aov> all;
    for (const AovInfo& info : aov_table()) all.push_back(info.aov);
    RenderSettings settings = settings_with(all);
    settings.method.culling = "hull";  // ste wants a test
    settings.image.height = 80;
    settings.camera.lens_radius = 0.1;
    settings.camera.focus_distance = 4.0;
    const Scene scene = scene_of_two();
    const Picture one = picture_of(scene, settings);
    settings.method.tile_size = 8;
    settings.method.threads = 1;
    const Picture other = picture_of(scene, settings);
    ASSERT_EQ(one.aovs.size(), other.aovs.size());
    EXPECT_EQ(0, std::memcmp(one.aovs.data(), other.aovs.data(), one.aovs.size() * sizeof(float)));
    EXPECT_EQ(one.rgba, other.rgba);
    settings.image.aovs.clear();
    EXPECT_EQ(one.rgba, picture_of(scene, settings).rgba) << "the picture does not change";
}

TEST(Aovs, TableIsInTheOrderOfItsEnumeration) {
    for (std::size_t i = 0; i < aov_table().size(); ++i)
        EXPECT_EQ(static_cast<std::size_t>(aov_table()[i].aov), i) << aov_table()[i].name;
    EXPECT_EQ(aov_named("coc"), Aov::kCoc);
    EXPECT_THROW(aov_named("beauty"), Error);
}

TEST(Cryptomatte, IdsAreMurmurHashesOfNames) {
    NamedIds ids;
    EXPECT_EQ(ids.add("hello", ""), 1u);
    EXPECT_EQ(std::bit_cast<std::uint32_t>(ids.cryptomatte_id(1)), 0x248bfa47u);
    EXPECT_EQ(ids.add("hello world", ""), 2u);
    EXPECT_EQ(std::bit_cast<std::uint32_t>(ids.cryptomatte_id(2)), 0x5e928f0fu);
    EXPECT_EQ(ids.add("hello", ""), 3u);
    EXPECT_EQ(ids.name(3), "hello.2");
    EXPECT_EQ(ids.add("", "node 7"), 4u);
    EXPECT_EQ(ids.name(4), "node 7");
    EXPECT_EQ(ids.cryptomatte_id(0), 0.0f);
    for (std::uint32_t n = 5; n < 3000; ++n) {
        ids.add("object " + std::to_string(n), "");
        EXPECT_TRUE(std::isnormal(ids.cryptomatte_id(n))) << ids.name(n);
    }
}

}  // namespace
}  // namespace pentaprism
