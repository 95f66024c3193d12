// Range checks of settings, the settings as JSON, and the hash of a scene.

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <gtest/gtest.h>
#include <limits>
#include <nlohmann/json.hpp>
#include <pentaprism/error.h>
#include <pentaprism/metadata.h>
#include <pentaprism/settings.h>
#include <unistd.h>

namespace pentaprism {
namespace {

namespace fs = std::filesystem;

std::string refusal(const std::function<void(RenderSettings&)>& change) {
    RenderSettings settings;
    change(settings);
    try {
        validate(settings);
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::kUsage);
        return error.what();
    }
    return "";
}

TEST(Settings, DefaultsAreValid) {
    EXPECT_NO_THROW(validate(RenderSettings{}));
}

TEST(Settings, EndsOfEachRangeAreTakenAndWhatIsBeyondIsNot) {
    using S = RenderSettings;
    EXPECT_EQ(refusal([](S& s) { s.image.width = s.image.height = 16384; }), "");
    EXPECT_NE(refusal([](S& s) { s.image.width = 16385; }), "");
    EXPECT_NE(refusal([](S& s) { s.image.height = 0; }), "");
    EXPECT_EQ(refusal([](S& s) { s.image.spp = 4096; }), "");
    EXPECT_NE(refusal([](S& s) { s.image.spp = 4097; }), "");
    EXPECT_NE(refusal([](S& s) { s.image.spp = 0; }), "");
    EXPECT_EQ(refusal([](S& s) { s.image.crop = {1279, 1280, 719, 720}; }), "");
    EXPECT_NE(refusal([](S& s) { s.image.crop = {0, 1281, 0, 720}; }), "");
    EXPECT_NE(refusal([](S& s) { s.image.crop = {5, 5, 0, 720}; }), "");
    EXPECT_NE(refusal([](S& s) { s.image.crop = {-1, 5, 0, 720}; }), "");
    EXPECT_EQ(refusal([](S& s) { s.shutter.shutter = 0.0; }), "");
    EXPECT_NE(refusal([](S& s) { s.shutter.shutter = -0.1; }), "");
    EXPECT_NE(refusal([](S& s) { s.camera.fstop = 0.0; }), "");
    EXPECT_EQ(refusal([](S& s) { s.camera.lens_radius = 0.0; }), "");
    EXPECT_EQ(refusal([](S& s) { s.camera.aperture_blades = 0; }), "");
    EXPECT_EQ(refusal([](S& s) { s.camera.aperture_blades = 3; }), "");
    EXPECT_NE(refusal([](S& s) { s.camera.aperture_blades = 2; }), "");
    EXPECT_NE(refusal([](S& s) { s.animation.fps = 0.0; }), "");
    EXPECT_NE(refusal([](S& s) { s.method.tile_size = 24; }), "");
}

TEST(Settings, NothingThatIsNotFiniteIsTaken) {
    using S = RenderSettings;
    for (const double bad : {std::nan(""), static_cast<double>(std::numeric_limits<float>::infinity())}) {
        EXPECT_NE(refusal([=](S& s) { s.image.exposure = bad; }), "");
        EXPECT_NE(refusal([=](S& s) { s.image.background = {0.0f, static_cast<float>(bad), 0.0f}; }), "");
        EXPECT_NE(refusal([=](S& s) { s.camera.focal_length_mm = bad; }), "");
        EXPECT_NE(refusal([=](S& s) { s.camera.sensor_width_mm = bad; }), "");
        EXPECT_NE(refusal([=](S& s) { s.camera.fstop = bad; }), "");
        EXPECT_NE(refusal([=](S& s) { s.camera.lens_radius = bad; }), "");
        EXPECT_NE(refusal([=](S& s) { s.camera.focus_distance = bad; }), "");
        EXPECT_NE(refusal([=](S& s) { s.camera.focus_pixel = {0.0, bad}; }), "");
        EXPECT_NE(refusal([=](S& s) { s.camera.aperture_rotation_deg = bad; }), "");
        EXPECT_NE(refusal([=](S& s) { s.camera.aperture_ratio = bad; }), "");
        EXPECT_NE(refusal([=](S& s) { s.shutter.shutter = bad; }), "");
        EXPECT_NE(refusal([=](S& s) { s.animation.fps = bad; }), "");
    }
}

TEST(Settings, MessageNamesTheOptionAndTheValue) {
    EXPECT_EQ(refusal([](RenderSettings& s) { s.camera.fstop = -2.0; }), "--fstop: -2 is not above 0");
}

TEST(Settings, JsonHoldsWhatDecidesPixelsAndNothingElse) {
    RenderSettings settings;
    settings.method.seed = 7;
    settings.camera.fstop = 2.8;
    const std::string text = settings_json(settings, "a.glb", "abc");
    const auto json = nlohmann::json::parse(text);
    EXPECT_EQ(json["seed"], 7);
    EXPECT_EQ(json["fstop"], 2.8);
    EXPECT_EQ(json["scene"], "a.glb");
    EXPECT_EQ(json["scene_hash"], "abc");
    EXPECT_FALSE(json.contains("focus_distance")) << "what was not given is left out";

    settings.method.culling = "hull+clip-space-as-printed";
    EXPECT_NE(settings_json(settings, "a.glb", "abc"), text) << "it loses samples";
    settings.method.culling = "auto";
    settings.method.shading = "pixel";
    const std::string on_cpu = settings_json(settings, "a.glb", "abc");
    settings.method.backend = Backend::kGl;
    EXPECT_NE(settings_json(settings, "a.glb", "abc"), on_cpu) << "it shades, and rounds otherwise";
    settings.method.shading = "decoupled";
    EXPECT_EQ(settings_json(settings, "a.glb", "abc"), text);
    settings.method.backend = Backend::kCpu;

    settings.method.threads = 3;
    settings.method.tile_size = 8;
    settings.method.culling = "none";
    EXPECT_EQ(settings_json(settings, "a.glb", "abc"), text);
    settings.image.exposure = 1.0;
    EXPECT_NE(settings_json(settings, "a.glb", "abc"), text);
}

TEST(SceneHash, IsThatOfTheBytesAndOfWhatTheFileRefersTo) {
    std::string pattern = (fs::temp_directory_path() / "pentaprism-hash-XXXXXX").string();
    ASSERT_NE(mkdtemp(pattern.data()), nullptr);
    const fs::path folder = pattern;
    const auto put = [&](const char* name, const char* text) { std::ofstream(folder / name) << text; };
    const auto hash = [&](const char* name) { return scene_hash((folder / name).string()); };

    put("a.glb", "hello");
    EXPECT_EQ(hash("a.glb"), "b5e9c1ad071b3e7fc779cfaa5e523818") << "what xxh128sum prints for these five bytes";
    EXPECT_EQ(hash("missing.glb"), "99aa06d3014798d86001c324468d497f") << "what xxh128sum prints for no bytes";

    put("a.gltf",
        R"({"buffers":[{"uri":"my%20data.bin"},{"uri":"data:,x"}],"images":[{"uri":"i.png"},{"bufferView":0}]})");
    put("my data.bin", "one");
    const std::string before = hash("a.gltf");
    put("my data.bin", "two");
    EXPECT_NE(hash("a.gltf"), before);

    put("a.obj", "mtllib m.mtl\nv 0 0 0\n");
    const std::string without = hash("a.obj");
    put("m.mtl", "newmtl red");
    EXPECT_NE(hash("a.obj"), without);

    // As the reader takes them: a suffix of any case, a name with spaces.
    for (const char* name : {"B.GLTF", "B.OBJ"}) {
        put(name,
            std::string(name) == "B.OBJ" ? "mtllib my library.mtl\n" : R"({"buffers":[{"uri":"my library.mtl"}]})");
        put("my library.mtl", "newmtl red");
        const std::string red = hash(name);
        put("my library.mtl", "newmtl blue");
        EXPECT_NE(hash(name), red) << name;
    }
    EXPECT_NE(scene_hash("builtin:cubes"), scene_hash("builtin:hand"));
    fs::remove_all(folder);
}

}  // namespace
}  // namespace pentaprism
