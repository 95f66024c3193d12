// Pictures of stored samples against what is known of them, and against direct renders.
#include <algorithm>
#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <pentaprism/error.h>
#include <pentaprism/stored_samples.h>

#include "unit/small_scene.h"

namespace pentaprism {
namespace {

using Bytes = std::vector<std::byte>;
constexpr int kSize = 64;

struct MemorySink : ByteSink {
    Bytes bytes;
    void write(std::span<const std::byte> more) override { bytes.insert(bytes.end(), more.begin(), more.end()); }
};

struct MemorySource : ByteSource {
    explicit MemorySource(const Bytes& all) : bytes(all) {}
    std::string name() const override { return "memory"; }
    bool at_end() override { return at == bytes.size(); }
    void read(std::span<std::byte> out) override {
        if (out.size() > bytes.size() - at) throw Error(ErrorKind::kScene, "too short");
        std::copy_n(bytes.begin() + at, out.size(), out.begin());
        at += out.size();
    }
    const Bytes& bytes;
    std::size_t at = 0;
};

struct Rows : RowSink {
    std::vector<float> rgba, z;
    FrameInfo info;
    void begin(const FrameInfo& of) override { info = of; }
    void rows(const PixelRows& band) override {
        rgba.insert(rgba.end(), band.rgba.begin(), band.rgba.end());
        z.insert(z.end(), band.z.begin(), band.z.end());
    }
    float red(int x, int y) const { return rgba[4 * (static_cast<std::size_t>(y) * kSize + x)]; }
};

// A small white square 2 metres away that moves right by 2 metres a second, before a large grey one at 8 metres whose
// right half is white. Nothing needs light.
Scene scene_of_two() {
    Scene scene = small_scene::scene_with_camera();
    scene.materials.resize(2);
    scene.materials[0].unlit = scene.materials[1].unlit = true;
    scene.materials[0].double_sided = scene.materials[1].double_sided = true;
    scene.materials[1].base_color = {0.25f, 0.25f, 0.25f, 1.0f};
    const Index mover = small_scene::add_mesh(scene, {small_scene::square(0.25f, 0.0f, 0)});
    Primitive half = small_scene::square(10.0f, -8.0f, 0);
    for (glm::vec3& p : half.positions) p.x = p.x > 0.0f ? p.x : 0.0f;
    small_scene::add_mesh(scene, {half});
    small_scene::add_mesh(scene, {small_scene::square(20.0f, -8.5f, 1)});
    Channel channel;
    channel.node = mover;
    channel.path = ChannelPath::kTranslation;
    channel.times = {0.0f, 1.0f};
    channel.values = {-1.0f, 1.0f, -2.0f, 1.0f, 1.0f, -2.0f};
    scene.animations.push_back({"move", {channel}, 1.0});
    return scene;
}

RenderSettings settings_focused_at(double distance, int spp = 16, std::uint32_t seed = 0) {
    RenderSettings settings;
    settings.image.width = settings.image.height = kSize;
    settings.image.spp = spp;
    settings.image.filter = Filter::kBox;
    settings.animation.fps = 10.0;
    settings.camera.lens_radius = 0.3;
    settings.camera.focus_distance = distance;
    settings.method.seed = seed;
    return settings;
}

constexpr double kFrame = 5.0;  // the mover is in the middle

Bytes samples_of(const RenderSettings& settings, const Scene& scene = scene_of_two()) {
    MemorySink sink;
    RenderStats stats;
    Renderer(scene).render_samples(settings, kFrame, {}, sink, stats);
    return sink.bytes;
}

Rows developed(const Bytes& bytes, const Development& development) {
    StoredSamples samples(std::make_unique<MemorySource>(bytes));
    Rows rows;
    samples.develop(development, rows);
    return rows;
}

Rows rendered(const RenderSettings& settings) {
    const Scene scene = scene_of_two();
    Rows rows;
    RenderStats stats;
    render_frame(scene, settings, kFrame, rows, stats);
    return rows;
}

double rmse(const Rows& a, const Rows& b, int border = 0) {
    double sum = 0.0;
    int count = 0;
    for (int y = border; y < kSize - border; ++y)
        for (int x = border; x < kSize - border; ++x, ++count) {
            const double off = double(a.red(x, y)) - b.red(x, y);
            sum += off * off;
        }
    return std::sqrt(sum / count);
}

// Mean of a - b, and its standard error if pixels are independent.
std::pair<double, double> mean_difference(const Rows& a, const Rows& b, int border) {
    double sum = 0.0, squares = 0.0;
    int count = 0;
    for (int y = border; y < kSize - border; ++y)
        for (int x = border; x < kSize - border; ++x, ++count) {
            const double off = double(a.red(x, y)) - b.red(x, y);
            sum += off, squares += off * off;
        }
    return {sum / count, std::sqrt(squares) / count};
}

TEST(StoredSamples, AsTheyWereTheyAreThePicture) {
    for (const Filter filter : {Filter::kBox, Filter::kTent, Filter::kBlackmanHarris}) {
        RenderSettings settings = settings_focused_at(4.0, 8);
        settings.image.filter = filter;
        settings.image.exposure = 0.7;
        settings.shutter.rolling = RollingShutter::kTop;
        settings.shutter.curve = trapezoid_shutter(0.2, 0.6);
        const Rows direct = rendered(settings), again = developed(samples_of(settings), {});
        ASSERT_EQ(direct.rgba.size(), again.rgba.size());
        for (std::size_t i = 0; i < direct.rgba.size(); ++i) ASSERT_NEAR(direct.rgba[i], again.rgba[i], 2e-6) << i;
        EXPECT_EQ(direct.z, again.z);
        EXPECT_EQ(direct.info.world_to_ndc, again.info.world_to_ndc);
    }
}

TEST(StoredSamples, ACropHoldsItsRim) {
    RenderSettings settings = settings_focused_at(4.0, 4);
    settings.image.filter = Filter::kBlackmanHarris;
    settings.image.crop = {17, 51, 9, 40};
    const Rows direct = rendered(settings), again = developed(samples_of(settings), {});
    ASSERT_EQ(direct.rgba.size(), again.rgba.size());
    for (std::size_t i = 0; i < direct.rgba.size(); ++i) ASSERT_NEAR(direct.rgba[i], again.rgba[i], 2e-6) << i;
}

TEST(StoredSamples, FocusedOnAnEdgeItIsSharp) {
    // The edge at 8 metres is at x = 32; its circle of confusion was 32 * 0.3 * (1/2 - 1/8) = 3.6 pixels.
    const Bytes bytes = samples_of(settings_focused_at(2.0));
    const Rows before = developed(bytes, {});
    EXPECT_GT(before.red(30, 60), 0.3f);
    Development at_edge;
    at_edge.focus_distance = 8.0;
    const Rows sharp = developed(bytes, at_edge);
    for (int y = 52; y < 58; ++y) {
        for (int x = 20; x < 31; ++x) EXPECT_NEAR(sharp.red(x, y), 0.25f, 1e-3f) << x << ' ' << y;
        for (int x = 33; x < 44; ++x) EXPECT_NEAR(sharp.red(x, y), 1.0f, 1e-3f) << x << ' ' << y;
    }
    EXPECT_EQ(sharp.info.focus_distance, 8.0);
}

TEST(StoredSamples, RefocusedItIsADirectRenderButForNoise) {
    const int border = 8;
    Development wanted;
    wanted.focus_distance = 3.0;
    const Rows again = developed(samples_of(settings_focused_at(6.0, 64)), wanted);
    const Rows direct = rendered(settings_focused_at(3.0, 64, 1)), other = rendered(settings_focused_at(3.0, 64, 2));
    const auto [difference, error] = mean_difference(again, direct, border);
    EXPECT_LT(std::abs(difference), 5.0 * error);
    EXPECT_LT(rmse(again, direct, border), 2.0 * rmse(other, direct, border));
    EXPECT_GT(rmse(rendered(settings_focused_at(6.0, 64)), direct, border), 3.0 * rmse(again, direct, border));
}

TEST(StoredSamples, ASmallerApertureIsADirectRenderButForNoise) {
    RenderSettings wide = settings_focused_at(4.0, 64), narrow = settings_focused_at(4.0, 64, 1);
    wide.camera.lens_radius.reset();
    narrow.camera.lens_radius.reset();
    wide.camera.fstop = 0.04;
    narrow.camera.fstop = 0.08;
    Development wanted;
    wanted.fstop = 0.08;
    const Rows again = developed(samples_of(wide), wanted), direct = rendered(narrow);
    narrow.method.seed = 2;
    const auto [difference, error] = mean_difference(again, direct, 0);
    EXPECT_LT(std::abs(difference), 5.0 * error);
    // A quarter of the samples is left: twice the noise.
    EXPECT_LT(rmse(again, direct), 4.0 * rmse(rendered(narrow), direct));
    EXPECT_GT(rmse(rendered(wide), direct), 1.5 * rmse(again, direct));
}

TEST(StoredSamples, RetimedItShowsTheOtherTimesAlone) {
    // Focused on the mover, which goes 3.2 pixels in a tenth of a second, open half of it: 1.6 pixels.
    RenderSettings settings = settings_focused_at(2.0, 64);
    settings.shutter.shutter = 2.0;  // 6.4 pixels
    const Bytes bytes = samples_of(settings);
    Development early;
    early.shutter = 0.25;
    early.shutter_offset = -0.875;  // the first eighth
    const Rows rows = developed(bytes, early);
    const double start = kSize / 2.0 - 3.2, way = 0.8, half = 4.0;
    const int y = kSize / 2 - 16;  // one metre up at two metres
    for (int x = 16; x < 48; ++x) {
        const double first = start - half, last = start + half;
        if (x + 1 < first) {
            EXPECT_NEAR(rows.red(x, y), 0.25f, 1e-5f) << x << ": never the mover";
        } else if (x > first + way && x + 1 < last) {
            EXPECT_NEAR(rows.red(x, y), 1.0f, 1e-5f) << x << ": always the mover";
        }
    }
    settings.shutter.shutter = 0.25;
    settings.method.seed = 1;
    RenderSettings shifted = settings;
    const Scene scene = scene_of_two();
    Rows direct, other;
    RenderStats stats;
    render_frame(scene, shifted, kFrame - 0.875, direct, stats);
    shifted.method.seed = 2;
    render_frame(scene, shifted, kFrame - 0.875, other, stats);
    const auto [difference, error] = mean_difference(rows, direct, 0);
    EXPECT_LT(std::abs(difference), 5.0 * error);
    EXPECT_LT(rmse(rows, direct), 5.0 * rmse(other, direct)) << "an eighth of the samples: 2.8 times the noise";
    EXPECT_NEAR(rows.info.shutter_open, direct.info.shutter_open, 1e-12);
    EXPECT_NEAR(rows.info.shutter_close, direct.info.shutter_close, 1e-12);
}

TEST(StoredSamples, AGlobalShutterBecomesARollingOneOrOneWithACurve) {
    RenderSettings settings = settings_focused_at(2.0, 64);
    settings.shutter.shutter = 2.0;
    const Bytes bytes = samples_of(settings);
    Development wanted;
    wanted.shutter = 0.5;
    wanted.curve = trapezoid_shutter(0.4, 0.6);
    wanted.rolling = RollingShutter::kBottom;
    wanted.rolling_duration = 1.5;
    const Rows again = developed(bytes, wanted);
    settings.shutter.shutter = 0.5;
    settings.shutter.curve = wanted.curve;
    settings.shutter.rolling = wanted.rolling;
    settings.shutter.rolling_duration = wanted.rolling_duration;
    settings.method.seed = 1;
    const Rows direct = rendered(settings);
    settings.method.seed = 2;
    const Rows other = rendered(settings);
    const auto [difference, error] = mean_difference(again, direct, 0);
    EXPECT_LT(std::abs(difference), 5.0 * error);
    EXPECT_LT(rmse(again, direct), 4.0 * rmse(other, direct));
    settings.shutter.rolling = RollingShutter::kTop;
    EXPECT_GT(rmse(rendered(settings), direct), 2.0 * rmse(again, direct)) << "the direction matters";
    EXPECT_NEAR(again.info.readout, direct.info.readout, 1e-12);
    EXPECT_NEAR(again.info.shutter_open, direct.info.shutter_open, 1e-12);
}

// What many seeds say of a kind of pictures: of each block of 1 x 8 pixels, whose mean is one independent number for
// each seed. The mover goes right, so a longer exposure widens its left and right edge by the same and leaves the mean
// of anything wider alone.
constexpr int kSeeds = 16;
class Blocks {
  public:
    static constexpr int kHigh = 8, kCount = kSize * kSize / kHigh;
    static int x(int block) { return block % kSize; }
    static int y(int block) { return block / kSize * kHigh; }

