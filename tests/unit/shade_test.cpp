#include <cmath>
#include <cstring>
#include <glm/gtc/quaternion.hpp>
#include <gtest/gtest.h>
#include <numbers>

#include "resolve/film.h"
#include "shade/brdf.h"
#include "shade/shade_tile.h"
#include "small_scene.h"

namespace pentaprism {
namespace {

using namespace small_scene;

constexpr int kSize = 64;

RenderSettings settings_of(int spp) {
    RenderSettings settings;
    settings.image.width = settings.image.height = kSize;
    settings.image.spp = spp;
    settings.image.filter = Filter::kBox;
    return settings;
}

// Light of so many lux that travels along -z, turned about the y axis.
void add_sun(Scene& scene, float lux, double angle = 0.0) {
    Light light;
    light.kind = LightKind::kDirectional;
    light.intensity = lux;
    Transform transform;
    transform.rotation = glm::angleAxis(angle, glm::dvec3(0.0, 1.0, 0.0));
    add_light(scene, light, transform);
}

std::vector<float> draw(const Scene& scene, const RenderSettings& settings, int tile_size = 32,
                        const ShadingOptions& options = {}) {
    const Frame frame = frame_of(scene, settings);
    const SampleTable table(settings.image.spp, 0, frame.view.lens, Grouping::kBoth);
    const ShadingScene shading(frame, options);
    const TileFilter filter(settings.image.filter, glm::vec3(0.0f));
    Film film({0, 0, kSize, kSize, kSize, filter.reach(), 0.0});
    TileSums sums;
    TileShader shader;
    Hits hits;
    TileShade shade;
    for (int y = 0; y < kSize; y += tile_size)
        for (int x = 0; x < kSize; x += tile_size) {
            const Tile tile{x, y, x + tile_size, y + tile_size};
            find_hits(frame, table, tile, hits);
            shader.shade(shading, table, tile, hits, shade);
            sums.start(tile, filter.reach(), 0);
            filter.add(table, hits, shade, sums);
            film.add(sums);
        }
    const PixelRows rows = film.take_rows(kSize, true);
    return {rows.rgba.begin(), rows.rgba.end()};
}

glm::vec4 pixel(const std::vector<float>& rgba, int x, int y) {
    const std::size_t at = 4 * (static_cast<std::size_t>(y) * kSize + x);
    return {rgba[at], rgba[at + 1], rgba[at + 2], rgba[at + 3]};
}

Material matte(const glm::vec3& color) {
    Material material;
    material.base_color = glm::vec4(color, 1.0f);
    material.metallic = 0.0f;
    return material;
}

TEST(Shade, ALightOfPiLuxMakesAWhiteSurfaceAboutOne) {
    Scene scene = scene_with_camera();
    scene.materials = {matte(glm::vec3(1.0f))};
    add_mesh(scene, {square(3.0f, -2.0f, 0)});
    add_sun(scene, std::numbers::pi_v<float>);
    const glm::vec4 middle = pixel(draw(scene, settings_of(1)), kSize / 2, kSize / 2);
    EXPECT_NEAR(middle.x, 1.0f, 0.05f);
    EXPECT_EQ(middle.w, 1.0f);
}

TEST(Shade, RadianceIsLuxTimesBrdfTimesCosine) {
    Scene scene = scene_with_camera();
    scene.materials = {matte({0.2f, 0.5f, 0.8f})};
    scene.materials[0].roughness = 0.6f;
    scene.materials[0].metallic = 0.3f;
    add_mesh(scene, {square(3.0f, -2.0f, 0)});
    const double angle = 0.7;
    add_sun(scene, 2.0f, angle);
    RenderSettings settings = settings_of(1);
    const std::vector<float> picture = draw(scene, settings);
    const SamplePoint s = SampleTable(1, 0, Lens{}, Grouping::kBoth).sample(20, 30, 0);
    const double x = (20 + s.x - 32.0) / 32.0, y = -(30 + s.y - 32.0) / 32.0;
    const glm::dvec3 to_eye = glm::normalize(glm::dvec3(-x, -y, 1.0)), to_light(std::sin(angle), 0.0, std::cos(angle));
    const glm::dvec3 half = glm::normalize(to_eye + to_light);
    const Brdf brdf({0.2f, 0.5f, 0.8f}, 0.3f, 0.6f, static_cast<float>(to_eye.z));
    const glm::vec3 expected = 2.0f * brdf.reflected(static_cast<float>(to_light.z), static_cast<float>(half.z),
                                                     static_cast<float>(glm::dot(half, to_eye)));
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(pixel(picture, 20, 30)[c], expected[c], 1e-4f * expected[c]);
}

TEST(Shade, AnUnlitTextureShowsItsTexelsAndItsRowsRunDownwards) {
    Scene scene = scene_with_camera();
    scene.images.push_back({"four", 2, 2, {255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 255, 255, 255, 255}});
    scene.materials = {matte(glm::vec3(1.0f))};
    scene.materials[0].unlit = true;
    scene.materials[0].base_color_texture.image = 0;
    scene.materials[0].base_color_texture.wrap_s = scene.materials[0].base_color_texture.wrap_t = Wrap::kClampToEdge;
    add_mesh(scene, {square(2.0f, -2.0f, 0)});
    const std::vector<float> picture = draw(scene, settings_of(4));
    EXPECT_EQ(pixel(picture, 2, 2), glm::vec4(1, 0, 0, 1));
    EXPECT_EQ(pixel(picture, 61, 2), glm::vec4(0, 1, 0, 1));
    EXPECT_EQ(pixel(picture, 2, 61), glm::vec4(0, 0, 1, 1));
    EXPECT_EQ(pixel(picture, 61, 61), glm::vec4(1, 1, 1, 1));
}

TEST(Shade, AFineCheckerboardBecomesTheMeanOfItsColoursInLinearLight) {
    Scene scene = scene_with_camera();
    Image checker{"checker", 512, 512, {}};
    for (int y = 0; y < 512; ++y)
        for (int x = 0; x < 512; ++x) {
            const std::uint8_t code = (x + y) % 2 ? 255 : 0;
            checker.texels.insert(checker.texels.end(), {code, code, code, 255});
        }
    scene.images.push_back(checker);
    scene.materials = {matte(glm::vec3(1.0f))};
    scene.materials[0].unlit = true;
    scene.materials[0].base_color_texture.image = 0;
    add_mesh(scene, {square(2.0f, -2.0f, 0)});
    for (const auto& [x, y] : std::vector<std::pair<int, int>>{{5, 5}, {31, 32}, {60, 17}})
        EXPECT_NEAR(pixel(draw(scene, settings_of(1)), x, y).x, 0.5f, 0.005f);
}

TEST(Shade, TheBackOfATwoSidedSurfaceIsLitFromItsOwnSide) {
    Scene scene = scene_with_camera();
    scene.materials = {matte(glm::vec3(1.0f))};
    scene.materials[0].double_sided = true;
    Primitive turned = square(3.0f, -2.0f, 0);
    turned.indices = {0, 2, 1, 0, 3, 2};
    turned.normals.assign(4, {0.0f, 0.0f, -1.0f});
    add_mesh(scene, {turned});
    add_sun(scene, std::numbers::pi_v<float>);
    EXPECT_NEAR(pixel(draw(scene, settings_of(1)), 32, 32).x, 1.0f, 0.05f);
}

// Normals of leaves that are to look like a ball may lean beyond the horizon. They are bent back for what is mirrored,
// but a light that they turn from must not shine on them.
TEST(Shade, ALightBehindTheGivenNormalAddsNothing) {
    const auto red = [](const glm::vec3& normal, double sun_angle) {
        Scene scene = scene_with_camera();
        scene.materials = {matte(glm::vec3(1.0f))};
        Primitive leaf = square(3.0f, -2.0f, 0);
        leaf.normals.assign(4, glm::normalize(normal));
        add_mesh(scene, {leaf});
        add_sun(scene, std::numbers::pi_v<float>, sun_angle);
        return pixel(draw(scene, settings_of(1)), 32, 32).x;
    };
    EXPECT_GT(red({0.8f, 0.0f, 0.6f}, 0.0), 0.3f);
    EXPECT_EQ(red({0.8f, 0.0f, -0.6f}, 0.0), 0.0f);
    EXPECT_GT(red({0.8f, 0.0f, -0.6f}, 1.2), 0.1f);  // the light stands on the side to which they lean
}

// The surface that stands for a rounded one is lifted for shadows; leaves whose normals merely spread are not.
TEST(Shade, OnlyFacetsAlongTheSmoothSurfaceAreLiftedOverTheirShadows) {
    const auto height = [](float along) {
        Scene scene = scene_with_camera();
        scene.materials = {matte(glm::vec3(1.0f))};
        Primitive facet = square(1.0f, -2.0f, 0);
        for (int i = 0; i < 4; ++i)
            facet.normals[i] = glm::normalize(glm::vec3(glm::vec2(facet.positions[i]) / std::sqrt(2.0f), along));
        add_mesh(scene, {facet});
        add_sun(scene, 1.0f, 1.6);  // from just below the facet's horizon
        const Frame frame = frame_of(scene, settings_of(1));
        const ShadingScene shading(frame, {});
        LitColor lit;
        const ShadedTriangle triangle(shading, 0, 1.0f);
        light_point(shading, triangle.material(), triangle.surface({0.3f, 0.3f, 0.4f}, true, ShadingCell{}), lit);
        return lit.shadowed.empty() ? -1.0f : glm::length(lit.shadowed[0].offset);
    };
    EXPECT_GT(height(1.5f), 0.1f);
    EXPECT_EQ(height(0.2f), 0.0f);
}

TEST(Shade, WithoutLightsTheDefaultOnesShowEverySide) {
    Scene scene = scene_with_camera();
    scene.materials = {matte(glm::vec3(0.5f))};
    add_mesh(scene, {square(3.0f, -2.0f, 0)});
    const float default_light = pixel(draw(scene, settings_of(1)), 32, 32).x;
    EXPECT_GT(default_light, 0.05f);
    EXPECT_LT(default_light, 1.0f);
    add_sun(scene, 1.0f, std::numbers::pi);  // from behind: with a light of its own the scene has no ambient light
    EXPECT_EQ(pixel(draw(scene, settings_of(1)), 32, 32).x, 0.0f);
}

TEST(Shade, OnePointForEachTriangleAndPixelOfAStillSurface) {
    Scene scene = scene_with_camera();
    scene.materials = {matte(glm::vec3(1.0f))};
    add_mesh(scene, {square(3.0f, -2.0f, 0)});
    const RenderSettings settings = settings_of(16);
    const Frame frame = frame_of(scene, settings);
    const SampleTable table(16, 0, frame.view.lens, Grouping::kStill);
    const Tile tile{0, 0, 32, 32};
    Hits hits;
    find_hits(frame, table, tile, hits);
    TileShade shade;
    const std::int64_t points = TileShader().shade(ShadingScene(frame), table, tile, hits, shade);
    EXPECT_GE(points, 1024);
    EXPECT_LE(points, 1024 + 64);  // the diagonal's pixels see both triangles
    // A colour for each quarter of the shutter: the default light casts shadows.
    EXPECT_LE(static_cast<std::int64_t>(shade.colors.size()), 4 * points);
}

// Moving, out of focus, of three materials, one textured; drawn with tiles of each size.
TEST(Shade, TheTileSizeDoesNotChangeABit) {
    Scene scene = scene_with_camera();
    Image stripes{"stripes", 16, 16, {}};
    for (int i = 0; i < 256; ++i) {
        const std::uint8_t code = i % 3 ? 255 : 10;
        stripes.texels.insert(stripes.texels.end(), {code, 80, static_cast<std::uint8_t>(255 - code), 255});
    }
    scene.images.push_back(stripes);
    scene.materials = {matte({0.9f, 0.3f, 0.1f}), matte(glm::vec3(1.0f)), matte(glm::vec3(0.4f))};
    scene.materials[1].base_color_texture.image = 0;
    scene.materials[2].metallic = 1.0f;
    scene.materials[2].roughness = 0.3f;
    const Index moving = add_mesh(scene, {square(0.5f, -1.5f, 0)});
    add_mesh(scene, {square(1.5f, -3.0f, 1), square(4.0f, -6.0f, 2)});
    add_sun(scene, 3.0f, 0.4);
    Channel path;
    path.node = moving;
    path.path = ChannelPath::kTranslation;
    path.times = {-1.0f, 1.0f};
    path.values = {-24.0f, 3.0f, 0.0f, 24.0f, -3.0f, 0.0f};
    scene.animations.push_back({"move", {path}, 1.0});
    RenderSettings settings = settings_of(8);
    settings.image.filter = Filter::kBlackmanHarris;
    settings.camera.lens_radius = 0.1;
    settings.camera.focus_distance = 3.0;
    settings.shutter.motion_segments = 2;
    ShadingOptions options;
    options.environment = std::make_shared<const Environment>(Environment::sky());
    for (const ShadingRate rate : {ShadingRate::kPixel, ShadingRate::kDecoupled, ShadingRate::kSample}) {
        options.rate = rate;
        const std::vector<float> reference = draw(scene, settings, 32, options);
        for (const int size : {8, 16}) {
            const std::vector<float> other = draw(scene, settings, size, options);
            EXPECT_EQ(std::memcmp(reference.data(), other.data(), reference.size() * sizeof(float)), 0)
                << size << ' ' << static_cast<int>(rate);
        }
    }
}

// Motion and lens blur a stripe pattern; the few evaluations of cells must show what an evaluation for each sample
// shows.
TEST(Shade, CellsShowWhatSamplesShowWithFewerEvaluations) {
    Scene scene = scene_with_camera();
    Image stripes{"stripes", 16, 16, {}};
    for (int i = 0; i < 256; ++i) {
        const std::uint8_t code = i % 16 < 8 ? 255 : 30;
        stripes.texels.insert(stripes.texels.end(), {code, code, code, 255});
    }
    scene.images.push_back(stripes);
    scene.materials = {matte(glm::vec3(1.0f))};
    scene.materials[0].base_color_texture.image = 0;
    const Index moving = add_mesh(scene, {square(3.0f, -2.0f, 0)});
    add_sun(scene, 3.0f, 0.4);
    Channel path;
    path.node = moving;
    path.path = ChannelPath::kTranslation;
    path.times = {-1.0f, 1.0f};
    path.values = {-36.0f, 0.0f, 0.0f, 36.0f, 0.0f, 0.0f};
    scene.animations.push_back({"move", {path}, 1.0});
    RenderSettings settings = settings_of(64);
    settings.camera.lens_radius = 0.1;
    settings.camera.focus_distance = 4.0;
    ShadingOptions options;
    options.rate = ShadingRate::kSample;
    options.texture_filter = TextureFilter::kPixel;
    const std::vector<float> samples = draw(scene, settings, 32, options);
    options.rate = ShadingRate::kDecoupled;
    options.texture_filter = TextureFilter::kFull;
    const std::vector<float> cells = draw(scene, settings, 32, options);
    double worst = 0.0, sum = 0.0;
    for (std::size_t i = 0; i < cells.size(); i += 4) {
        const double difference = std::abs(cells[i] - samples[i]);
        worst = std::max(worst, difference);
        sum += difference / (kSize * kSize);
    }
    EXPECT_LT(worst, 0.1);
    EXPECT_LT(sum, 0.02);

    const Frame frame = frame_of(scene, settings);
    const SampleTable table(settings.image.spp, 0, frame.view.lens, Grouping::kBoth);
    const Tile tile{0, 0, 32, 32};
    Hits hits;
    find_hits(frame, table, tile, hits);
    TileShade shade;
    // Cells of 2 x 1 pixels (the motion is 12 pixels) over what passes the tile's 32 x 32: (32 + 12 + 2) / 2 * (32 +
    // 2).
    EXPECT_LT(TileShader().shade(ShadingScene(frame, options), table, tile, hits, shade), 783);
}

// Glass in front of a white wall: what passes and what is thrown back add up.
TEST(Shade, GlassShowsWhatIsBehindAndStillShines) {
    Scene scene = scene_with_camera();
    scene.materials = {matte(glm::vec3(0.0f)), matte(glm::vec3(1.0f))};
    scene.materials[0].transmission = 1.0f;
    scene.materials[1].unlit = true;
    add_mesh(scene, {square(3.0f, -2.0f, 0), square(9.0f, -4.0f, 1)});
    add_sun(scene, 1.0f);
    const std::vector<float> picture = draw(scene, settings_of(64));
    double mean = 0.0, least = 1.0;
    for (int y = 8; y < 20; ++y)
        for (int x = 8; x < 20; ++x) {
            mean += pixel(picture, x, y).x / 144.0;
            least = std::min<double>(least, pixel(picture, x, y).x);
        }
    EXPECT_NEAR(mean, 0.875, 0.04);
    EXPECT_GT(least, 0.8);
}

TEST(Shade, ANormalMapTurnsTheSurface) {
    for (const int code : {128 - 90, 128, 128 + 90}) {
        Scene scene = scene_with_camera();
        scene.images.push_back({"normal", 1, 1, {static_cast<std::uint8_t>(code), 128, 218, 255}});
        scene.materials = {matte(glm::vec3(1.0f))};
        scene.materials[0].normal_texture.image = 0;
        add_mesh(scene, {square(3.0f, -2.0f, 0)});
        add_sun(scene, std::numbers::pi_v<float>, 0.6);  // from the right
        const float turn = std::atan2(static_cast<float>(code - 128) / 127.5f, 90.0f / 127.5f);
        EXPECT_NEAR(pixel(draw(scene, settings_of(4)), 32, 32).x, std::max(0.0f, std::cos(0.6f - turn)), 0.06f) << code;
    }
}

PosedLight light_at(LightKind kind) {
    PosedLight light;
    light.kind = kind;
    light.position = {0.0f, 0.0f, 0.0f};
    light.direction = {0.0f, 0.0f, -1.0f};
    light.intensity = glm::vec3(8.0f);
    light.range = std::numeric_limits<float>::infinity();
    light.cone_scale = 1.0f / (std::cos(0.2f) - std::cos(0.5f));
    light.cone_offset = -std::cos(0.5f) * light.cone_scale;
    return light;
}

TEST(Lights, PointLightsFallWithTheSquareOfTheDistanceAndEndAtTheirRange) {
    PosedLight light = light_at(LightKind::kPoint);
    EXPECT_FLOAT_EQ(incoming(light, {0.0f, 2.0f, 0.0f}).irradiance.x, 2.0f);
    EXPECT_FLOAT_EQ(incoming(light, {0.0f, 4.0f, 0.0f}).irradiance.x, 0.5f);
    EXPECT_FLOAT_EQ(incoming(light, {0.0f, 4.0f, 0.0f}).to_light.y, -1.0f);
    light.range = 4.0f;
    EXPECT_FLOAT_EQ(incoming(light, {0.0f, 2.0f, 0.0f}).irradiance.x, 2.0f * (1.0f - 1.0f / 16.0f));
    EXPECT_EQ(incoming(light, {0.0f, 4.5f, 0.0f}).irradiance.x, 0.0f);
}

TEST(Lights, ASpotIsWholeInsideItsInnerConeAndDarkOutsideTheOuter) {
    const PosedLight light = light_at(LightKind::kSpot);
    const auto at = [&](float angle) {
        return incoming(light, glm::vec3(std::sin(angle), 0.0f, -std::cos(angle))).irradiance.x;
    };
    EXPECT_FLOAT_EQ(at(0.1f), 8.0f);
    EXPECT_EQ(at(0.55f), 0.0f);
    EXPECT_GT(at(0.3f), at(0.4f));
    EXPECT_GT(at(0.4f), 0.0f);
}

}  // namespace
}  // namespace pentaprism
