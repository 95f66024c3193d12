// The A-buffer of `--transparency a-buffer`: known colours, any order, any length of list, against chance in the mean.
#include "cover/layers.h"

#include <cmath>
#include <gtest/gtest.h>

#include "render/layer_shading.h"
#include "unit/small_scene.h"

namespace pentaprism {
namespace {

using namespace small_scene;

TEST(Layers, KeepTheNearestInOrderAndGoOnBehindThem) {
    Layers layers(2);
    layers.reset(9);
    const Fragment all[] = {{5, 1, 0.5f}, {3, 2, 0.5f}, {4, 3, 0.5f}, {3, 1, 0.5f}, {9, 0, 0.5f}};
    std::vector<std::uint32_t> order;
    int passes = 0;
    do {
        ++passes;
        for (const Fragment& fragment : all) layers.add(7, fragment);
        if (passes == 1) layers.add(8, all[0]);  // seen whole at once; asked again, it adds nothing
        for (const Fragment& fragment : layers.fragments(7)) order.push_back(fragment.triangle);
        EXPECT_EQ(layers.fragments(8).size(), passes == 1 ? 1u : 0u);
    } while (layers.next_pass());
    EXPECT_EQ(passes, 3);
    EXPECT_EQ(order, (std::vector<std::uint32_t>{1, 2, 3, 1, 0}));  // depths 3, 3, 4, 5, 9
}

// Squares one behind the other that emit light, and an opaque one behind them.
Scene panes(const std::vector<float>& opacities, bool opaque_behind) {
    Scene scene = scene_with_camera();
    std::vector<Primitive> squares;
    for (std::size_t i = 0; i < opacities.size() + opaque_behind; ++i) {
        Material material;
        const bool pane = i < opacities.size();
        material.alpha_mode = pane ? AlphaMode::kBlend : AlphaMode::kOpaque;
        material.base_color = glm::vec4(0, 0, 0, pane ? opacities[i] : 1.0f);
        material.unlit = true;
        material.base_color.x = static_cast<float>(i + 1) / 16;
        scene.materials.push_back(material);
        squares.push_back(square(20.0f, -2.0f - static_cast<float>(i), static_cast<Index>(i)));
    }
    std::reverse(squares.begin(), squares.end());  // the order of drawing does not matter
    add_mesh(scene, squares);
    return scene;
}

struct Shown {
    std::vector<glm::vec4> colors;  // of the samples of one tile
    Hits hits;
};

Shown shown(const Scene& scene, int most_in_a_pass, double shutter = 0) {
    RenderSettings settings;
    settings.image.width = settings.image.height = 32;
    settings.image.spp = 4;
    settings.shutter.shutter = shutter;
    const Frame frame = frame_of(scene, settings);
    const SampleTable samples = make_samples(frame, settings.image.spp, settings.method);
    const Visibility visibility(frame, samples, settings.method, {0, 32, 0, 32});
    const ShadingScene shading(frame, ShadingOptions{});
    LayerShader shader(most_in_a_pass);
    Shown result;
    TileShade shade;
    CoverCounts counts;
    const glm::vec3 background(0.0f, 0.25f, 0.0f);
    shader.shade(visibility, shading, samples, {0, 0, 32, 32}, background, result.hits, shade, counts);
    for (const std::uint32_t point : shade.point_of_sample)
        result.colors.push_back(point == kBackground ? glm::vec4(background, 0.0f) : shade.colors[point]);
    return result;
}

TEST(ABuffer, ShowsPanesOneOverTheOther) {
    const Shown opaque = shown(panes({0.2f, 0.5f}, true), 8), open = shown(panes({0.2f, 0.5f}, false), 8);
    const float red = (0.2f * 1 + 0.8f * 0.5f * 2) / 16;
    for (std::size_t s = 0; s < opaque.colors.size(); ++s) {
        EXPECT_NEAR(opaque.colors[s].x, red + 0.4f * 3 / 16, 1e-6f);
        EXPECT_EQ(opaque.colors[s].w, 1.0f);
        EXPECT_NEAR(open.colors[s].x, red, 1e-6f);
        EXPECT_NEAR(open.colors[s].y, 0.4f * 0.25f, 1e-6f);
        EXPECT_NEAR(open.colors[s].w, 0.6f, 1e-6f);
        EXPECT_EQ(opaque.hits.depth[s], 3.0f);  // the second pane stops more than half of what was left
    }
}

TEST(ABuffer, DoesNotDependOnHowManyFitIntoAPass) {
    const std::vector<float> opacities{0.1f, 0.3f, 0.0f, 0.2f, 0.25f, 0.15f, 0.4f, 0.1f, 0.05f, 0.3f, 0.2f};
    const Shown all = shown(panes(opacities, true), 32);
    for (const int most : {1, 2, 3, 8}) {
        const Shown few = shown(panes(opacities, true), most);
        EXPECT_TRUE(few.colors == all.colors) << most;
        EXPECT_TRUE(few.hits.triangle == all.hits.triangle) << most;
    }
}

}  // namespace
}  // namespace pentaprism
