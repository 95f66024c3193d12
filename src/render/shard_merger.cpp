// Shards to a picture: the rows of Renderer::render(), of tiles that were rendered elsewhere.

#include <fmt/format.h>
#include <pentaprism/error.h>
#include <pentaprism/shard.h>

#include "render/picture_rows.h"
#include "render/shard_stream.h"
#include "resolve/filter.h"

namespace pentaprism {

struct ShardMerger::Part : TileInput {
    explicit Part(std::unique_ptr<ByteSource> source) : TileInput(StreamKind::kShard, std::move(source)) {}
};

namespace {

[[noreturn]] void refuse(const std::string& why) {
    throw Error(ErrorKind::kUsage, why);
}

}  // namespace

ShardMerger::ShardMerger(std::vector<std::unique_ptr<ByteSource>> sources) {
    if (sources.empty()) refuse("there are no shards to join");
    std::vector<std::unique_ptr<Part>> given;
    for (auto& source : sources) given.push_back(std::make_unique<Part>(std::move(source)));

    const StreamHead first = given.front()->head();
    const std::string first_name = given.front()->name();
    const auto count = static_cast<std::size_t>(first.shard.count);
    parts_.resize(std::min(count, given.size()));
    for (auto& part : given) {
        if (const std::string what = difference(first, part->head()); !what.empty())
            refuse(fmt::format("{} and {} are no parts of one picture: {}", first_name, part->name(), what));
        const auto index = static_cast<std::size_t>(part->head().shard.index);
        if (index >= parts_.size()) continue;  // then another one is missing
        if (parts_[index])
            refuse(fmt::format("shard {} of {} is given twice: {} and {}", index + 1, count, parts_[index]->name(),
                               part->name()));
        parts_[index] = std::move(part);
    }
    for (std::size_t i = 0; i < count; ++i)
        if (i >= parts_.size() || !parts_[i]) refuse(fmt::format("shard {} of {} is missing", i + 1, count));
}

ShardMerger::~ShardMerger() = default;

const FrameInfo& ShardMerger::info() const {
    return parts_.front()->head().info;
}

const FileMetadata& ShardMerger::metadata() const {
    return parts_.front()->head().metadata;
}

const ImageSettings& ShardMerger::image() const {
    return parts_.front()->head().image;
}

void ShardMerger::merge(RowSink& sink) {
    const int reach = filter_reach(image().filter);
    const int channels = channel_count(info().aovs);
    const std::vector<Tile> tiles = tiles_over(rendered_part(info(), reach), kCellSize);
    PictureRows picture(info(), reach, image().exposure, sink);
    TileSums sums;
    picture.assemble(tiles, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            sums.start(tiles[i], reach, channels);
            read_sums(*parts_[i % parts_.size()], sums);
            picture.add(sums);
        }
    });
    for (const auto& part : parts_) part->finish();
}

}  // namespace pentaprism
