// Where samples are spent must not push the mean: pictures of many seeds against the exact answer.
#include <cmath>
#include <gtest/gtest.h>
#include <pentaprism/render.h>

#include "unit/small_scene.h"

namespace pentaprism {
namespace {

// A thin bright bar crosses the picture: a pixel sees it a short part of the shutter's time, and few samples often not
// at all. That is where stopping by what was seen is off: it stops at nothing, and goes on at something.
Scene passing_bar() {
    Scene scene = small_scene::scene_with_camera();
    scene.materials.resize(1);
    scene.materials[0].unlit = true;
    Primitive bar = small_scene::square(1.0f, -1.0f, 0);
    for (glm::vec3& p : bar.positions) p.x *= 0.02f, p.y *= 40.0f;
    const Index mover = small_scene::add_mesh(scene, {bar});
    Channel channel;
    channel.node = mover;
    channel.path = ChannelPath::kTranslation;
    channel.times = {0.0f, 1.0f};
    channel.values = {-2.0f, 0.0f, 0.0f, 2.0f, 0.0f, 0.0f};
    scene.animations.push_back({"pass", {channel}, 1.0});
    return scene;
}

TEST(SampleBudget, TheMeanOfManyPicturesIsTheExactOne) {
    const Scene scene = passing_bar();
    RenderSettings settings;
    settings.image.width = settings.image.height = 64;
    settings.image.spp = 4;
    settings.image.max_spp = 64;
    settings.image.target_error = 0.15;
    settings.image.filter = Filter::kBox;
    settings.method.sampler = Sampler::kIndependent;  // noisiest, so the decisions are
    settings.animation.fps = 1.0;
    settings.shutter.shutter = 1.0;
    constexpr int kSeeds = 100;
    double sum = 0.0, squares = 0.0, spp = 0.0;
    for (int seed = 0; seed < kSeeds; ++seed) {
        settings.method.seed = static_cast<std::uint32_t>(seed);
        RenderStats stats;
        const Picture picture = render_picture(scene, settings, 0.5, stats);
        double mean = 0.0;
        for (std::size_t i = 0; i < picture.z.size(); ++i) mean += picture.rgba[4 * i];
        mean /= static_cast<double>(picture.z.size());
        sum += mean;
        squares += mean * mean;
        spp += static_cast<double>(stats.samples) / static_cast<double>(stats.pixels) / kSeeds;
    }
    // All blocks are alike and yet get different numbers, or there would be nothing to test.
    EXPECT_GT(spp, 6.0);
    EXPECT_LT(spp, 56.0);
    const double mean = sum / kSeeds;
    const double error = std::sqrt((squares / kSeeds - mean * mean) / (kSeeds - 1));
    RecordProperty("mean", std::to_string(mean));
    RecordProperty("error", std::to_string(error));
    RecordProperty("spp", std::to_string(spp));
    EXPECT_LT(error, 1e-4);
    // The bar is 0.04 wide and moves by 4; it covers each place for a hundredth of the time.
    EXPECT_LT(std::abs(mean - 0.01), 4.0 * error) << mean << " +- " << error << " at " << spp << " spp";
}

}  // namespace
}  // namespace pentaprism
