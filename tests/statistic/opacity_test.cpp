// Masks and stochastic transparency against the areas and shares that they must have.
#include "frame/opacity.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

#include "unit/small_scene.h"

namespace pentaprism {
namespace {

using namespace small_scene;

RenderSettings picture_of(int size, int spp) {
    RenderSettings settings;
    settings.image.width = settings.image.height = size;
    settings.image.spp = spp;
    return settings;
}

// Share of the picture's samples that each triangle's part shows; the last entry is the background.
std::vector<double> shares(const Scene& scene, int size, int spp) {
    const Frame frame = frame_of(scene, picture_of(size, spp));
    const SampleTable table(spp, 0, frame.view.lens, Grouping::kStill);
    std::vector<std::int64_t> counts(frame.parts.size() + 1);
    Hits hits;
    for (int y = 0; y < size; y += kCellSize)
        for (int x = 0; x < size; x += kCellSize) {
            find_hits(frame, table, {x, y, x + kCellSize, y + kCellSize}, hits);
            for (const std::uint32_t triangle : hits.triangle)
                ++counts[triangle == kNoTriangle ? frame.parts.size() : frame.part_of[triangle]];
        }
    std::vector<double> result;
    for (const std::int64_t count : counts) result.push_back(static_cast<double>(count) / (double(size) * size * spp));
    return result;
}

Scene layers(const std::vector<float>& opacities) {
    Scene scene = scene_with_camera();
    std::vector<Primitive> squares;
    for (std::size_t i = 0; i < opacities.size(); ++i) {
        Material material;
        material.alpha_mode = AlphaMode::kBlend;
        material.base_color.w = opacities[i];
        scene.materials.push_back(material);
        squares.push_back(square(20.0f, -2.0f - static_cast<float>(i), static_cast<Index>(i)));
    }
    add_mesh(scene, squares);
    return scene;
}

TEST(StochasticTransparency, TwoLayersOfAHalfShowAHalfAQuarterAndAQuarter) {
    const std::vector<double> share = shares(layers({0.5f, 0.5f}), 64, 16);
    const double sigma = std::sqrt(0.25 * 0.75 / (64 * 64 * 16));
    EXPECT_NEAR(share[0], 0.5, 1e-3);  // stratified: nearly exact
    EXPECT_NEAR(share[1], 0.25, 4 * sigma);
    EXPECT_NEAR(share[2], 0.25, 4 * sigma);
}

TEST(StochasticTransparency, ThreeLayersFollowTheOverOperator) {
    const std::vector<double> share = shares(layers({0.2f, 0.7f, 0.4f}), 64, 16);
    EXPECT_NEAR(share[0], 0.2, 0.004);
    EXPECT_NEAR(share[1], 0.8 * 0.7, 0.006);
    EXPECT_NEAR(share[2], 0.8 * 0.3 * 0.4, 0.006);
    EXPECT_NEAR(share[3], 0.8 * 0.3 * 0.6, 0.006);
}

TEST(StochasticTransparency, EachPixelKeepsItsShareOfTheSamples) {
    for (const int spp : {1, 7, 16, 64}) {
        const Scene scene = layers({0.3f});
        const Frame frame = frame_of(scene, picture_of(32, spp));
        const float middle[3] = {0.3f, 0.3f, 0.4f};
        for (int pixel = 0; pixel < 200; ++pixel) {
            int kept = 0;
            for (int index = 0; index < spp; ++index)
                kept += is_opaque_at(frame, 0, middle, pixel, 3 * pixel, index, {spp, 0});
            EXPECT_NEAR(kept, 0.3 * spp, 1.0) << spp;
        }
    }
}

TEST(StochasticTransparency, PicturesOfOtherSeedsHaveOtherThresholds) {
    // A mean over pictures of several seeds would else keep the pattern that all of them share.
    const Scene scene = layers({0.5f});
    const Frame frame = frame_of(scene, picture_of(32, 16));
    const float middle[3] = {0.3f, 0.3f, 0.4f};
    int same = 0, asked = 0;
    for (std::uint32_t seed = 1; seed < 40; ++seed)
        for (int px = 0; px < 500; ++px, ++asked)
            same += is_opaque_at(frame, 0, middle, px, 3, 5, {16, seed}) ==
                    is_opaque_at(frame, 0, middle, px, 3, 5, {16, seed - 1});
    EXPECT_NEAR(same, 0.5 * asked, 4 * 0.5 * std::sqrt(asked));
}

TEST(StochasticTransparency, WhollyOpaqueAndWhollyClearSurfacesAreNotNoisy) {
    const std::vector<double> share = shares(layers({0.0f, 1.0f}), 32, 4);
    EXPECT_EQ(share[0], 0.0);
    EXPECT_EQ(share[1], 1.0);
}

// A disk of radius 0.35 drawn as a smooth ramp over two texels: bilinear alpha reaches 1/2 on the circle.
Scene disk(float depth) {
    Scene scene = scene_with_camera();
    const int n = 128;
    Image image{"disk", n, n, {}};
    for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x) {
            const double r = std::hypot(x + 0.5 - n / 2, y + 0.5 - n / 2) - 0.35 * n;
            const auto alpha =
                static_cast<std::uint8_t>(std::lround(255.0 * std::min(1.0, std::max(0.0, 0.5 - r / 2.0))));
            image.texels.insert(image.texels.end(), {0, 255, 0, alpha});
        }
    scene.images.push_back(image);
    Material material;
    material.alpha_mode = AlphaMode::kMask;
    material.base_color_texture.image = 0;
    scene.materials.push_back(material);
    add_mesh(scene, {square(1.0f, depth, 0)});
    return scene;
}

TEST(Mask, CoversTheAreaOfItsDiskAtAnyDistance) {
    const double disk_area = std::numbers::pi * 0.35 * 0.35;
    for (const float depth : {1.0f, 3.0f, 17.0f}) {
        const std::vector<double> share = shares(disk(-depth), 64, 16);
        const double expected = disk_area / (depth * depth);
        EXPECT_NEAR(share[0] / expected, 1.0, 0.01 + 4.0 / std::sqrt(expected * 64 * 64 * 16)) << depth;
    }
}

TEST(Mask, FactorAndVertexColourTakePart) {
    Scene scene = scene_with_camera();
    Material material;
    material.alpha_mode = AlphaMode::kMask;
    material.base_color.w = 0.8f;
    material.alpha_cutoff = 0.4f;
    scene.materials.push_back(material);
    Primitive ramp = square(1.0f, -1.0f, 0);  // from 0 at the left to 1 at the right
    ramp.colors = {{1, 1, 1, 0}, {1, 1, 1, 1}, {1, 1, 1, 1}, {1, 1, 1, 0}};
    add_mesh(scene, {ramp});
    EXPECT_NEAR(shares(scene, 64, 16)[0], 0.5, 0.003);
}

}  // namespace
}  // namespace pentaprism
