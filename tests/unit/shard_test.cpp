// Parts of a frame, as bytes in memory: joined they are the frame, and what is no shard is said to be none.
#include <algorithm>
#include <cstring>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <pentaprism/aov.h>
#include <pentaprism/error.h>
#include <pentaprism/shard.h>

#include "unit/small_scene.h"

namespace pentaprism {
namespace {

using Bytes = std::vector<std::byte>;

struct MemorySink : ByteSink {
    Bytes bytes;
    void write(std::span<const std::byte> more) override { bytes.insert(bytes.end(), more.begin(), more.end()); }
};

struct MemorySource : ByteSource {
    explicit MemorySource(Bytes all) : bytes(std::move(all)) {}
    std::string name() const override { return "memory"; }
    bool at_end() override { return at == bytes.size(); }
    void read(std::span<std::byte> out) override {
        if (out.size() > bytes.size() - at) throw Error(ErrorKind::kScene, "too short");
        std::copy_n(bytes.begin() + at, out.size(), out.begin());
        at += out.size();
    }
    Bytes bytes;
    std::size_t at = 0;
};

struct RowCollector : RowSink {
    std::vector<float> rgba, z;
    std::vector<std::vector<float>> aovs;  // of each band
    FrameInfo info;
    void begin(const FrameInfo& of) override { info = of; }
    void rows(const PixelRows& band) override {
        rgba.insert(rgba.end(), band.rgba.begin(), band.rgba.end());
        z.insert(z.end(), band.z.begin(), band.z.end());
        aovs.emplace_back(band.aovs.begin(), band.aovs.end());
    }
};

Scene moving_square() {
    Scene scene = small_scene::scene_with_camera();
    const Index mover = small_scene::add_mesh(scene, {small_scene::square(0.5f, -2.0f, kNone)});
    small_scene::add_mesh(scene, {small_scene::square(3.0f, -8.0f, kNone)});
    Channel channel;
    channel.node = mover;
    channel.path = ChannelPath::kTranslation;
    channel.times = {0.0f, 1.0f};
    channel.values = {-2.0f, 0.0f, 0.0f, 2.0f, 1.0f, 0.0f};
    scene.animations.push_back({"move", {channel}, 1.0});
    return scene;
}

RenderSettings settings_of(int width, int height) {
    RenderSettings settings;
    settings.image.width = width;
    settings.image.height = height;
    settings.image.spp = 4;
    settings.image.exposure = 0.3;
    settings.camera.lens_radius = 0.1;
    settings.camera.focus_distance = 3.0;
    return settings;
}

Bytes shard_of(Renderer& renderer, const RenderSettings& settings, const Shard& shard) {
    MemorySink sink;
    RenderStats stats;
    renderer.render_shard(settings, 12.0, shard, {}, sink, stats);
    return sink.bytes;
}

std::unique_ptr<ByteSource> source_of(Bytes bytes) {
    return std::make_unique<MemorySource>(std::move(bytes));
}

TEST(Shards, AnySplitOfAnyFrameJoinsToItsBits) {
    const Scene scene = moving_square();
    Renderer renderer(scene);
    for (const auto& [width, height] : {std::pair{96, 70}, {33, 1}, {1, 65}, {31, 32}}) {
        RenderSettings settings = settings_of(width, height);
        for (const AovInfo& about : aov_table())
            if (about.aov != Aov::kSte) settings.image.aovs.push_back(about.aov);
        RowCollector whole;
        RenderStats stats;
        renderer.render(settings, 12.0, whole, stats);
        for (const int count : {1, 2, 3, 5, 11}) {
            std::vector<std::unique_ptr<ByteSource>> sources;
            for (int index = count; index-- > 0;)
                sources.push_back(source_of(shard_of(renderer, settings, {index, count})));
            ShardMerger merger(std::move(sources));
            RowCollector joined;
            merger.merge(joined);
            EXPECT_EQ(0, std::memcmp(whole.rgba.data(), joined.rgba.data(), whole.rgba.size() * sizeof(float)));
            EXPECT_EQ(whole.z, joined.z);
            ASSERT_EQ(whole.aovs.size(), joined.aovs.size());
            for (std::size_t i = 0; i < whole.aovs.size(); ++i)  // bits: ids are no floats
                EXPECT_EQ(
                    0, std::memcmp(whole.aovs[i].data(), joined.aovs[i].data(), whole.aovs[i].size() * sizeof(float)));
            EXPECT_EQ(whole.info.world_to_ndc, joined.info.world_to_ndc);
            EXPECT_EQ(whole.info.attributes, joined.info.attributes);
            EXPECT_EQ(whole.info.shutter_open, joined.info.shutter_open);
        }
    }
}

// A head with one value changed, before tiles that are left alone.
Bytes with_head(const Bytes& shard, const std::string& pointer, const nlohmann::json& value) {
    std::uint64_t length = 0;
    std::memcpy(&length, shard.data() + 16, 8);
    const auto* text = reinterpret_cast<const char*>(shard.data()) + 24;
    nlohmann::json head = nlohmann::json::parse(text, text + length);
    head.at(nlohmann::json::json_pointer(pointer)) = value;
    const std::string changed = head.dump();
    const std::uint64_t changed_length = changed.size();
    Bytes bytes(shard.begin(), shard.begin() + 16);
    const auto append = [&](const void* from, std::size_t count) {
        const auto* first = static_cast<const std::byte*>(from);
        bytes.insert(bytes.end(), first, first + count);
    };
    append(&changed_length, 8);
    append(changed.data(), changed.size());
    append(shard.data() + 24 + length, shard.size() - 24 - length);
    return bytes;
}

TEST(Shards, AHeadThatMakesNoSenseIsRefused) {
    const Scene scene = moving_square();
    Renderer renderer(scene);
    RenderSettings settings = settings_of(40, 20);
    settings.image.aovs = {Aov::kCoc, Aov::kDepth};
    const Bytes good = shard_of(renderer, settings, {0, 1});
    const auto kind_of = [](Bytes bytes) {
        try {
            std::vector<std::unique_ptr<ByteSource>> sources;
            sources.push_back(source_of(std::move(bytes)));
            ShardMerger merger(std::move(sources));
            RowCollector joined;
            merger.merge(joined);
        } catch (const Error& error) {
            return static_cast<int>(error.kind());
        }
        return 0;
    };
    EXPECT_EQ(kind_of(good), 0);
    EXPECT_EQ(kind_of({}), 3);
    const int coc = static_cast<int>(Aov::kCoc);
    const std::pair<const char*, nlohmann::json> changes[] = {
        {"/info/width", 0},   {"/info/width", 1 << 30},   {"/info/x1", 41},        {"/info/x0", -1},
        {"/info/y0", 20},     {"/info/width", "wide"},    {"/shard/count", 0},     {"/shard/index", 1},
        {"/shard/index", -1}, {"/shard/count", 1 << 30},  {"/filter", 200},        {"/tonemap", 77},
        {"/info/aovs", {99}}, {"/info/aovs", {coc, coc}}, {"/info/aovs", nullptr}, {"/metadata", 1}};
    for (const auto& [pointer, value] : changes)
        EXPECT_EQ(kind_of(with_head(good, pointer, value)), 3) << pointer << ' ' << value;
    // Believable, but not what was written: the hash tells.
    EXPECT_EQ(kind_of(with_head(good, "/exposure", 2.0)), 3);
    EXPECT_EQ(kind_of(with_head(good, "/info/width", 50)), 3);
    EXPECT_EQ(kind_of(with_head(good, "/info/aovs", {coc})), 3);
}

TEST(Shards, TheTilesAreTheSameWhateverTheTileSizeOfTheCaller) {
    const Scene scene = moving_square();
    Renderer renderer(scene);
    RenderSettings settings = settings_of(70, 40);
    const Bytes one = shard_of(renderer, settings, {1, 2});
    settings.method.tile_size = 8;
    EXPECT_EQ(one, shard_of(renderer, settings, {1, 2}));
}

}  // namespace
}  // namespace pentaprism