    void add(const Rows& picture) {
        for (int block = 0; block < kCount; ++block) {
            double mean = 0.0;
            for (int i = 0; i < kHigh; ++i) mean += picture.red(x(block), y(block) + i) / kHigh;
            sums_[block] += mean;
            squares_[block] += mean * mean;
        }
    }
    double mean(int block) const { return sums_[block] / kSeeds; }
    double variance_of_mean(int block) const {
        return (squares_[block] - sums_[block] * sums_[block] / kSeeds) / (kSeeds - 1) / kSeeds;
    }

  private:
    std::array<double, kCount> sums_{}, squares_{};
};

// Of Welch's z of each block in which there is any noise.
struct Agreement {
    double mean_square = 0.0, largest = 0.0;
    int blocks = 0;
};
Agreement compare(const Blocks& a, const Blocks& b, int border) {
    Agreement result;
    for (int block = 0; block < Blocks::kCount; ++block) {
        const int x = Blocks::x(block), y = Blocks::y(block);
        if (std::min(x, y) < border || std::max(x + 1, y + Blocks::kHigh) > kSize - border) continue;
        const double variance = a.variance_of_mean(block) + b.variance_of_mean(block);
        const double difference = a.mean(block) - b.mean(block);
        if (variance < 1e-12) {  // one colour in all of them, but for rounding
            EXPECT_NEAR(difference, 0.0, 1e-5) << x << ' ' << y;
            continue;
        }
        const double z2 = difference * difference / variance;
        result.mean_square += z2;
        result.largest = std::max(result.largest, std::sqrt(z2));
        ++result.blocks;
    }
    result.mean_square /= std::max(1, result.blocks);
    return result;
}

// With 30 degrees of freedom z^2 has a mean of 30/28 and a variance of 2.56, and one z in 75,000 is over 5.2.
bool same_distribution(const Agreement& agreement) {
    return agreement.largest < 5.2 && agreement.mean_square < 30.0 / 28.0 + 3.6 * std::sqrt(2.56 / agreement.blocks);
}

TEST(StoredSamples, DevelopedPicturesAreDirectRendersInTheMeanOfManySeeds) {
    struct Case {
        const char* what;
        RenderSettings recorded, direct;
        Development wanted;
        std::vector<Development> wrong;  // what mistakes in the program could make of `wanted`
        int border;
    };
    std::vector<Case> cases;
    {
        Development far, farther;
        far.focus_distance = 3.0;
        farther.focus_distance = 3.15;
        cases.push_back({"refocused", settings_focused_at(6.0), settings_focused_at(3.0), far, {farther}, 8});
    }
    {
        RenderSettings wide = settings_focused_at(4.0), narrow = wide;
        wide.camera.lens_radius.reset(), narrow.camera.lens_radius.reset();
        wide.camera.fstop = 0.04, narrow.camera.fstop = 0.06;
        narrow.camera.focus_distance = 5.0;
        Development small, larger;
        small.fstop = 0.06;
        small.focus_distance = larger.focus_distance = 5.0;
        larger.fstop = 0.05;
        cases.push_back({"refocused with a smaller aperture", wide, narrow, small, {larger}, 8});
    }
    {
        RenderSettings recorded = settings_focused_at(2.0, 64), direct = settings_focused_at(2.0);
        recorded.shutter.shutter = 2.0;
        direct.shutter.shutter = 0.5;
        direct.shutter.position = ShutterPosition::kStart;  // opens at mid-shutter of the recorded one
        Development late;
        late.shutter = 0.5;
        late.shutter_offset = 0.25;
        Development longer = late, later = late;
        longer.shutter = 0.75;
        later.shutter_offset = 0.3;
        cases.push_back({"retimed", recorded, direct, late, {longer, later}, 0});
        direct.shutter.position = ShutterPosition::kCenter;
        direct.shutter.curve = trapezoid_shutter(0.3, 0.5);
        direct.shutter.rolling = RollingShutter::kTop;
        direct.shutter.rolling_duration = 1.25;
        Development rolling;
        rolling.shutter = 0.5;
        rolling.curve = direct.shutter.curve;
        rolling.rolling = RollingShutter::kTop;
        rolling.rolling_duration = 1.25;
        Development longer_rows = rolling, even = rolling, slower = rolling, up = rolling;
        longer_rows.shutter = 0.75;
        even.curve = trapezoid_shutter(0.0, 1.0);
        slower.rolling_duration = 1.5;
        up.rolling = RollingShutter::kBottom;
        cases.push_back(
            {"global to rolling, with a curve", recorded, direct, rolling, {longer_rows, even, slower, up}, 0});
    }
    const auto with_seed = [](RenderSettings settings, int seed) {
        settings.method.seed = static_cast<std::uint32_t>(seed);
        return settings;
    };
    for (const Case& c : cases) {
        Blocks direct, right;
        std::vector<Blocks> wrong(c.wrong.size());
        for (int seed = 0; seed < kSeeds; ++seed) {
            direct.add(rendered(with_seed(c.direct, 2 * seed + 1)));
            const Bytes recorded = samples_of(with_seed(c.recorded, 2 * seed));
            right.add(developed(recorded, c.wanted));
            for (std::size_t i = 0; i < wrong.size(); ++i) wrong[i].add(developed(recorded, c.wrong[i]));
        }
        const Agreement same = compare(right, direct, c.border);
        EXPECT_GT(same.blocks, 20) << c.what;
        EXPECT_TRUE(same_distribution(same)) << c.what << ": " << same.largest << ' ' << same.mean_square;
        for (std::size_t i = 0; i < wrong.size(); ++i) {
            const Agreement off = compare(wrong[i], direct, c.border);
            EXPECT_FALSE(same_distribution(off))
                << c.what << ", mistake " << i << ": " << off.largest << ' ' << off.mean_square;
        }
    }
}

// A pixel's samples lie in time strata of their own, so each slice of the open time holds one of them.
TEST(StoredSamples, TheMeanOfTheSharpSlicesIsTheBlurredPicture) {
    RenderSettings settings = settings_focused_at(3.0, 16);
    settings.shutter.shutter = 2.0;
    const Bytes bytes = samples_of(settings);
    const Rows blurred = rendered(settings);
    std::vector<double> mean(blurred.rgba.size());
    for (int slice = 0; slice < 16; ++slice) {
        Development thin;
        thin.shutter = 2.0 / 16;
        thin.shutter_offset = 2.0 * (slice + 0.5) / 16 - 1.0;
        const Rows sharp = developed(bytes, thin);
        for (std::size_t i = 0; i < mean.size(); ++i) mean[i] += sharp.rgba[i] / 16.0;
    }
    for (std::size_t i = 0; i < mean.size(); ++i) ASSERT_NEAR(mean[i], blurred.rgba[i], 2e-6) << i;
}

TEST(StoredSamples, RefuseAnotherFocusWhereZoomOrFocusMoved) {
    const auto with = [](ChannelPath path, float from, float to) {
        Scene scene = scene_of_two();
        Channel channel;
        channel.camera = 0;
        channel.path = path;
        channel.width = 1;
        channel.times = {0.0f, 1.0f};
        channel.values = {from, to};
        scene.animations.push_back({"optics", {channel}, 1.0});
        return scene;
    };
    RenderSettings settings = settings_focused_at(4.0, 1);
    Development wanted;
    wanted.focus_distance = 3.0;
    EXPECT_THROW(developed(samples_of(settings, with(ChannelPath::kYfov, 1.5f, 0.5f)), wanted), Error);
    const Scene pulls = with(ChannelPath::kFocusDistance, 2.0f, 8.0f);
    EXPECT_NO_THROW(developed(samples_of(settings, pulls), wanted)) << "the settings hold the focus still";
    settings.camera.focus_distance.reset();
    EXPECT_THROW(developed(samples_of(settings, pulls), wanted), Error);
    EXPECT_NO_THROW(developed(samples_of(settings, pulls), {})) << "as it was rendered";
}

TEST(StoredSamples, RefuseWhatTheyDoNotHold) {
    const Bytes bytes = samples_of(settings_focused_at(4.0, 1));
    const auto refused = [](const Bytes& samples, auto change) {
        Development wanted;
        change(wanted);
        EXPECT_THROW(developed(samples, wanted), Error);
    };
    refused(bytes, [](Development& d) { d.fstop = 0.001; });
    refused(bytes, [](Development& d) { d.focus_distance = 0.0; });
    refused(bytes, [](Development& d) { d.focus_distance = -1.0; });
    refused(bytes, [](Development& d) { d.focus_distance = 0.03; });  // over 256 pixels
    refused(bytes, [](Development& d) { d.shutter = 0.6; });
    refused(bytes, [](Development& d) { d.shutter = 0.0; });
    refused(bytes, [](Development& d) { d.shutter = std::nan(""); });
    refused(bytes, [](Development& d) { d.shutter_offset = 0.01; });
    refused(bytes, [](Development& d) { d.rolling = RollingShutter::kTop, d.rolling_duration = 0.5; });
    refused(bytes, [](Development& d) { d.curve = {{0.5, 1.0}, {0.2, 1.0}}; });
    RenderSettings settings = settings_focused_at(4.0, 1);
    settings.shutter.curve = trapezoid_shutter(0.2, 0.6);
    refused(samples_of(settings), [](Development& d) { d.shutter = 0.2; });
    settings.camera.defocus = false;
    refused(samples_of(settings), [](Development& d) { d.focus_distance = 3.0; });
    Bytes damaged = bytes;
    damaged[damaged.size() / 2] ^= std::byte{0x40};
    refused(damaged, [](Development&) {});
    damaged.resize(damaged.size() / 2);
    refused(damaged, [](Development&) {});
}

}  // namespace
}  // namespace pentaprism
