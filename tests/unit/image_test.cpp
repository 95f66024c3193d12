// Picture files: what is written can be read, bands do not show, and no half-written file ever has a final name.

#include <ImfDoubleAttribute.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfRational.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <cmath>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <limits>
#include <pentaprism/error.h>
#include <pentaprism/image.h>
#include <random>
#include <unistd.h>

#include "image/tone_curve.h"

namespace pentaprism {
namespace {

namespace fs = std::filesystem;
constexpr float kInfinity = std::numeric_limits<float>::infinity();

class ImageFiles : public testing::Test {
  protected:
    void SetUp() override {
        std::string pattern = (fs::temp_directory_path() / "pentaprism-image-XXXXXX").string();
        ASSERT_NE(mkdtemp(pattern.data()), nullptr);
        folder_ = pattern;
    }
    void TearDown() override { fs::remove_all(folder_); }
    fs::path folder_;
};

FrameInfo whole(int width, int height) {
    FrameInfo info;
    info.width = info.x1 = width;
    info.height = info.y1 = height;
    info.world_to_camera = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    info.world_to_ndc = info.world_to_camera;
    return info;
}

struct Pixels {
    explicit Pixels(const FrameInfo& info) : width(info.x1 - info.x0), height(info.y1 - info.y0) {
        std::mt19937 random(1);
        std::uniform_real_distribution<float> color(0.0f, 1.5f);
        rgba.resize(4 * static_cast<std::size_t>(width * height));
        for (float& value : rgba) value = color(random);
        z.resize(static_cast<std::size_t>(width * height));
        for (std::size_t i = 0; i < z.size(); ++i)
            z[i] = i % 7 == 0 ? kInfinity : 3.0f + 0.125f * static_cast<float>(i);
    }
    PixelRows band(const FrameInfo& info, int first, int count) const {
        PixelRows rows;
        rows.y0 = info.y0 + first;
        rows.count = count;
        rows.width = width;
        const auto offset = static_cast<std::size_t>(first * width), size = static_cast<std::size_t>(count * width);
        rows.rgba = std::span(rgba).subspan(4 * offset, 4 * size);
        rows.z = std::span(z).subspan(offset, size);
        return rows;
    }
    int width, height;
    std::vector<float> rgba, z;
};

void write(const fs::path& file, const FrameInfo& info, const Pixels& pixels, int rows_at_once,
           const ImageSettings& image = {}, const FileMetadata& metadata = {}) {
    const auto writer = make_picture_writer(file, image, metadata);
    writer->begin(info);
    for (int y = 0; y < pixels.height; y += rows_at_once) {
        writer->rows(pixels.band(info, y, std::min(rows_at_once, pixels.height - y)));
    }
    writer->finish();
}

std::string bytes_of(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

std::size_t files_in(const fs::path& folder) {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

ErrorKind kind_of_failure(const std::function<void()>& body, std::string* message = nullptr) {
    try {
        body();
    } catch (const Error& error) {
        if (message) *message = error.what();
        return error.kind();
    }
    ADD_FAILURE() << "nothing was thrown";
    return ErrorKind::kRender;
}

TEST_F(ImageFiles, ExrGivesBackColoursAsHalvesAndDepthExactly) {
    const FrameInfo info = whole(37, 41);
    const Pixels pixels(info);
    write(folder_ / "a.exr", info, pixels, 8);
    const Picture picture = read_picture(folder_ / "a.exr");
    ASSERT_EQ(picture.width, 37);
    ASSERT_EQ(picture.height, 41);
    for (std::size_t i = 0; i < pixels.rgba.size(); ++i) ASSERT_NEAR(picture.rgba[i], pixels.rgba[i], 1.5f / 2048.0f);
    EXPECT_EQ(picture.z, pixels.z);
}

TEST_F(ImageFiles, PngGivesBackLinearColoursWithinHalfAStep) {
    const FrameInfo info = whole(16, 16);
    Pixels pixels(info);
    for (float& value : pixels.rgba) value = std::min(value, 1.0f);
    ImageSettings image;
    image.tonemap = ToneMap::kNone;
    write(folder_ / "a.png", info, pixels, 16, image);
    const Picture picture = read_picture(folder_ / "a.png");
    ASSERT_EQ(picture.rgba.size(), pixels.rgba.size());
    for (std::size_t i = 0; i < pixels.rgba.size(); ++i) {
        if (i % 4 == 3) {
            ASSERT_EQ(picture.rgba[i], 1.0f) << "a PNG is opaque";
        } else {
            ASSERT_NEAR(srgb_encode(picture.rgba[i]), srgb_encode(pixels.rgba[i]), 0.501 / 255.0);
        }
    }
}

TEST_F(ImageFiles, BandsAndThreadsDoNotShowInTheBytes) {
    const FrameInfo info = whole(61, 70);
    const Pixels pixels(info);
    for (const std::string suffix : {".exr", ".png"}) {
        write(folder_ / ("one" + suffix), info, pixels, 70);
        set_picture_threads(2);
        write(folder_ / ("bands" + suffix), info, pixels, 32);
        set_picture_threads(0);
        write(folder_ / ("rows" + suffix), info, pixels, 1);
        const std::string one = bytes_of(folder_ / ("one" + suffix));
        EXPECT_GT(one.size(), 1000u);
        EXPECT_EQ(one, bytes_of(folder_ / ("bands" + suffix))) << suffix;
        EXPECT_EQ(one, bytes_of(folder_ / ("rows" + suffix))) << suffix;
    }
}

TEST_F(ImageFiles, CropIsTheDataWindowInsideTheDisplayWindow) {
    FrameInfo info = whole(64, 48);
    info.x0 = 10, info.x1 = 30, info.y0 = 5, info.y1 = 45;
    const Pixels pixels(info);
    write(folder_ / "a.exr", info, pixels, 7);
    Imf::InputFile file((folder_ / "a.exr").c_str());
    EXPECT_EQ(file.header().displayWindow(), Imath::Box2i({0, 0}, {63, 47}));
    EXPECT_EQ(file.header().dataWindow(), Imath::Box2i({10, 5}, {29, 44}));
    const Picture picture = read_picture(folder_ / "a.exr");
    EXPECT_EQ(picture.width, 20);
    EXPECT_EQ(picture.height, 40);
    EXPECT_EQ(picture.info.width, 64);
    EXPECT_EQ(picture.info.x0, 10);
    EXPECT_EQ(picture.info.y1, 45);
    EXPECT_EQ(picture.z, pixels.z);

    write(folder_ / "a.png", info, pixels, 7);
    EXPECT_EQ(read_picture(folder_ / "a.png").width, 20);
}

TEST_F(ImageFiles, HeaderTellsOfLensShutterCameraAndSettings) {
    FrameInfo info = whole(20, 10);
    info.fps = 23.976;
    info.frame = 12;
    info.lens_radius = 0.0125;
    info.fstop = 2.0;
    info.focus_distance = 3.5;
    info.camera = "hero";
    // A camera at (1, 2, 3) that looks along -z: what lies at (1, 2, -7) is 10 metres in front of it.
    info.world_to_camera = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -1, -2, -3, 1};
    // A projection that puts x / -z and y / -z on the screen.
    info.world_to_ndc = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1, -1, -1, -2, 3, 3};
    FileMetadata metadata;
    metadata.settings_json = R"({"seed":7})";
    metadata.exposure_seconds = 1.0 / 48.0;
    metadata.software = "pentaprism 1.2.3";
    write(folder_ / "a.exr", info, Pixels(info), 10, {}, metadata);

    Imf::InputFile file((folder_ / "a.exr").c_str());
    const Imf::Header& header = file.header();
    EXPECT_FLOAT_EQ(Imf::focus(header), 3.5f);
    EXPECT_FLOAT_EQ(Imf::aperture(header), 2.0f);
    EXPECT_FLOAT_EQ(Imf::expTime(header), 1.0f / 48.0f);
    EXPECT_EQ(Imf::framesPerSecond(header).n, 24000);
    EXPECT_EQ(Imf::framesPerSecond(header).d, 1001u);
    EXPECT_FLOAT_EQ(Imf::chromaticities(header).white.x, 0.3127f);
    EXPECT_EQ(header.typedAttribute<Imf::StringAttribute>("pentaprism").value(), metadata.settings_json);
    EXPECT_EQ(header.typedAttribute<Imf::StringAttribute>("software").value(), metadata.software);
    EXPECT_EQ(header.typedAttribute<Imf::DoubleAttribute>("frame").value(), 12.0);
    EXPECT_FALSE(Imf::hasCapDate(header));

    Imath::V3f in_camera;
    Imf::worldToCamera(header).multVecMatrix(Imath::V3f(1, 2, -7), in_camera);
    EXPECT_EQ(in_camera, Imath::V3f(0, 0, 10)) << "OpenEXR's camera looks along +z";
    Imath::V3f in_ndc;
    Imf::worldToNDC(header).multVecMatrix(Imath::V3f(6, 2, -7), in_ndc);
    EXPECT_FLOAT_EQ(in_ndc.x, 0.75f) << "x / depth = 0.5 lies three quarters to the right";
    EXPECT_FLOAT_EQ(in_ndc.y, 0.5f);
    Imf::worldToNDC(header).multVecMatrix(Imath::V3f(1, 12, -7), in_ndc);
    EXPECT_FLOAT_EQ(in_ndc.y, 0.0f) << "the upper edge of the picture";
}

TEST_F(ImageFiles, PinholeHasNeitherFocusNorAperture) {
    FrameInfo info = whole(4, 4);
    info.shutter_open = 1.0;
    info.shutter_close = 1.25;
    write(folder_ / "a.exr", info, Pixels(info), 4);
    Imf::InputFile file((folder_ / "a.exr").c_str());
    EXPECT_FALSE(Imf::hasFocus(file.header()));
    EXPECT_FALSE(Imf::hasAperture(file.header()));
    EXPECT_FLOAT_EQ(Imf::expTime(file.header()), 0.25f);
}

TEST_F(ImageFiles, FiniteColoursStayFiniteAsHalves) {
    const FrameInfo info = whole(2, 1);
    Pixels pixels(info);
    pixels.rgba = {1e30f, -1e30f, 65519.0f, 1.0f, kInfinity, 0.0f, 1e-9f, 0.0f};
    write(folder_ / "a.exr", info, pixels, 1);
    const Picture picture = read_picture(folder_ / "a.exr");
    EXPECT_EQ(picture.rgba[0], 65504.0f);
    EXPECT_EQ(picture.rgba[1], -65504.0f);
    EXPECT_EQ(picture.rgba[2], 65504.0f);
    EXPECT_EQ(picture.rgba[4], kInfinity) << "what was infinite is not hidden";
}

TEST_F(ImageFiles, NameAppearsOnlyWhenTheFileIsWhole) {
    const FrameInfo info = whole(8, 8);
    const Pixels pixels(info);
    for (const char* name : {"a.exr", "a.png"}) {
        const fs::path file = folder_ / name, part = folder_ / (std::string(name) + ".part");
        const auto writer = make_picture_writer(file, {}, {});
        writer->begin(info);
        writer->rows(pixels.band(info, 0, 8));
        EXPECT_FALSE(fs::exists(file));
        EXPECT_TRUE(fs::exists(part));
        writer->finish();
        EXPECT_TRUE(fs::exists(file));
        EXPECT_FALSE(fs::exists(part));
    }
}

TEST_F(ImageFiles, UnfinishedWriterLeavesNothingAndKeepsTheOldFile) {
    const FrameInfo info = whole(8, 8);
    const Pixels pixels(info);
    for (const char* name : {"a.exr", "a.png"}) {
        write(folder_ / name, info, pixels, 8);
        const std::string before = bytes_of(folder_ / name);
        {
            const auto writer = make_picture_writer(folder_ / name, {}, {});
            writer->begin(info);
            writer->rows(pixels.band(info, 0, 4));
        }
        EXPECT_EQ(bytes_of(folder_ / name), before);
        fs::remove(folder_ / name);
    }
    EXPECT_EQ(files_in(folder_), 0u);
}

TEST_F(ImageFiles, FullDiskIsAnOutputErrorThatNamesTheFile) {
    if (!fs::exists("/dev/full")) GTEST_SKIP() << "this system has no /dev/full";
    // Large enough for libraries to flush while rows come, and so small that the first write is at the end.
    for (const int size : {400, 4}) {
        const FrameInfo info = whole(size, size);
        const Pixels pixels(info);
        for (const char* name : {"a.exr", "a.png"}) {
            fs::create_symlink("/dev/full", folder_ / (std::string(name) + ".part"));
            std::string message;
            EXPECT_EQ(kind_of_failure([&] { write(folder_ / name, info, pixels, 32); }, &message), ErrorKind::kOutput);
            EXPECT_EQ(message, (folder_ / name).string() + ": cannot write (No space left on device)");
        }
        EXPECT_EQ(files_in(folder_), 0u);
    }
}

TEST_F(ImageFiles, MissingFolderOrFolderAsNameIsAnOutputError) {
    std::string message;
    EXPECT_EQ(kind_of_failure([&] { make_picture_writer(folder_ / "no" / "a.exr", {}, {}); }, &message),
              ErrorKind::kOutput);
    EXPECT_NE(message.find("No such file or directory"), std::string::npos) << message;
    fs::create_directory(folder_ / "a.png");
    EXPECT_EQ(kind_of_failure([&] { make_picture_writer(folder_ / "a.png", {}, {}); }), ErrorKind::kOutput);
    EXPECT_EQ(kind_of_failure([&] { make_picture_writer(folder_ / "a.jpg", {}, {}); }), ErrorKind::kUsage);
}

TEST_F(ImageFiles, MissingOrRepeatedRowsAreRefused) {
    const FrameInfo info = whole(8, 8);
    const Pixels pixels(info);
    for (const char* name : {"a.exr", "a.png"}) {
        const auto writer = make_picture_writer(folder_ / name, {}, {});
        writer->begin(info);
        writer->rows(pixels.band(info, 0, 4));
        EXPECT_EQ(kind_of_failure([&] { writer->rows(pixels.band(info, 0, 4)); }), ErrorKind::kRender);
        EXPECT_EQ(kind_of_failure([&] { writer->finish(); }), ErrorKind::kRender);
        EXPECT_FALSE(fs::exists(folder_ / name));
    }
}

TEST_F(ImageFiles, BrokenFilesCannotBeRead) {
    std::ofstream(folder_ / "a.exr") << "this is no picture";
    std::ofstream(folder_ / "a.png") << "neither is this";
    for (const char* name : {"a.exr", "a.png", "missing.exr", "missing.png", "a.txt"}) {
        std::string message;
        EXPECT_EQ(kind_of_failure([&] { read_picture(folder_ / name); }, &message), ErrorKind::kScene);
        EXPECT_EQ(message.find((folder_ / name).string() + ": "), 0u) << message;
        EXPECT_EQ(message.find('\n'), std::string::npos);
    }
}

TEST_F(ImageFiles, CutOffFilesCannotBeRead) {
    const FrameInfo info = whole(64, 64);
    for (const char* name : {"a.exr", "a.png"}) {
        write(folder_ / name, info, Pixels(info), 64);
        fs::resize_file(folder_ / name, fs::file_size(folder_ / name) / 2);
        EXPECT_EQ(kind_of_failure([&] { read_picture(folder_ / name); }), ErrorKind::kScene) << name;
    }
}

TEST(ToneCurve, NoneClipsAndKeepsTheRest) {
    EXPECT_EQ(tone_map(ToneMap::kNone, 0.18f), 0.18f);
    EXPECT_EQ(tone_map(ToneMap::kNone, 4.0f), 1.0f);
    EXPECT_EQ(tone_map(ToneMap::kNone, -1.0f), 0.0f);
}

TEST(ToneCurve, AcesAndFilmicHavePublishedValues) {
    // By hand from the published formulas: 1 * (2.51 + 0.03) / (2.43 + 0.59 + 0.14) = 2.54 / 3.16.
    EXPECT_NEAR(tone_map(ToneMap::kAces, 1.0f), 2.54 / 3.16, 1e-6);
    EXPECT_NEAR(tone_map(ToneMap::kAces, 0.18f), 0.18 * 0.4818 / (0.18 * 1.0274 + 0.14), 1e-6);
    // f(2) / f(11.2) with f(x) = (x (0.15 x + 0.05) + 0.004) / (x (0.15 x + 0.5) + 0.06) - 1 / 15.
    const double f2 = (2 * 0.35 + 0.004) / (2 * 0.8 + 0.06) - 1.0 / 15.0;
    const double white = (11.2 * 1.73 + 0.004) / (11.2 * 2.18 + 0.06) - 1.0 / 15.0;
    EXPECT_NEAR(tone_map(ToneMap::kFilmic, 1.0f), f2 / white, 1e-6);
    EXPECT_NEAR(tone_map(ToneMap::kFilmic, 5.6f), 1.0f, 1e-6) << "white is at 11.2 after the bias of 2";
}

TEST(ToneCurve, EveryCurveRisesFromZeroToOneAndSurvivesAnything) {
    for (const ToneMap curve : {ToneMap::kNone, ToneMap::kAces, ToneMap::kFilmic}) {
        EXPECT_NEAR(tone_map(curve, 1e-30f), 0.0f, 1e-6f);
        EXPECT_EQ(tone_map(curve, kInfinity), 1.0f);
        EXPECT_EQ(tone_map(curve, std::numeric_limits<float>::max()), 1.0f);
        EXPECT_EQ(tone_map(curve, std::nanf("")), 0.0f);
        float before = 0.0f;
        for (float x = 0.0f; x < 20.0f; x += 0.01f) {
            const float now = tone_map(curve, x);
            ASSERT_GE(now, before - 1e-6f);
            before = now;
        }
    }
}

TEST(ToneCurve, EightBitsRoundTheSrgbCurve) {
    EXPECT_EQ(to_srgb8(0.0f), 0);
    EXPECT_EQ(to_srgb8(1.0f), 255);
    EXPECT_EQ(to_srgb8(0.5f), 188);
    for (int value = 0; value < 256; ++value) {
        EXPECT_EQ(to_srgb8(static_cast<float>(srgb_decode(value / 255.0))), value);
    }
    for (float x = 0.0f; x <= 1.0f; x += 0.00037f) {
        ASSERT_NEAR(to_srgb8(x), 255.0 * srgb_encode(x), 0.5 + 1e-4);
    }
    for (int value = 0; value < 255; ++value) {
        const auto step = static_cast<float>(srgb_decode((value + 0.5) / 255.0));
        EXPECT_EQ(to_srgb8(step), value + 1);
        EXPECT_EQ(to_srgb8(std::nextafter(step, 0.0f)), value);
    }
    EXPECT_EQ(to_srgb8(INFINITY), 255);
}

}  // namespace
}  // namespace pentaprism
