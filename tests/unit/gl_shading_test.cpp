// `--backend gl --shading pixel` shades on the device as the processor does: whole pictures, equal but for rounding.

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <pentaprism/image.h>
#include <pentaprism/render.h>

#include "shade/shadow_raster.h"
#include "support/gl_look.h"
#include "support/scenes.h"

namespace pentaprism {
namespace {

using namespace support;

RenderSettings pixel_settings(int width = 96, int height = 72, int spp = 6) {
    RenderSettings settings = settings_of(width, height, spp);
    settings.method.shading = "pixel";
    settings.camera.fstop = 2.8;
    return settings;
}

struct Likeness {
    double psnr = 0.0;       ///< of what a screen shows, white 1
    double differing = 0.0;  ///< share of numbers that are off by more than half a code of 8 bits
    std::int64_t cpu_shaded = 0, gl_shaded = 0;
};

Likeness compare_backends(const Scene& scene, RenderSettings settings, double frame, GlPipeline pipeline) {
    RenderStats stats;
    Likeness found;
    const Picture cpu = render_picture(scene, settings, frame, stats);
    found.cpu_shaded = stats.shaded;
    settings.method.backend = Backend::kGl;
    settings.method.gl_pipeline = pipeline;
    const Picture gl = render_picture(scene, settings, frame, stats);
    found.gl_shaded = stats.shaded;
    EXPECT_EQ(cpu.rgba.size(), gl.rgba.size());
    double sum = 0.0;
    for (std::size_t i = 0; i < cpu.rgba.size(); ++i) {
        const auto shown = [](float x) { return std::pow(std::clamp(x, 0.0f, 1.0f), 1.0f / 2.2f); };
        const double difference = shown(cpu.rgba[i]) - shown(gl.rgba[i]);
        sum += difference * difference;
        found.differing += std::abs(difference) > 0.5 / 255.0;
    }
    const double count = static_cast<double>(cpu.rgba.size());
    found.psnr = 10.0 * std::log10(1.0 / std::max(sum / count, 1e-12));
    found.differing /= count;
    return found;
}

void expect_alike(const Scene& scene, const RenderSettings& settings, double frame, const char* what,
                  GlPipeline pipeline = GlPipeline::kAuto) {
    const Likeness found = compare_backends(scene, settings, frame, pipeline);
    std::printf("%-34s %6.1f dB, %.4f%% off by more than half a code, %lld points\n", what, found.psnr,
                100.0 * found.differing, static_cast<long long>(found.gl_shaded));
    EXPECT_GT(found.psnr, 75.0) << what;
    EXPECT_LT(found.differing, 0.0005) << what;
    EXPECT_EQ(found.cpu_shaded, found.gl_shaded) << what;
    EXPECT_GT(found.gl_shaded, 0) << what;
}

TEST_F(GlBackend, ShadesBuiltinScenesAsTheProcessor) {
    for (const char* name : {"builtin:cubes", "builtin:hand", "builtin:car", "builtin:fairy-forest"})
        expect_alike(load_scene(name), pixel_settings(), 24, name);
}

TEST_F(GlBackend, ShadesAsTheProcessorWithEachOption) {
    const Scene scene = load_scene("builtin:car");
    const auto with = [&](const char* what, const auto& change) {
        RenderSettings settings = pixel_settings();
        change(settings);
        expect_alike(scene, settings, 24, what);
    };
    with("no shadows", [](RenderSettings& s) { s.method.shadows = ShadowMode::kOff; });
    with("still shadows", [](RenderSettings& s) { s.method.shadows = ShadowMode::kStill; });
    with("burley", [](RenderSettings& s) { s.method.brdf = BrdfModel::kBurley; });
    with("texture filter off", [](RenderSettings& s) { s.method.texture_filter = TextureFilter::kOff; });
    with("texture filter pixel", [](RenderSettings& s) { s.method.texture_filter = TextureFilter::kPixel; });
    with("sky", [](RenderSettings& s) { s.image.environment = "sky"; });
    with("focus range", [](RenderSettings& s) { s.camera.focus_range = {{3.0, 6.0}}; });
    with("motion alone", [](RenderSettings& s) { s.camera.fstop.reset(); });
    with("one instant", [](RenderSettings& s) { s.shutter.motion_blur = false; });
    with("crop, small tiles", [](RenderSettings& s) {
        s.image.crop = {{33, 90, 5, 66}};
        s.method.tile_size = 8;
    });
    with("300 samples", [](RenderSettings& s) {
        s.image.width = 33, s.image.height = 17;
        s.image.spp = 300;
    });
}

TEST_F(GlBackend, ShadesFilesOfOthersAsTheProcessor) {
    const char* folder = std::getenv("PENTAPRISM_SCENES");
    if (folder == nullptr) GTEST_SKIP() << "PENTAPRISM_SCENES is not set";
    for (const char* file :
         {"forest/forest.glb", "race/race.glb", "insects/insects.glb", "hand/hand.glb", "environment/apartment.glb",
          "khronos/Fox/Fox.glb", "khronos/AlphaBlendModeTest/AlphaBlendModeTest.glb"})
        expect_alike(load_scene(std::string(folder) + "/" + file), pixel_settings(), 12, file);
}

// Varnish, fibres, glass, textures with coordinates and transforms of their own, mirrored normals, lamps.
TEST_F(GlBackend, ShadesEachFeatureOfMaterialsAsTheProcessor) {
    const char* folder = std::getenv("PENTAPRISM_SCENES");
    if (folder == nullptr) GTEST_SKIP() << "PENTAPRISM_SCENES is not set";
    int skies = 0;
    for (const char* name :
         {"ClearCoatTest", "ToyCar", "MultiUVTest", "TextureTransformTest", "TextureSettingsTest",
          "NormalTangentMirrorTest", "LightsPunctualLamp", "UnlitTest", "VertexColorTest", "EmissiveStrengthTest"})
        for (const char* kind : {".glb", ".gltf"}) {
            const std::string file = std::string(folder) + "/khronos/" + name + "/" + name + kind;
            if (!std::filesystem::exists(file)) continue;
            RenderSettings settings = pixel_settings(64, 48, 4);
            settings.image.environment = skies++ < 2 ? "sky" : "";
            expect_alike(load_scene(file), settings, 12, name);
            break;
        }
    EXPECT_GE(skies, 10);
}

// Few cells of shadow maps fit: shares of light wait, then fewer of them ask at once.
TEST_F(GlBackend, ShadesTheSameWhereMemoryIsShort) {
    const Scene scene = load_scene("builtin:car");
    gl::Device::get().pretend_block_bytes(20 * 4 * ShadowSamples::kPerCell);
    expect_alike(scene, pixel_settings(48, 36, 4), 24, "20 cells");
    gl::Device::get().pretend_block_bytes(1024);
    RenderSettings settings = pixel_settings(48, 36, 4);
    settings.method.backend = Backend::kGl;
    RenderStats stats;
    try {
        render_picture(scene, settings, 24, stats);
        ADD_FAILURE() << "1024 bytes were enough";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::kBackend);
        const std::string said = error.what();
        EXPECT_EQ(said.find("--backend gl --shading pixel: "), 0u) << said;
        EXPECT_EQ(said.find('\n'), said.npos);
    }
    gl::Device::get().pretend_block_bytes(0);
}

// Glass shows what it reflects, and what is behind it, as on the processor.
TEST_F(GlBackend, ShadesThroughGlassAsTheProcessor) {
    const char* folder = std::getenv("PENTAPRISM_SCENES");
    if (folder == nullptr) GTEST_SKIP() << "PENTAPRISM_SCENES is not set";
    expect_alike(load_scene(std::string(folder) + "/khronos/ToyCar/ToyCar.gltf"), pixel_settings(64, 48, 16), 0,
                 "geometry pipeline", GlPipeline::kGeometry);
}

TEST_F(GlBackend, CountsAndColoursDoNotDependOnThreads) {
    const Scene scene = load_scene("builtin:hand");
    RenderSettings settings = pixel_settings(96, 72, 4);
    settings.method.backend = Backend::kGl;
    RenderStats stats;
    settings.method.threads = 1;
    const Picture one = render_picture(scene, settings, 24, stats);
    settings.method.threads = 4;
    settings.method.tile_size = 16;
    const Picture four = render_picture(scene, settings, 24, stats);
    EXPECT_EQ(one.rgba, four.rgba);
}

}  // namespace
}  // namespace pentaprism
