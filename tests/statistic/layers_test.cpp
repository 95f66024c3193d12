// Stochastic transparency against the A-buffer with the same samples: the mean of many is the same, and chance about
// opacity is all that it adds.
#include <array>
#include <cmath>
#include <gtest/gtest.h>

#include "render/layer_shading.h"
#include "unit/small_scene.h"

namespace pentaprism {
namespace {

using namespace small_scene;

constexpr int kSize = 512, kSpp = 4;

// Panes of three colours and glass, leaning through one another before a wall; some turn while the shutter is open.
Scene crossing_panes() {
    Scene scene = scene_with_camera();
    const auto add_pane = [&](const glm::vec4& color, float transmission, float depth, float lean, bool turns) {
        Material material;
        material.unlit = transmission == 0.0f;
        material.alpha_mode = color.w < 1.0f ? AlphaMode::kBlend : AlphaMode::kOpaque;
        material.base_color = color;
        material.transmission = transmission;
        scene.materials.push_back(material);
        Primitive primitive = square(2.0f, 0.0f, static_cast<Index>(scene.materials.size() - 1));
        for (glm::vec3& p : primitive.positions) p.z = depth + lean * p.x;
        const Index node = add_mesh(scene, {primitive});
        if (!turns) return;
        if (scene.animations.empty()) scene.animations.emplace_back();
        Channel channel;
        channel.node = node;
        channel.path = ChannelPath::kTranslation;
        channel.times = {0.0f, 1.0f};
        channel.values = {0, 0, 0, 0.7f, 0.2f, 0.6f};
        scene.animations[0].duration = 1.0;
        scene.animations[0].channels.push_back(channel);
    };
    add_pane({1, 0, 0, 0.3f}, 0, -3, 0.5f, true);
    add_pane({0, 1, 0, 0.6f}, 0, -3, -0.4f, false);
    add_pane({0, 0, 1, 0.5f}, 0, -3.2f, 0.0f, true);
    add_pane({0.8f, 0.8f, 0.8f, 1}, 0.7f, -2.6f, 0.2f, true);
    add_pane({0.2f, 0.2f, 0.2f, 1}, 0, -5, 0, false);
    Light sun;
    sun.kind = LightKind::kDirectional;
    add_light(scene, sun, {});
    return scene;
}

// Mean of a pixel's samples.
glm::dvec4 pixel_of(const SampleTable& samples, const Hits& hits, const TileShade& shade, int x, int y) {
    glm::dvec4 sum(0.0);
    for (int i = 0; i < kSpp; ++i) {
        const std::uint32_t point = shade.point_of_sample[hits.entry(x, y, samples.slot_of(x, y, i))];
        if (point != kBackground) sum += glm::dvec4(shade.colors[point]);
    }
    return sum / double{kSpp};
}

struct Differences {
    double sum = 0, squared = 0;
    int count = 0;
    void add(double d) { sum += d, squared += d * d, ++count; }
    double z() const { return squared > 0 ? sum / std::sqrt(squared) : 0; }  // if their mean is 0
};

// Thresholds of opacity are drawn for each triangle and for each pixel or block: blocks are what is independent.
class ABuffer : public ::testing::TestWithParam<Grouping> {};

TEST_P(ABuffer, IsTheMeanOfStochasticTransparency) {
    const Scene scene = crossing_panes();
    RenderSettings settings;
    settings.image.width = settings.image.height = kSize;
    settings.shutter.shutter = 24;  // a second
    settings.shutter.motion_blur = GetParam() != Grouping::kDefocus && GetParam() != Grouping::kStill;
    settings.camera.lens_radius = 0.1;
    settings.camera.focus_distance = 3.0;
    settings.camera.defocus = GetParam() == Grouping::kDefocus || GetParam() == Grouping::kBoth;
    const Frame frame = frame_of(scene, settings);
    ASSERT_EQ(grouping_for(frame), GetParam());
    ShadingOptions options;
    options.shadows = ShadowMode::kOff;
    const ShadingScene shading(frame, options);
    const SampleTable samples = make_samples(frame, kSpp, settings.method);
    const Visibility visibility(frame, samples, settings.method, {0, kSize, 0, kSize});
    TileShader shader;
    LayerShader layers;
    Differences of_picture[4];
    double chi = 0, noise = 0, noise_of_layers = 0;
    int regions = 0;
    for (const Tile& tile : visibility.tiles()) {
        Hits hits;
        TileShade stochastic, blended;
        CoverCounts counts;
        visibility.cover(tile, hits, counts);
        shader.shade(shading, samples, tile, hits, stochastic);
        layers.shade(visibility, shading, samples, tile, glm::vec3(0.0f), hits, blended, counts);
        Differences of_tile[4];
        glm::dvec4 last[2] = {glm::dvec4(0.0), glm::dvec4(0.0)};
        std::array<glm::dvec4, kBlocksPerCell> of_block{};
        for (int y = tile.y0; y < tile.y1; ++y)
            for (int x = tile.x0; x < tile.x1; ++x) {
                const glm::dvec4 pixel[2] = {pixel_of(samples, hits, stochastic, x, y),
                                             pixel_of(samples, hits, blended, x, y)};
                of_block[(y - tile.y0) / kBlockSize * kCellBlocks + (x - tile.x0) / kBlockSize] +=
                    (pixel[0] - pixel[1]) / double{kLanes};
                if (x > tile.x0) {
                    noise += glm::dot(pixel[0] - last[0], pixel[0] - last[0]);
                    noise_of_layers += glm::dot(pixel[1] - last[1], pixel[1] - last[1]);
                }
                last[0] = pixel[0], last[1] = pixel[1];
            }
        for (const glm::dvec4& d : of_block)
            for (int c = 0; c < 4; ++c) of_tile[c].add(d[c]), of_picture[c].add(d[c]);
        for (const Differences& d : of_tile) {
            if (d.squared == 0) continue;
            chi += d.z() * d.z();
            ++regions;
        }
    }
    for (const Differences& d : of_picture) {
        std::printf("  off by %+.6f, z %+.2f\n", d.sum / d.count, d.z());
        EXPECT_LT(std::abs(d.z()), 4.0);
    }
    // Colours and alpha of a tile hang together: four of its values have at least the spread of one taken four times.
    std::printf("  tiles: chi squared %.0f of %d; variance of neighbours %.4f and, a-buffer, %.4f\n", chi, regions,
                noise / (kSize * kSize), noise_of_layers / (kSize * kSize));
    EXPECT_GT(regions, 500);
    EXPECT_LT(chi, regions + 4 * std::sqrt(4 * 2.0 * regions));
    EXPECT_LT(noise_of_layers, 0.5 * noise);
}

INSTANTIATE_TEST_SUITE_P(Blur, ABuffer,
                         ::testing::Values(Grouping::kStill, Grouping::kMotion, Grouping::kDefocus, Grouping::kBoth));

}  // namespace
}  // namespace pentaprism
