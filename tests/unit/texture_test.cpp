#include "scene/texture.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <numeric>
#include <random>

namespace pentaprism {
namespace {

Image image_of(int width, int height, const std::vector<std::uint8_t>& texels) {
    return {"test", width, height, texels};
}

Image random_image(int width, int height, std::uint32_t seed) {
    std::mt19937 random(seed);
    std::vector<std::uint8_t> texels(4 * static_cast<std::size_t>(width) * height);
    for (std::size_t i = 0; i < texels.size(); ++i) texels[i] = i % 4 == 3 ? 255 : static_cast<std::uint8_t>(random());
    return image_of(width, height, texels);
}

// Four grey texels in a row: 0, 60, 120, 180.
Image row_of_four() {
    std::vector<std::uint8_t> texels;
    for (int i = 0; i < 4; ++i)
        for (int c = 0; c < 4; ++c) texels.push_back(c == 3 ? 255 : static_cast<std::uint8_t>(60 * i));
    return image_of(4, 1, texels);
}

TextureRef wrapping(Wrap wrap) {
    TextureRef ref;
    ref.image = 0;
    ref.wrap_s = ref.wrap_t = wrap;
    return ref;
}

float code_at(const Pyramid& pyramid, Wrap wrap, float u) {
    return 255.0f * pyramid.sample(wrapping(wrap), {u, 0.5f}, 0.0f).x;
}

TEST(Texture, WrapModesGiveTheRightTexelAtItsMiddleOnEachSideOfTheImage) {
    const Pyramid pyramid(row_of_four(), Encoding::kLinear, false);
    const int mirrored[12] = {0, 1, 2, 3, 3, 2, 1, 0, 0, 1, 2, 3};
    for (int i = -8; i < 12; ++i) {
        const float u = (static_cast<float>(i) + 0.5f) / 4.0f;
        EXPECT_NEAR(code_at(pyramid, Wrap::kRepeat, u), 60.0f * static_cast<float>(((i % 4) + 4) % 4), 1e-3f) << i;
        EXPECT_NEAR(code_at(pyramid, Wrap::kMirroredRepeat, u), 60.0f * static_cast<float>(mirrored[((i % 8) + 8) % 8]),
                    1e-3f)
            << i;
        EXPECT_NEAR(code_at(pyramid, Wrap::kClampToEdge, u), 60.0f * static_cast<float>(std::clamp(i, 0, 3)), 1e-3f)
            << i;
    }
}

TEST(Texture, TheBorderIsMixedWithWhatTheWrapModePutsBesideIt) {
    const Pyramid pyramid(row_of_four(), Encoding::kLinear, false);
    for (const float u : {0.0f, 1.0f}) EXPECT_NEAR(code_at(pyramid, Wrap::kRepeat, u), 90.0f, 1e-3f);  // texels 3 and 0
    EXPECT_NEAR(code_at(pyramid, Wrap::kMirroredRepeat, 0.0f), 0.0f, 1e-3f);
    EXPECT_NEAR(code_at(pyramid, Wrap::kMirroredRepeat, 1.0f), 180.0f, 1e-3f);
    EXPECT_NEAR(code_at(pyramid, Wrap::kClampToEdge, 1.0f), 180.0f, 1e-3f);
    EXPECT_NEAR(code_at(pyramid, Wrap::kRepeat, 1.0f + 1e-7f), 90.0f, 1e-2f);
}

TEST(Texture, FarAwayAndMeaninglessCoordinatesGiveFiniteColours) {
    const Pyramid pyramid(random_image(37, 5, 1), Encoding::kSrgb, false);
    const float infinity = std::numeric_limits<float>::infinity();
    for (const Wrap wrap : {Wrap::kRepeat, Wrap::kMirroredRepeat, Wrap::kClampToEdge})
        for (const float u : {1e4f, -1e4f, 1e20f, -1e-20f, -1e-8f, 3e38f, infinity, -infinity, std::nanf("")})
            for (const float level : {0.0f, 2.5f, 99.0f, infinity, std::nanf("")}) {
                const glm::vec4 value = pyramid.sample(wrapping(wrap), {u, -u}, level);
                for (int c = 0; c < 4; ++c) EXPECT_TRUE(value[c] >= 0.0f && value[c] <= 1.0f) << u << ' ' << level;
                EXPECT_TRUE(std::isfinite(pyramid.alpha(wrapping(wrap), {u, -u})));
            }
}

TEST(Texture, WholePeriodsDoNotChangeTheLookUp) {
    const Pyramid pyramid(random_image(64, 64, 2), Encoding::kSrgb, false);
    for (const float u : {0.125f, 0.3f, 0.77f}) {
        const glm::vec4 here = pyramid.sample(wrapping(Wrap::kRepeat), {u, 0.25f}, 0.0f);
        const glm::vec4 far = pyramid.sample(wrapping(Wrap::kRepeat), {u + 8.0f, 0.25f - 8.0f}, 0.0f);
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(here[c], far[c], 1e-4f);
    }
}

TEST(Texture, EachOfThe256CodesIsDecodedAsTheStandardSays) {
    std::vector<std::uint8_t> texels;
    for (int i = 0; i < 256; ++i)
        for (int c = 0; c < 4; ++c) texels.push_back(static_cast<std::uint8_t>(i));
    const Pyramid pyramid(image_of(256, 1, texels), Encoding::kSrgb, false);
    for (int i = 0; i < 256; ++i) {
        const double x = i / 255.0, linear = x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4);
        EXPECT_NEAR(pyramid.texel(0, i, 0).x, linear, 1e-7) << i;
        EXPECT_NEAR(pyramid.texel(0, i, 0).w, x, 1e-7) << i;  // opacity is never encoded
    }
}

TEST(Texture, AConstantImageKeepsItsCodeInAllLevels) {
    for (int code = 0; code < 256; ++code) {
        const Pyramid pyramid(image_of(5, 3, std::vector<std::uint8_t>(60, static_cast<std::uint8_t>(code))),
                              Encoding::kSrgb, false);
        ASSERT_EQ(pyramid.level_count(), 3);
        const glm::vec4 base = pyramid.texel(0, 0, 0);
        for (int level = 1; level < 3; ++level) EXPECT_EQ(pyramid.texel(level, 0, 0), base) << code;
    }
}

// One step of rounding to 8 bits for each level; at its brightest a code is 0.009 wide in linear light.
TEST(Texture, LevelsKeepTheMeanInLinearLightForAnySize) {
    for (const auto& [width, height] :
         std::vector<std::pair<int, int>>{{1, 1}, {1, 9}, {7, 1}, {13, 6}, {64, 32}, {31, 33}}) {
        const Pyramid pyramid(random_image(width, height, 3), Encoding::kSrgb, false);
        const auto mean_of = [&](int level, int w, int h) {
            double sum = 0.0;
            for (int y = 0; y < h; ++y)
                for (int x = 0; x < w; ++x) sum += pyramid.texel(level, x, y).y;
            return sum / (w * h);
        };
        const double base = mean_of(0, width, height);
        int w = width, h = height;
        for (int level = 1; level < pyramid.level_count(); ++level) {
            w = std::max(1, w / 2), h = std::max(1, h / 2);
            EXPECT_NEAR(mean_of(level, w, h), base, 0.0045 * level) << width << 'x' << height << " level " << level;
        }
        EXPECT_EQ(w, 1);
        EXPECT_EQ(h, 1);
    }
}

TEST(Texture, ALevelBetweenTwoIsTheirMix) {
    const Pyramid pyramid(random_image(32, 32, 4), Encoding::kSrgb, false);
    const TextureRef ref = wrapping(Wrap::kRepeat);
    const glm::vec2 uv = {0.37f, 0.61f};
    const glm::vec4 fine = pyramid.sample(ref, uv, 2.0f), coarse = pyramid.sample(ref, uv, 3.0f);
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(pyramid.sample(ref, uv, 2.25f)[c], 0.75f * fine[c] + 0.25f * coarse[c], 1e-6f);
}

TEST(Texture, TheColourUnderTransparentTexelsDoesNotBleedIntoLevelsOfACutOut) {
    std::vector<std::uint8_t> texels(4 * 4 * 4, 0);                           // black and transparent
    for (int i = 0; i < 4; ++i) texels[4 * i + 1] = texels[4 * i + 3] = 255;  // one opaque green row
    const Pyramid cut_out(image_of(4, 4, texels), Encoding::kSrgb, true),
        plain(image_of(4, 4, texels), Encoding::kSrgb, false);
    EXPECT_EQ(cut_out.texel(2, 0, 0).y, 1.0f);
    EXPECT_NEAR(cut_out.texel(2, 0, 0).w, 0.25f, 0.005f);
    EXPECT_NEAR(plain.texel(2, 0, 0).y, 0.25f, 0.01f);
}

TEST(Texture, AlphaAloneEqualsTheAlphaOfTheBilinearLookUp) {
    Image image = random_image(19, 23, 5);
    std::mt19937 random(6);
    for (std::size_t i = 3; i < image.texels.size(); i += 4) image.texels[i] = static_cast<std::uint8_t>(random());
    const Pyramid pyramid(image, Encoding::kSrgb, true);
    std::uniform_real_distribution<float> anywhere(-3.0f, 3.0f);
    for (int i = 0; i < 1000; ++i) {
        const glm::vec2 uv = {anywhere(random), anywhere(random)};
        const TextureRef ref = wrapping(static_cast<Wrap>(i % 3));
        EXPECT_NEAR(pyramid.alpha(ref, uv), pyramid.sample(ref, uv, 0.0f).w, 1e-5f);
    }
}

// The example of KHR_texture_transform: offset (0, 1), a quarter turn and scale 1/2 use the lower left quadrant.
TEST(Texture, TheTransformOfTheExtensionsExampleUsesTheLowerLeftQuadrant) {
    TextureRef ref;
    ref.offset = {0.0f, 1.0f};
    ref.rotation = 1.57079632679f;
    ref.scale = {0.5f, 0.5f};
    for (const glm::vec2 uv : {glm::vec2(0.1f, 0.1f), glm::vec2(0.9f, 0.1f), glm::vec2(0.5f, 0.9f)}) {
        const glm::vec2 placed = transform_uv(ref, uv);
        EXPECT_TRUE(placed.x > 0.0f && placed.x < 0.5f) << placed.x;
        EXPECT_TRUE(placed.y > 0.5f && placed.y < 1.0f) << placed.y;
    }
}

TEST(Texture, AnImageThatIsColourAndDataIsTwoTextures) {
    Scene scene;
    scene.images.push_back(image_of(1, 1, {128, 128, 128, 255}));
    scene.images.push_back(image_of(1, 1, {9, 9, 9, 255}));
    scene.materials.resize(1);
    scene.materials[0].base_color_texture.image = 0;
    scene.materials[0].metallic_roughness_texture.image = 0;
    const auto textures = make_textures(scene);
    const TextureRef& ref = scene.materials[0].base_color_texture;
    ASSERT_TRUE(textures->color(ref) && textures->data(ref));
    EXPECT_NEAR(textures->color(ref)->texel(0, 0, 0).x, 0.21586f, 1e-4f);
    EXPECT_NEAR(textures->data(ref)->texel(0, 0, 0).x, 128.0f / 255.0f, 1e-6f);
    TextureRef unused;
    EXPECT_EQ(textures->color(unused), nullptr);
    unused.image = 1;
    EXPECT_EQ(textures->color(unused), nullptr);
    unused.image = 7;
    EXPECT_EQ(textures->data(unused), nullptr);
}

}  // namespace
}  // namespace pentaprism
