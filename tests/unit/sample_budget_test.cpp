// --target-error: which blocks get how many samples, and that those are the samples of a picture of that many.
#include "render/sample_budget.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <map>
#include <pentaprism/error.h>
#include <pentaprism/render.h>

#include "unit/small_scene.h"

namespace pentaprism {
namespace {

// A square flies past an even wall.
Scene flying_square() {
    Scene scene = small_scene::scene_with_camera();
    scene.materials.resize(2);
    for (Material& material : scene.materials) material.unlit = true;
    scene.materials[0].base_color = {1.0f, 0.7f, 0.2f, 1.0f};
    scene.materials[1].base_color = {0.1f, 0.1f, 0.2f, 1.0f};
    const Index mover = small_scene::add_mesh(scene, {small_scene::square(0.4f, -2.0f, 0)});
    small_scene::add_mesh(scene, {small_scene::square(30.0f, -8.0f, 1)});
    Channel channel;
    channel.node = mover;
    channel.path = ChannelPath::kTranslation;
    channel.times = {0.0f, 1.0f};
    channel.values = {-8.0f, -2.0f, 0.0f, 8.0f, 2.0f, 0.0f};
    scene.animations.push_back({"fly", {channel}, 1.0});
    return scene;
}

RenderSettings settings_of(double target_error) {
    RenderSettings settings;
    settings.image.width = 75;  // neither whole tiles nor whole blocks
    settings.image.height = 50;
    settings.image.spp = 4;
    settings.image.max_spp = 50;
    settings.image.target_error = target_error;
    settings.image.filter = Filter::kBox;
    settings.image.aovs = {Aov::kSamples, Aov::kVariance, Aov::kCryptomatte};
    settings.camera.lens_radius = 0.1;
    settings.camera.focus_distance = 3.0;
    return settings;
}

Picture picture_of(const Scene& scene, const RenderSettings& settings, RenderStats* stats = nullptr) {
    RenderStats unused;
    return render_picture(scene, settings, 12.0, stats ? *stats : unused);
}

bool same(const Picture& a, const Picture& b) {
    return a.rgba == b.rgba && a.z == b.z && a.aovs == b.aovs;
}

TEST(SampleBudget, LevelsDoubleFromTheLeastToTheMost) {
    ImageSettings image;
    image.spp = 16, image.max_spp = 100, image.target_error = 0.01;
    const SampleBudget budget(image, Sampler::kIndependent, {});
    EXPECT_EQ(budget.levels(), (std::vector<int>{16, 32, 64, 100}));
    // Of random samples, whose squared error is over their number: the root of 64 times what the target takes.
    EXPECT_EQ(budget.level_for(0.0), 0u);
    EXPECT_EQ(budget.level_for(0.99e-4 * 4), 0u);
    EXPECT_EQ(budget.level_for(1.01e-4 * 4), 1u);
    EXPECT_EQ(budget.level_for(0.99e-4 * 64), 2u);
    EXPECT_EQ(budget.level_for(1.01e-4 * 64), 3u);
    EXPECT_EQ(budget.level_for(1.0), 3u);
    image.max_spp = 16;
    EXPECT_EQ(SampleBudget(image, Sampler::kStratified, {}).levels(), std::vector<int>{16});
}

TEST(SampleBudget, BlocksMoveUpALevelWhereThatCostsLessThanAPass) {
    ImageSettings image;
    image.spp = 16, image.max_spp = 128, image.target_error = 0.01;
    const SampleBudget budget(image, Sampler::kStratified, {});
    using Levels = std::vector<std::size_t>;
    const auto taken = [&](const std::vector<int>& blocks, double pass) { return budget.levels_to_take(blocks, pass); };
    EXPECT_EQ(taken({10, 10, 10, 10}, 0.0), (Levels{0, 1, 2, 3}));
    EXPECT_EQ(taken({10, 10, 10, 10}, 1e9), (Levels{3, 3, 3, 3}));
    // Ten blocks of sixteen pixels: 16 samples more for each, or 32 or 64 more.
    EXPECT_EQ(taken({10, 10, 10, 10}, 2559.0), (Levels{0, 1, 2, 3}));
    EXPECT_EQ(taken({10, 10, 10, 10}, 2561.0), (Levels{1, 1, 2, 3}));
    EXPECT_EQ(taken({0, 10, 10, 10}, 5121.0), (Levels{0, 2, 2, 3}));
    // A level that no block wants costs no pass, and one above all that are wanted serves none.
    const Levels lowest = taken({64, 0, 0, 0}, 1e9), second = taken({10, 30, 0, 0}, 1e9);
    EXPECT_EQ(lowest[0], 0u);
    EXPECT_EQ(second[0], 1u);
    EXPECT_EQ(second[1], 1u);
}

TEST(SampleBudget, EachBlockIsThatOfAPictureWithItsNumberOfSamples) {
    const Scene scene = flying_square();
    RenderSettings settings = settings_of(0.01);
    settings.image.width = 203, settings.image.height = 130, settings.image.max_spp = 200;
    RenderStats stats;
    const Picture picture = picture_of(scene, settings, &stats);
    const std::size_t pixels = picture.z.size();
    std::map<int, std::size_t> pixels_of_level;
    for (std::size_t i = 0; i < pixels; ++i) ++pixels_of_level[static_cast<int>(picture.aovs[i])];
    ASSERT_GE(pixels_of_level.size(), 3u);
    EXPECT_GT(pixels_of_level[4], pixels / 2);  // the even wall
    std::int64_t samples = 0;
    for (const auto& [spp, count] : pixels_of_level) {
        samples += static_cast<std::int64_t>(count) * spp;
        RenderSettings uniform = settings;
        uniform.image.target_error.reset();
        uniform.image.spp = spp;
        const Picture other = picture_of(scene, uniform);
        for (std::size_t i = 0; i < pixels; ++i) {
            if (picture.aovs[i] != static_cast<float>(spp)) continue;
            ASSERT_TRUE(std::equal(&picture.rgba[4 * i], &picture.rgba[4 * i] + 4, &other.rgba[4 * i])) << spp;
            ASSERT_EQ(picture.z[i], other.z[i]);
            for (std::size_t c = 0; c < picture.aovs.size() / pixels; ++c)
                ASSERT_EQ(picture.aovs[c * pixels + i], other.aovs[c * pixels + i]) << spp << ", channel " << c;
        }
    }
    EXPECT_EQ(stats.samples, samples);
    EXPECT_EQ(stats.pixels, static_cast<std::int64_t>(pixels));
    EXPECT_EQ(stats.pilot_samples, 4 * stats.pixels);
}

TEST(SampleBudget, DoesNotDependOnTilesThreadsTestsAndCrops) {
    const Scene scene = flying_square();
    RenderSettings settings = settings_of(0.02);
    settings.image.filter = Filter::kBlackmanHarris;
    const Picture whole = picture_of(scene, settings);
    for (const int tile_size : {8, 16, 32})
        for (const int threads : {1, 2}) {
            RenderSettings other = settings;
            other.method.tile_size = tile_size, other.method.threads = threads;
            EXPECT_TRUE(same(whole, picture_of(scene, other))) << tile_size << ", " << threads;
        }
    RenderSettings slow = settings;
    slow.method.culling = "hull";
    EXPECT_TRUE(same(whole, picture_of(scene, slow)));

    settings.image.crop = {{18, 59, 13, 33}};
    const Picture part = picture_of(scene, settings);
    for (int y = 13; y < 33; ++y)
        for (int x = 18; x < 59; ++x) {
            const std::size_t in_whole = static_cast<std::size_t>(y) * 75 + x,
                              in_part = static_cast<std::size_t>(y - 13) * (59 - 18) + x - 18;
            for (int c = 0; c < 4; ++c) ASSERT_EQ(part.rgba[4 * in_part + c], whole.rgba[4 * in_whole + c]);
            ASSERT_EQ(part.aovs[in_part], whole.aovs[in_whole]);
        }
}

TEST(SampleBudget, StillPicturesToo) {
    const Scene scene = flying_square();
    RenderSettings settings = settings_of(0.01);
    settings.image.spp = 16, settings.image.max_spp = 64;
    settings.shutter.motion_blur = false, settings.camera.defocus = false;
    settings.image.filter = Filter::kBlackmanHarris;
    const Picture picture = picture_of(scene, settings);
    EXPECT_GT(*std::max_element(picture.aovs.begin(), picture.aovs.begin() + picture.z.size()), 16.0f);
    settings.method.culling = "hull";
    settings.method.tile_size = 8;
    EXPECT_TRUE(same(picture, picture_of(scene, settings)));
}

TEST(SampleBudget, AnUnreachableTargetIsTheMostEverywhereThatAnythingVaries) {
    const Scene scene = flying_square();
    RenderSettings settings = settings_of(1e-9);
    RenderSettings uniform = settings;
    uniform.image.target_error.reset();
    uniform.image.spp = settings.image.max_spp;
    const Picture picture = picture_of(scene, settings), other = picture_of(scene, uniform);
    std::size_t most = 0;
    for (std::size_t i = 0; i < picture.z.size(); ++i) {
        if (picture.aovs[i] != 50.0f) continue;
        ++most;
        for (int c = 0; c < 4; ++c) ASSERT_EQ(picture.rgba[4 * i + c], other.rgba[4 * i + c]);
    }
    EXPECT_GT(most, picture.z.size() / 20);
}

TEST(SampleBudget, WhatCannotWorkIsRefusedByName) {
    const auto refusal = [](const std::function<void(RenderSettings&)>& change) -> std::string {
        RenderSettings settings = settings_of(0.01);
        change(settings);
        try {
            validate(settings);
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::kUsage);
            return error.what();
        }
        return "";
    };
    EXPECT_EQ(refusal([](RenderSettings&) {}), "");
    EXPECT_NE(refusal([](RenderSettings& s) { s.image.target_error = 0.0; }).find("--target-error"), std::string::npos);
    EXPECT_NE(refusal([](RenderSettings& s) { s.image.target_error = 1.5; }).find("--target-error"), std::string::npos);
    EXPECT_NE(refusal([](RenderSettings& s) { s.image.spp = 51; }).find("--max-spp 50"), std::string::npos);
    for (const auto method : {VisibilityMethod::kAccumulation, VisibilityMethod::kInterleaved,
                              VisibilityMethod::kRaytrace, VisibilityMethod::kMicropolygon})
        EXPECT_NE(refusal([&](RenderSettings& s) { s.method.visibility = method; }).find("--target-error"),
                  std::string::npos);
    EXPECT_NE(refusal([](RenderSettings& s) { s.method.backend = Backend::kGl; }).find("--backend gl"),
              std::string::npos);
}

}  // namespace
}  // namespace pentaprism
