#include "render/shard_stream.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <pentaprism/aov.h>
#include <pentaprism/error.h>

namespace pentaprism {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Shard, index, count)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(FileMetadata, settings_json, exposure_seconds, software)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(FrameInfo::Knot, time, world_to_camera)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(FrameInfo, width, height, x0, y0, x1, y1, frame, fps, shutter_open, shutter_close,
                                   readout, lens_radius, focus_distance, fstop, focal_length_mm, world_to_camera,
                                   world_to_ndc, fx, fy, camera, max_motion_segments, knots, aovs, attributes)

namespace {

using Json = nlohmann::json;

static_assert(std::endian::native == std::endian::little, "numbers are written as they lie in memory");
constexpr char kMark[16] = "pentaprism shrd";
constexpr std::uint64_t kLongestHead = std::uint64_t{1} << 26;
constexpr int kLargestSide = 16384;

Json to_json(const ShardHead& head) {
    return {{"shard", head.shard},
            {"info", head.info},
            {"filter", static_cast<int>(head.image.filter)},
            {"exposure", head.image.exposure},
            {"tonemap", static_cast<int>(head.image.tonemap)},
            {"metadata", head.metadata}};
}

ShardHead head_of(const Json& json) {
    ShardHead head;
    head.shard = json.at("shard").get<Shard>();
    head.info = json.at("info").get<FrameInfo>();
    head.image.filter = static_cast<Filter>(json.at("filter").get<std::uint8_t>());
    head.image.exposure = json.at("exposure").get<double>();
    head.image.tonemap = static_cast<ToneMap>(json.at("tonemap").get<std::uint8_t>());
    head.metadata = json.at("metadata").get<FileMetadata>();
    return head;
}

// What memory and loops rely on.
bool makes_sense(const ShardHead& head) {
    const FrameInfo& info = head.info;
    const auto within = [](int low, int high, int end) { return 0 <= low && low < high && high <= end; };
    const bool known = std::all_of(info.aovs.begin(), info.aovs.end(), [&](Aov aov) {
        return static_cast<std::size_t>(aov) < aov_table().size() &&
               std::count(info.aovs.begin(), info.aovs.end(), aov) == 1;
    });
    return known && head.shard.count <= kMostShards && 0 <= head.shard.index && head.shard.index < head.shard.count &&
           info.width <= kLargestSide && info.height <= kLargestSide && within(info.x0, info.x1, info.width) &&
           within(info.y0, info.y1, info.height) && head.image.filter <= Filter::kBlackmanHarris &&
           head.image.tonemap <= ToneMap::kFilmic;
}

}  // namespace

std::vector<Tile> tiles_of(std::span<const Tile> tiles, const Shard& shard) {
    std::vector<Tile> mine;
    for (std::size_t i = shard.index; i < tiles.size(); i += shard.count) mine.push_back(tiles[i]);
    return mine;
}

std::string difference(const ShardHead& a, const ShardHead& b) {
    if (a.shard.count != b.shard.count) return fmt::format("of {} and of {} shards", a.shard.count, b.shard.count);
    if (a.info.frame != b.info.frame) return fmt::format("of frame {} and of frame {}", a.info.frame, b.info.frame);
    if (a.metadata.software != b.metadata.software)
        return fmt::format("by {} and by {}", a.metadata.software, b.metadata.software);
    Json left = to_json(a), right = to_json(b);
    left.erase("shard");
    right.erase("shard");
    return left == right ? "" : "made with different settings or of different scenes";
}

ShardOutput::ShardOutput(const Shard& shard, const FrameInfo& info, const RenderSettings& settings,
                         const FileMetadata& metadata, ByteSink& out)
    : out_(out) {
    // Numbers keep each bit: they are written with as many digits as that takes.
    const std::string head =
        to_json({shard, info, settings.image, metadata}).dump(-1, ' ', false, Json::error_handler_t::replace);
    const std::uint64_t length = head.size();
    write(kMark, sizeof kMark);
    write(&length, sizeof length);
    write(head.data(), head.size());
}

void ShardOutput::write(const TileSums& tile) {
    write(tile.sums.data(), tile.sums.size() * sizeof tile.sums[0]);
    write(tile.depth.data(), tile.depth.size() * sizeof(float));
    write(tile.aovs.data(), tile.aovs.size() * sizeof(float));
}

void ShardOutput::finish() {
    out_.write(hash_.digest());
}

void ShardOutput::write(const void* bytes, std::size_t count) {
    hash_.add(bytes, count);
    out_.write({static_cast<const std::byte*>(bytes), count});
}

ShardInput::ShardInput(std::unique_ptr<ByteSource> source) : source_(std::move(source)) {
    char mark[sizeof kMark];
    std::uint64_t length = 0;
    read(mark, sizeof mark);
    if (std::memcmp(mark, kMark, sizeof mark) != 0) refuse("it is no shard of this version");
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

void ShardInput::read(TileSums& sums) {
    read(sums.sums.data(), sums.sums.size() * sizeof sums.sums[0]);
    read(sums.depth.data(), sums.depth.size() * sizeof(float));
    read(sums.aovs.data(), sums.aovs.size() * sizeof(float));
}

void ShardInput::finish() {
    std::array<std::byte, 16> digest;
    source_->read(digest);
    if (digest != hash_.digest() || !source_->at_end()) refuse("it is damaged");
}

void ShardInput::read(void* bytes, std::size_t count) {
    source_->read({static_cast<std::byte*>(bytes), count});
    hash_.add(bytes, count);
}

FileMetadata read_shard_metadata(const std::filesystem::path& file) {
    return ShardInput(open_shard_file(file)).head().metadata;
}

void ShardInput::refuse(const std::string& why) const {
    throw Error(ErrorKind::kScene, fmt::format("{}: cannot read ({})", name(), why));
}

}  // namespace pentaprism
