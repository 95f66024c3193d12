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

// Thresholds over time, as pictures with motion blur have them.
float over_time(std::uint32_t triangle, int px, int py, int index, int spp, std::uint32_t seed = 0) {
    return opacity_threshold(triangle, px, py, index, OpacityPattern(spp, seed, true));
}

TEST(ThresholdsOverTime, OfAPixelAreOneInEachOfSppIntervals) {
    for (const int spp : {1, 2, 3, 4, 8, 16, 32, 64, 100, 256, 2048, 4096})
        for (std::uint32_t triangle = 0; triangle < 20; ++triangle) {
            std::vector<int> count(spp);
            for (int index = 0; index < spp; ++index)
                ++count[static_cast<std::size_t>(over_time(triangle, 7, 2, index, spp) * static_cast<float>(spp))];
            EXPECT_EQ(std::count(count.begin(), count.end(), 1), spp) << spp;
        }
}

// What thresholds that are a permutation by chance of the whole pixel do not have.
TEST(ThresholdsOverTime, OfEachRunOfTimesAreOneInEachOfEqualIntervals) {
    for (const int spp : {4, 8, 16, 64, 128, 256})
        for (int run = 4; run <= spp; run *= 4)
            for (std::uint32_t triangle = 0; triangle < 10; ++triangle)
                for (int first = 0; first < spp; first += run) {
                    std::vector<int> count(run);
                    for (int index = first; index < first + run; ++index)
                        ++count[static_cast<std::size_t>(over_time(triangle, 5, 9, index, spp) *
                                                         static_cast<float>(run))];
                    EXPECT_EQ(std::count(count.begin(), count.end(), 1), run) << spp << ", times from " << first;
                }
}

TEST(ThresholdsOverTime, OfABlockAreInDifferentSixteenthsAtEachTime) {
    for (const int spp : {1, 2, 4, 8, 16, 64, 1024})
        for (int index = 0; index < spp; index += 1 + spp / 20)
            for (int block = 0; block < 20; ++block) {
                std::uint32_t sixteenths = 0;
                for (int pixel = 0; pixel < 16; ++pixel)
                    sixteenths |=
                        1u << static_cast<int>(16 * over_time(3, 4 * block + pixel % 4, 8 + pixel / 4, index, spp));
                EXPECT_EQ(sixteenths, 0xffffu) << spp << ", time " << index;
            }
}

// Sums of what is independent: blocks, of which all thresholds of a triangle hang together.
struct Blocks {
    double n = 0, sum = 0, squares = 0;
    void add(double x) { n += 1, sum += x, squares += x * x; }
    double mean() const { return sum / n; }
    double variance() const { return (squares - sum * sum / n) / (n - 1); }
    double z(double expected) const {
        const double error = std::sqrt(variance() / n);
        return error > 0 ? (mean() - expected) / error : (mean() == expected ? 0 : 1e9);
    }
};

// Share of a block's samples that see through all of some layers; `of_pixels`: the same of each pixel.
Blocks seen_through(int layers, float opacity, int spp, std::uint32_t first_triangle, Blocks& of_pixels) {
    Blocks blocks;
    for (int block = 0; block < 2000; ++block) {
        int in_block = 0;
        for (int pixel = 0; pixel < 16; ++pixel) {
            int seen = 0;
            for (int index = 0; index < spp; ++index) {
                bool through = true;
                for (int i = 0; through && i < layers; ++i)
                    through = !(opacity > over_time(first_triangle + i, 4 * (block % 64) + pixel % 4,
                                                    4 * (block / 64) + pixel / 4, index, spp, 11));
                seen += through;
            }
            of_pixels.add(double(seen) / spp);
            in_block += seen;
        }
        blocks.add(double(in_block) / (16 * spp));
    }
    return blocks;
}

TEST(ThresholdsOverTime, OfStackedLayersMultiplyAndDoNotHideTogether) {
    for (const int spp : {1, 2, 4, 8, 16, 64})
        for (const int layers : {2, 3, 8})
            for (const float opacity : {0.5f, 0.3f}) {
                Blocks pixels;
                const Blocks blocks = seen_through(layers, opacity, spp, 100, pixels);
                const double expected = std::pow(1.0 - opacity, layers);
                EXPECT_LT(std::abs(blocks.z(expected)), 4.5) << layers << " layers, " << spp;
                // Layers whose thresholds were shifted copies of each other would vary many times as much as those
                // drawn without any order; half more is what two in the order of time may have.
                const double by_chance = expected * (1 - expected) / spp;
                if (layers > 2 || spp < 4) {
                    EXPECT_LT(pixels.variance(), 1.1 * by_chance) << layers << " layers, " << spp;
                }
                EXPECT_LT(blocks.variance(), 1.3 * pixels.variance() / 16) << layers << " layers, " << spp;
                if (layers != 2) continue;
                const double a = opacity * (1 - opacity), drawn = a * a / std::max(1, spp - 1);
                if (opacity == 0.5f && spp > 1) {
                    EXPECT_LT(pixels.variance(), 1.4 * drawn) << spp;
                }
            }
}

TEST(ThresholdsOverTime, OfTwoTrianglesAndOfOneInTwoBlocksAreUncorrelatedAndUniform) {
    for (const int spp : {1, 4, 16}) {
        Blocks mean, square, triangles, neighbours;
        for (int block = 0; block < 20000; ++block) {
            const int px = 4 * (block % 100) + 1, py = 4 * (block / 100) + 2, index = block % spp;
            const double a = over_time(7, px, py, index, spp), b = over_time(8, px, py, index, spp),
                         c = over_time(7, px + 4, py, index, spp);
            mean.add(a), square.add(a * a);
            triangles.add((a - 0.5) * (b - 0.5));
            neighbours.add((a - 0.5) * (c - 0.5));
        }
        EXPECT_LT(std::abs(mean.z(0.5)), 4.5) << spp;
        EXPECT_LT(std::abs(square.z(1.0 / 3.0)), 4.5) << spp;
        EXPECT_LT(std::abs(triangles.z(0.0)), 4.5) << spp;
        EXPECT_LT(std::abs(neighbours.z(0.0)), 4.5) << spp;
    }
}

TEST(ThresholdsOverTime, AreForPicturesWhoseSamplesAreInTheOrderOfTime) {
    const Lens lens;
    for (const auto& [grouping, in_order] : {std::pair(Grouping::kStill, false), std::pair(Grouping::kDefocus, false),
                                             std::pair(Grouping::kMotion, true), std::pair(Grouping::kBoth, true)}) {
        EXPECT_EQ(OpacityPattern(SampleTable(16, 0, lens, grouping)).over_time, in_order);
        EXPECT_FALSE(OpacityPattern(SampleTable(12, 0, lens, grouping)).over_time);
        const SampleTable free(16, 0, lens, grouping, SamplePattern::kFree, {}, {}, Sampler::kSobol);
        EXPECT_FALSE(OpacityPattern(free).over_time);
    }
    for (const Grouping grouping : {Grouping::kMotion, Grouping::kBoth, Grouping::kTime}) {
        const SampleTable table(16, 3, lens, grouping);
        for (int px = 0; px < 8; ++px)
            for (int index = 0; index < 16; ++index) {
                const int interval = static_cast<int>(16 * table.sample(px, 5, index).t);
                EXPECT_EQ(interval / 4, index / 4);
                if (grouping == Grouping::kMotion) {
                    EXPECT_EQ(interval, index);
                }
            }
    }
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
