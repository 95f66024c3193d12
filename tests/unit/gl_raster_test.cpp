// The OpenGL backend sees what the processor sees: every sample of whole frames, triangle and depth bit for bit, and
// the same counts.

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <epoxy/egl.h>
#include <filesystem>
#include <fstream>
#include <optional>
#include <pentaprism/render.h>

#include "frame/opacity.h"
#include "gl/culling.h"
#include "support/gl_look.h"
#include "support/random.h"
#include "support/scenes.h"

namespace pentaprism {
namespace {

using namespace support;

TEST_F(GlBackend, SeesTheSameTrianglesAtTheSameDepthsInBuiltinScenes) {
    for (const char* name : {"builtin:cubes", "builtin:hand", "builtin:fairy-forest"}) {
        RenderSettings settings = settings_of();
        settings.camera.fstop = 2.8;
        expect_same(load_scene(name), settings, 24, "none");
    }
}

TEST_F(GlBackend, CountsAsTheProcessorWithEachCullingTest) {
    const Scene scene = load_scene("builtin:hand");
    RenderSettings settings = settings_of(64, 48, 4);
    settings.camera.fstop = 2.8;
    std::vector<std::string> choices = gl::culling_names();
    choices.emplace_back("improved-dual-space@tile+hyperplane@pixel");
    choices.emplace_back("hull+dual-space");
    choices.emplace_back("hull@tile");
    for (const std::string& culling : choices) expect_same(scene, settings, 24, culling);
}

TEST_F(GlBackend, CountsAsTheProcessorInHulls) {
    for (const char* name : {"builtin:cubes", "builtin:hand"}) {
        const Scene scene = load_scene(name);
        RenderSettings settings = settings_of(64, 48, 4);
        expect_same(scene, settings, 24, "hull");  // motion alone
        settings.camera.fstop = 2.8;
        expect_same(scene, settings, 24, "hull");
        settings.image.width = 61;  // the middle of the picture is that of a pixel
        settings.shutter.motion_blur = false;
        expect_same(scene, settings, 24, "hull");
    }
}

TEST_F(GlBackend, SeesTheSameInFilesOfOthers) {
    const char* folder = std::getenv("PENTAPRISM_SCENES");
    if (folder == nullptr) GTEST_SKIP() << "PENTAPRISM_SCENES is not set";
    // Cut-out leaves; the camera in the midst of things; blended surfaces; skins; no perspective.
    for (const char* file :
         {"forest/forest.glb", "race/race.glb", "insects/insects.glb", "hand/hand.glb", "environment/apartment.glb",
          "khronos/Fox/Fox.glb", "khronos/AlphaBlendModeTest/AlphaBlendModeTest.glb"}) {
        RenderSettings settings = settings_of();
        settings.camera.fstop = 2.8;
        settings.method.seed = 7;  // thresholds of opacity depend on it
        expect_same(load_scene(std::string(folder) + "/" + file), settings, 12, "none");
    }
}

// Of powers of two, odd and even ones, and of another number.
TEST_F(GlBackend, HasTheSameThresholdsOfBlendedSurfacesThatMove) {
    Scene scene;
    support::add_camera(scene, "camera", {0, 0, 3});
    Animation& animation = scene.animations.emplace_back();
    animation.duration = 1.0;
    for (int i = 0; i < 5; ++i) {
        const Index node = support::add_square(scene, "pane", {0.1 * i - 0.3, 0.05 * i, -0.2 * i}, 0.8f);
        scene.meshes[scene.nodes[node].mesh].primitives[0].material = static_cast<Index>(scene.materials.size());
        Material& material = scene.materials.emplace_back();
        material.double_sided = true;
        material.alpha_mode = AlphaMode::kBlend;
        material.base_color.w = 0.2f + 0.15f * static_cast<float>(i);
        Channel channel;
        channel.node = node;
        channel.path = ChannelPath::kTranslation;
        channel.times = {0.0f, 1.0f};
        for (const float side : {-3.0f, 3.0f})
            for (const float x : {side * static_cast<float>(i - 2), 0.5f * side, -0.2f * static_cast<float>(i)})
                channel.values.push_back(x);
        animation.channels.push_back(channel);
    }
    for (const int spp : {1, 2, 6, 8, 16, 32}) {
        RenderSettings settings = settings_of(64, 48, spp);
        settings.method.seed = 3;
        expect_same(scene, settings, 12, "none");
        settings.camera.fstop = 2.8;
        expect_same(scene, settings, 12, "none");
        const OpacityPattern pattern(pose_picture(scene, settings, 12).samples);
        EXPECT_EQ(pattern.over_time, spp != 6);
    }
}

// Panes behind one another of all that glass can be: whole, textured by its own coordinates and transform, with holes,
// blended; and a wall.
Scene glass_panes() {
    Scene scene;
    scene.name = "glass";
    support::add_camera(scene, "camera", {0, 0, 3});
    Random r(5);
    Image image;
    image.width = 5, image.height = 3;
    for (int i = 0; i < 4 * 15; ++i) image.texels.push_back(static_cast<std::uint8_t>(r.below(256)));
    scene.images.push_back(image);
    for (int i = 0; i < 7; ++i) {
        const Index node = support::add_square(scene, "pane", {0.1 * i - 0.3, 0.05 * i, -0.2 * i}, 0.8f);
        Primitive& primitive = scene.meshes[scene.nodes[node].mesh].primitives[0];
        primitive.texcoords[0] = {{0.1f, 0.2f}, {1.9f, 0.1f}, {2.1f, 1.3f}, {-0.4f, 1.2f}};
        primitive.texcoords[1] = {{0.0f, 0.0f}, {1.0f, 0.0f}, {1.0f, 1.0f}, {0.0f, 1.0f}};
        primitive.material = static_cast<Index>(scene.materials.size());
        Material& material = scene.materials.emplace_back();
        material.double_sided = true;
        material.transmission = i < 6 ? 1.0f - 0.1f * static_cast<float>(i) : 0.0f;
        if (i % 2 == 1) material.transmission_texture.image = 0;
        if (i == 3) material.transmission_texture.texcoord = 1, material.transmission_texture.rotation = 0.5f;
        if (i == 5) material.transmission_texture.nearest = true;
        if (i == 2 || i == 3) material.alpha_mode = AlphaMode::kMask;
        if (i == 4 || i == 5) material.alpha_mode = AlphaMode::kBlend;
        if (i >= 2 && i < 6) material.base_color_texture.image = 0;
        if (i == 4) primitive.colors.assign(4, {1.0f, 1.0f, 1.0f, 0.7f});
    }
    return scene;
}

TEST_F(GlBackend, SeesTheSameThroughGlass) {
    const Scene scene = glass_panes();
    RenderSettings settings = settings_of(96, 72, 10);
    settings.camera.fstop = 2.8;
    expect_same(scene, settings, 0, "none");
    // All panes are seen, each by a part of the samples.
    const PosedPicture picture = pose_picture(scene, settings, 0);
    const Seen gl = look(picture, By::kCompute, "none");
    for (std::uint32_t pane = 0; pane < 7; ++pane)
        EXPECT_GT(std::count_if(gl.triangle.begin(), gl.triangle.end(), [&](auto t) { return t / 2 == pane; }), 100)
            << pane;
}

struct Differences {
    std::int64_t scenes = 0, unreadable = 0, samples = 0, seen = 0, triangles = 0, depths = 0;
};

void compare_scene(const Scene& scene, const RenderSettings& settings, Differences& found) {
    const PosedPicture picture = pose_picture(scene, settings, 12);
    const Seen cpu = look(picture, By::kCpu, "none");
    ++found.scenes;
    for (const By by : {By::kGeometry, By::kCompute}) {
        const Seen gl = look(picture, by, "none");
        const std::int64_t triangles = differing(cpu.triangle, gl.triangle);
        EXPECT_EQ(triangles, 0) << scene.name;
        found.samples += static_cast<std::int64_t>(cpu.triangle.size());
        found.seen += std::count_if(cpu.triangle.begin(), cpu.triangle.end(), [](auto t) { return t != kNoTriangle; });
        found.triangles += triangles;
        found.depths += differing(cpu.depth, gl.depth);
    }
}

// Ties at edges and between depths are decided alike, so nothing may differ; what does is counted by the million.
TEST_F(GlBackend, SeesTheSameInEverySharedScene) {
    const char* folder = std::getenv("PENTAPRISM_SCENES");
    if (folder == nullptr) GTEST_SKIP() << "PENTAPRISM_SCENES is not set";
    RenderSettings settings = settings_of(64, 32, 3);
    settings.camera.fstop = 2.8;
    Differences found;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
        const std::string file = entry.path().string(), kind = entry.path().extension().string();
        if (kind != ".glb" && kind != ".gltf" && kind != ".obj") continue;
        const bool of_many = file.find("/malformed/") != file.npos || file.find("/parts/") != file.npos ||
                             file.find("/khronos-generator/") != file.npos;
        if (of_many && support::effort() == 1) continue;
        std::optional<Scene> scene;
        try {
            scene = load_scene(file);
        } catch (const Error&) {  // some are damaged on purpose
            ++found.unreadable;
        }
        if (scene) compare_scene(*scene, settings, found);
    }
    const double per_million = 1e6 / static_cast<double>(std::max<std::int64_t>(1, found.samples));
    std::printf(
        "%lld scenes (%lld more unreadable), %lld samples, of which %lld see something: "
        "%.3f per million differ in triangle, %.3f in depth\n",
        static_cast<long long>(found.scenes), static_cast<long long>(found.unreadable),
        static_cast<long long>(found.samples), static_cast<long long>(found.seen),
        static_cast<double>(found.triangles) * per_million, static_cast<double>(found.depths) * per_million);
    EXPECT_GT(found.scenes, 0);
    EXPECT_GT(found.seen, found.samples / 20);
    EXPECT_EQ(found.triangles, 0);
    EXPECT_EQ(found.depths, 0);
}

TEST_F(GlBackend, TakesPatternsRollingShuttersCropsAndSmallTilesAsTheProcessorDoes) {
    const Scene scene = load_scene("builtin:cubes");
    RenderSettings settings = settings_of();
    settings.shutter.rolling = RollingShutter::kTop;
    expect_same(scene, settings, 24, "none");
    settings.shutter.rolling = RollingShutter::kNone;
    settings.method.visibility = VisibilityMethod::kAccumulation;
    expect_same(scene, settings, 24, "none");

    settings = settings_of();
    settings.image.crop = {{33, 70, 5, 66}};
    RenderStats stats;
    const Picture cpu = render_picture(scene, settings, 24, stats);
    for (const int tile_size : {8, 32}) {
        settings.method.backend = Backend::kGl;
        settings.method.tile_size = tile_size;
        const Picture gl = render_picture(scene, settings, 24, stats);
        EXPECT_EQ(cpu.rgba, gl.rgba);
        EXPECT_EQ(cpu.z, gl.z);
    }
}

TEST_F(GlBackend, TakesOddSizesAndMorePassesThanOne) {
    RenderSettings settings = settings_of(61, 45, 19);
    settings.camera.fstop = 2.8;
    expect_same(load_scene("builtin:hand"), settings, 24, "improved-dual-space");
}

// Squares that start in front of the lens and end behind it, some with their corners on both sides all the time.
TEST_F(GlBackend, SeesTrianglesAtTheCameraPlaneAlike) {
    Scene scene;
    scene.name = "through the lens";
    support::add_camera(scene, "camera", {0, 0, 0});
    for (int i = 0; i < 6; ++i) {
        const float x = 0.3f * static_cast<float>(i - 3), end = 0.5f * static_cast<float>(i);
        const Index square = support::add_square(scene, "square", {x, 0, -0.6f}, 0.5f);
        support::animate(scene, square, ChannelPath::kTranslation, {0, 1}, {x, -0.2f, -0.6f, -x, 0.3f, end});
        if (i % 2 == 0)  // turned by 80 degrees about y: it reaches through the plane
            support::animate(scene, square, ChannelPath::kRotation, {0, 1},
                             {0, 0.643f, 0, 0.766f, 0, 0.643f, 0, 0.766f});
    }
    RenderSettings settings = settings_of(64, 48, 5);
    settings.camera.fstop = 1.4;
    settings.shutter.shutter = 4.0;
    for (const char* culling : {"none", "improved-dual-space", "hull", "hyperplane"})
        for (const double frame : {4.0, 8.0, 12.0}) expect_same(scene, settings, frame, culling);
}

TEST_F(GlBackend, SeesOrthographicPicturesAlike) {
    Scene scene;
    scene.name = "flat";
    Camera camera;
    camera.perspective = false;
    support::add_camera(scene, "camera", {0, 0, 3}, camera);
    const Index near = support::add_square(scene, "near", {-0.2, 0, 0.5}, 0.4f);
    support::add_square(scene, "far", {0.2, 0.1, -0.5}, 0.6f);
    support::animate(scene, near, ChannelPath::kTranslation, {0, 1}, {-0.2f, 0, 0.5f, 4, 0, -3});
    expect_same(scene, settings_of(), 0, "improved-dual-space");
}

TEST_F(GlBackend, RefusesByNameWhatItCannotDo) {
    const Scene scene = load_scene("builtin:cubes");
    const PosedPicture picture = pose_picture(scene, settings_of(32, 32, 1), 0);
    const auto refusal = [&](const std::string& culling) {
        try {
            look(picture, By::kCompute, culling);
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::kUsage);
            return std::string(error.what());
        }
        return std::string();
    };
    EXPECT_NE(refusal("half-space").find("--culling half-space: not with --backend gl"), std::string::npos);
    EXPECT_NE(refusal("dual-space@bucket").find("--culling dual-space@bucket: not with"), std::string::npos);

