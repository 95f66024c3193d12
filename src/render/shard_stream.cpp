#include "render/shard_stream.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <pentaprism/aov.h>
#include <pentaprism/error.h>
#include <pentaprism/stored_samples.h>

namespace pentaprism {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Shard, index, count)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(StreamHead::Camera, perspective, lens_ratio, thin_lens, round, even_shutter)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(FileMetadata, settings_json, exposure_seconds, software)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(FrameInfo::Knot, time, world_to_camera)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(FrameInfo, width, height, x0, y0, x1, y1, frame, fps, shutter_open, shutter_close,
                                   readout, lens_radius, focus_distance, fstop, focal_length_mm, world_to_camera,
                                   world_to_ndc, fx, fy, camera, max_motion_segments, knots, aovs, attributes)

namespace {

using Json = nlohmann::json;

static_assert(std::endian::native == std::endian::little, "numbers are written as they lie in memory");
using Mark = std::array<char, 16>;
constexpr Mark kShardMark{"pentaprism shrd"}, kSamplesMark{"pentaprism 5ds1"};
constexpr std::uint64_t kLongestHead = std::uint64_t{1} << 26;
constexpr int kLargestSide = 16384;

Json to_json(const StreamHead& head) {
    return {{"shard", head.shard},
            {"info", head.info},
            {"spp", head.image.spp},
            {"filter", static_cast<int>(head.image.filter)},
            {"exposure", head.image.exposure},
            {"tonemap", static_cast<int>(head.image.tonemap)},
            {"metadata", head.metadata},
            {"camera", head.camera}};
}

StreamHead head_of(const Json& json) {
    StreamHead head;
    head.shard = json.at("shard").get<Shard>();
    head.info = json.at("info").get<FrameInfo>();
    head.image.filter = static_cast<Filter>(json.at("filter").get<std::uint8_t>());
    head.image.exposure = json.at("exposure").get<double>();
    head.image.tonemap = static_cast<ToneMap>(json.at("tonemap").get<std::uint8_t>());
    head.image.spp = json.at("spp").get<int>();
    head.metadata = json.at("metadata").get<FileMetadata>();
    head.camera = json.at("camera").get<StreamHead::Camera>();
    return head;
}

// What memory and loops rely on.
bool makes_sense(const StreamHead& head) {
    const FrameInfo& info = head.info;
    const auto within = [](int low, int high, int end) { return 0 <= low && low < high && high <= end; };
    const bool known = std::all_of(info.aovs.begin(), info.aovs.end(), [&](Aov aov) {
        return static_cast<std::size_t>(aov) < aov_table().size() &&
               std::count(info.aovs.begin(), info.aovs.end(), aov) == 1;
    });
    return known && head.image.spp >= 1 && head.image.spp <= 4096 && head.shard.count <= kMostShards &&
           0 <= head.shard.index && head.shard.index < head.shard.count && info.width <= kLargestSide &&
           info.height <= kLargestSide && within(info.x0, info.x1, info.width) &&
           within(info.y0, info.y1, info.height) && head.image.filter <= Filter::kBlackmanHarris &&
           head.image.tonemap <= ToneMap::kFilmic;
}

}  // namespace

std::vector<Tile> tiles_of(std::span<const Tile> tiles, const Shard& shard) {
    std::vector<Tile> mine;
    for (std::size_t i = shard.index; i < tiles.size(); i += shard.count) mine.push_back(tiles[i]);
    return mine;
}

std::string difference(const StreamHead& a, const StreamHead& b) {
    if (a.shard.count != b.shard.count) return fmt::format("of {} and of {} shards", a.shard.count, b.shard.count);
    if (a.info.frame != b.info.frame) return fmt::format("of frame {} and of frame {}", a.info.frame, b.info.frame);
    if (a.metadata.software != b.metadata.software)
        return fmt::format("by {} and by {}", a.metadata.software, b.metadata.software);
    Json left = to_json(a), right = to_json(b);
    left.erase("shard");
    right.erase("shard");
    return left == right ? "" : "made with different settings or of different scenes";
}

StreamHead head_of(const Shard& shard, const FrameInfo& info, const View& view, const RenderSettings& settings,
                   const FileMetadata& metadata) {
    const bool even = settings.shutter.curve.empty() && view.shutter.rolling == RollingShutter::kNone;
    const Lens& lens = view.lens;
    const bool rests = std::all_of(info.knots.begin(), info.knots.end(), [&](const FrameInfo::Knot& knot) {
        const FrameInfo::Knot& first = info.knots.front();
        return knot.fx == first.fx && knot.lens_radius == first.lens_radius &&
               knot.focus_distance == first.focus_distance;
    });
    const bool thin = lens.straight() && lens.tilt == glm::dvec2(0.0) && rests;
    const bool round = lens.blades == 0 && !lens.image && lens.cats_eye == 0.0;
    return {shard, info, settings.image, metadata, {view.perspective, lens.ratio, thin, round, even}};
}

TileOutput::TileOutput(StreamKind kind, const StreamHead& head, ByteSink& out) : out_(out) {
    // Numbers keep each bit: they are written with as many digits as that takes.
    const std::string text = to_json(head).dump(-1, ' ', false, Json::error_handler_t::replace);
    const std::uint64_t length = text.size();
    const Mark& mark = kind == StreamKind::kShard ? kShardMark : kSamplesMark;
    write(mark.data(), mark.size());
    write(&length, sizeof length);
    write(text.data(), text.size());
}

void TileOutput::finish() {
    out_.write(hash_.digest());
}

void TileOutput::write(const void* bytes, std::size_t count) {
    hash_.add(bytes, count);
    out_.write({static_cast<const std::byte*>(bytes), count});
}

TileInput::TileInput(StreamKind kind, std::unique_ptr<ByteSource> source) : source_(std::move(source)) {
    const bool is_shard = kind == StreamKind::kShard;
    Mark mark;
    std::uint64_t length = 0;
    read(mark.data(), mark.size());
    if (mark != (is_shard ? kShardMark : kSamplesMark))
        refuse(is_shard ? "it is no shard of this version" : "these are no samples of this version");
    read(&length, sizeof length);
    if (length > kLongestHead) refuse("it is damaged");
    std::string head(length, ' ');
    read(head.data(), head.size());
    try {
        head_ = head_of(Json::parse(head));
    } catch (const Json::exception&) {
        refuse("it is damaged");
    }
    if (!makes_sense(head_)) refuse("it is damaged");
}

void TileInput::finish() {
    std::array<std::byte, 16> digest;
    source_->read(digest);
    if (digest != hash_.digest() || !source_->at_end()) refuse("it is damaged");
}

void TileInput::read(void* bytes, std::size_t count) {
    source_->read({static_cast<std::byte*>(bytes), count});
    hash_.add(bytes, count);
}

void TileInput::refuse(const std::string& why) const {
    throw Error(ErrorKind::kScene, fmt::format("{}: cannot read ({})", name(), why));
}

void write_sums(const TileSums& sums, TileOutput& out) {
    out.write(sums.sums);
    out.write(sums.depth);
    out.write(sums.aovs);
}

void read_sums(TileInput& in, TileSums& sums) {
    in.read(sums.sums);
    in.read(sums.depth);
    in.read(sums.aovs);
}

FileMetadata read_shard_metadata(const std::filesystem::path& file) {
    return TileInput(StreamKind::kShard, open_shard_file(file)).head().metadata;
}

FileMetadata read_samples_metadata(const std::filesystem::path& file) {
    return TileInput(StreamKind::kSamples, open_shard_file(file)).head().metadata;
}

}  // namespace pentaprism
