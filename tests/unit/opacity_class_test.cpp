#include "scene/opacity_class.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "scene/texture.h"

namespace pentaprism {
namespace {

// Discs of opacity 255 on 0, with grey rims.
Image blobs(int width, int height) {
    Image image{"blobs", width, height, {}};
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const double wave = 1.5 + std::sin(x * 0.4) + std::sin(y * 0.3 + 1.0);
            const auto alpha = static_cast<std::uint8_t>(std::clamp(wave * 120.0, 0.0, 255.0));
            image.texels.insert(image.texels.end(), {1, 2, 3, alpha});
        }
    return image;
}

// Small triangles anywhere in texture space, twelve periods to each side.
Scene scene_of(AlphaMode mode, Wrap wrap, int triangles) {
    Scene scene;
    scene.images.push_back(blobs(61, 40));
    Material material;
    material.alpha_mode = mode;
    material.base_color_texture.image = 0;
    material.base_color_texture.wrap_s = material.base_color_texture.wrap_t = wrap;
    material.base_color_texture.offset = {0.3f, -0.2f};
    material.base_color_texture.rotation = 0.5f;
    scene.materials.push_back(material);
    std::mt19937 random(11);
    std::uniform_real_distribution<float> place(wrap == Wrap::kClampToEdge ? -0.5f : -12.0f,
                                                wrap == Wrap::kClampToEdge ? 1.5f : 12.0f);
    std::uniform_real_distribution<float> extent(-0.02f, 0.02f);
    Primitive primitive;
    primitive.material = 0;
    for (int t = 0; t < triangles; ++t) {
        const glm::vec2 middle(place(random), place(random));
        for (int k = 0; k < 3; ++k) {
            primitive.texcoords[0].push_back(middle + glm::vec2(extent(random), extent(random)));
            primitive.indices.push_back(static_cast<std::uint32_t>(primitive.indices.size()));
        }
    }
    primitive.positions.resize(primitive.indices.size());
    scene.meshes.push_back({"mesh", {primitive}, {}});
    return scene;
}

TEST(OpacityClass, NoPointOfASolidOrClearTriangleSaysOtherwise) {
    for (const Wrap wrap : {Wrap::kRepeat, Wrap::kMirroredRepeat, Wrap::kClampToEdge}) {
        const Scene scene = scene_of(AlphaMode::kMask, wrap, 3000);
        const auto textures = make_textures(scene);
        const Primitive& primitive = scene.meshes[0].primitives[0];
        const TextureRef& ref = scene.materials[0].base_color_texture;
        const OpacityClass* classes = textures->opacity_classes(0, 0);
        ASSERT_NE(classes, nullptr);
        int counts[3] = {};
        std::mt19937 random(12);
        std::uniform_real_distribution<float> share(0.0f, 1.0f);
        for (int t = 0; t < 3000; ++t) {
            ++counts[static_cast<int>(classes[t])];
            if (classes[t] == OpacityClass::kMixed) continue;
            for (int i = 0; i < 50; ++i) {
                float a = share(random), b = share(random);
                if (a + b > 1.0f) a = 1.0f - a, b = 1.0f - b;
                const glm::vec2* uv = &primitive.texcoords[0][3 * t];
                const float alpha =
                    textures->color(ref)->alpha(ref, transform_uv(ref, a * uv[0] + b * uv[1] + (1.0f - a - b) * uv[2]));
                ASSERT_EQ(alpha >= 0.5f, classes[t] == OpacityClass::kSolid) << t;
            }
        }
        EXPECT_GT(counts[0], 300);
        EXPECT_GT(counts[1], 300);
        EXPECT_GT(counts[2], 100);
    }
}

TEST(OpacityClass, ABlendedTriangleIsSolidOnlyWhereItsOpacityIsOne) {
    Scene scene = scene_of(AlphaMode::kBlend, Wrap::kRepeat, 2000);
    const auto classes_of = [&] {
        const auto textures = make_textures(scene);
        const OpacityClass* first = textures->opacity_classes(0, 0);
        return std::vector<OpacityClass>(first, first + 2000);
    };
    const auto count = [](const std::vector<OpacityClass>& classes, OpacityClass which) {
        return std::count(classes.begin(), classes.end(), which);
    };
    EXPECT_GT(count(classes_of(), OpacityClass::kSolid), 100);
    scene.materials[0].base_color.w = 0.99f;
    EXPECT_EQ(count(classes_of(), OpacityClass::kSolid), 0);
    scene.materials[0].base_color.w = 0.0f;
    EXPECT_EQ(count(classes_of(), OpacityClass::kClear), 2000);
}

TEST(OpacityClass, AnOpaqueMaterialIsNotClassified) {
    const Scene scene = scene_of(AlphaMode::kOpaque, Wrap::kRepeat, 5);
    EXPECT_EQ(make_textures(scene)->opacity_classes(0, 0), nullptr);
}

}  // namespace
}  // namespace pentaprism