    RenderSettings settings = settings_of(32, 32, 1);
    settings.method.backend = Backend::kGl;
    settings.method.visibility = VisibilityMethod::kMicropolygon;
    EXPECT_THROW(validate(settings), Error);
}

TEST_F(GlBackend, ShaderThatDoesNotCompileIsOneLine) {
    const gl::Device::Current current(gl::Device::get());
    const gl::ShaderSource bad[] = {{"bad", "#include \"base/number.glsl\"\nvoid main() { int x = 1.5f\n + y; }\n"}};
    try {
        gl::Program({{GL_COMPUTE_SHADER, "bad"}}, {}, bad);
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::kBackend);
        const std::string said = error.what();
        EXPECT_EQ(said.find('\n'), std::string::npos);
        EXPECT_NE(said.find("shader bad"), std::string::npos) << said;
    }
    gl::check("compiling");
}

// In a process of its own, whose display is taken away.
TEST_F(GlBackend, ContextThatIsLostIsOneLine) {
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    const auto lose_it = [] {
        const Scene scene = load_scene("builtin:cubes");
        const PosedPicture picture = pose_picture(scene, settings_of(32, 32, 1), 0);
        look(picture, By::kCompute, "none");
        {
            const gl::Device::Current current(gl::Device::get());
            eglTerminate(eglGetCurrentDisplay());
        }
        try {
            look(picture, By::kCompute, "none");
        } catch (const Error& error) {
            std::fprintf(stderr, "<%s>\n", error.what());
            std::_Exit(static_cast<int>(error.kind()));
        }
        std::_Exit(0);
    };
    EXPECT_EXIT(lose_it(), testing::ExitedWithCode(5), "^<--backend gl: [^\n]*context[^\n]*>\n$");
}

std::int64_t resident_kilobytes() {
    std::ifstream status("/proc/self/status");
    for (std::string word; status >> word;) {
        std::int64_t value = 0;
        if (word == "VmRSS:" && status >> value) return value;
    }
    return 0;
}

TEST_F(GlBackend, LeavesNoErrorAndNoMemoryBehindAfterAHundredFrames) {
    const Scene scene = load_scene("builtin:cubes");
    const PosedPicture picture = pose_picture(scene, settings_of(64, 64, 2), 24);
    std::int64_t after_warm_up = 0;
    for (int frame = 0; frame < 100; ++frame) {
        look(picture, frame % 2 == 0 ? By::kCompute : By::kGeometry, "none");
        if (frame == 19) after_warm_up = resident_kilobytes();
    }
    const gl::Device::Current current(gl::Device::get());
    EXPECT_NO_THROW(gl::check("rendering a hundred frames"));
#ifndef __SANITIZE_ADDRESS__  // which keeps what is freed for a while, and finds leaks itself
    // A frame holds 1.5 MB on the device: eighty that stay would be 120 MB.
    EXPECT_LT(resident_kilobytes() - after_warm_up, 8 * 1024);
#endif
}

}  // namespace
}  // namespace pentaprism
